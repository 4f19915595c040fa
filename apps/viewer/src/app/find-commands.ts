import { COMMANDS, type Command, type CommandName } from '../state/command-list.ts';

/** Other words that people look for commands by, lower case: what a panel holds, and names elsewhere. */
export const OTHER_WORDS: Readonly<Partial<Record<CommandName, string>>> = {
  open: 'load import file folder drop ply spz sog splat',
  add: 'load import merge append file',
  frame: 'zoom fit center centre focus whole all home',
  view: 'field of view fov lens zoom background colour color saved views bookmarks path orthographic perspective projection up axis full screen fullscreen annotations notes story',
  accuracy:
    'quality error psnr decibels db preset presets settings reference balanced fast compare difference speed detail levels',
  effects: 'fog tint clip fade reveal light wind depth of field filter',
  inspect:
    'histogram opacity distance ruler length scale box select remove delete erase clean undo redo splat cut',
  hud: 'fps frame rate time milliseconds ms memory statistics stats performance profiler gpu',
  reset: 'home start begin camera',
  clouds: 'layers list move rotate turn scale hide show place transform remove',
  flip: 'mirror upright up axis rotate',
  outside: 'orbit object around',
  inside: 'room interior',
  fly: 'wasd drone game free camera',
  walk: 'wasd ground first person collision game',
  annotate: 'note comment label marker pin text',
  'bring-back': 'undo restore recover lost',
  mode: 'depth overdraw points centres ellipsoids heat map debug wireframe',
  save: 'export download video film movie webm mp4 picture image photo screenshot png jpg web page html zip embed iframe link publish send settings json',
  link: 'share url address send',
  theme: 'appearance colours colors',
  help: 'shortcuts controls mouse touch search find about',
};

/** Commands that have all words of `query` in their labels or among their other words, labels first. */
export function findCommands(query: string): readonly Command[] {
  const asked = query.toLowerCase().split(/\s+/).filter(Boolean);
  const has = (text: string) => asked.every((word) => text.toLowerCase().includes(word));
  const found = COMMANDS.filter(({ name, label }) => has(`${label} ${OTHER_WORDS[name] ?? ''}`));
  return found.toSorted((a, b) => Number(has(b.label)) - Number(has(a.label)));
}
