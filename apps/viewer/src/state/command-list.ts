import { TRAVEL_NAMES, type TravelName } from './camera.ts';
import { SELECT_TOOLS, type SelectTool } from './selecting.ts';
import type { ViewerState } from './store.ts';

export type SelectCommand = `select-${SelectTool}`;

export type CommandName =
  | SelectCommand
  | 'open'
  | 'add'
  | 'flip'
  | 'outside'
  | 'inside'
  | 'clouds'
  | 'view'
  | TravelName
  | 'annotate'
  | 'bring-back'
  | 'inspect'
  | 'mode'
  | 'reset'
  | 'frame'
  | 'hud'
  | 'accuracy'
  | 'effects'
  | 'save'
  | 'link'
  | 'theme'
  | 'help';

export interface Command {
  readonly name: CommandName;
  readonly label: string;
  /** Other words that people look for it by, lower case: what its panel holds, and names elsewhere. */
  readonly words?: string;
  /** Compared with `KeyboardEvent.key`, lower case. */
  readonly key: string;
  /** On small screens its button stays in the toolbar, with this word. */
  readonly word?: string;
  /** Its button is not in the toolbar but in a panel. */
  readonly isInPanel?: boolean;
  /** It moves the camera only, so that it is there without the interface too. */
  readonly isOfCamera?: boolean;
}

/**
 * Commands that have both a button and a key, in the toolbar's order; the keys that move the camera
 * belong to the controls. Where room is short, the first ones have buttons.
 */
export const COMMANDS: readonly Command[] = [
  {
    name: 'open',
    label: 'Open files',
    key: 'o',
    word: 'Open',
    words: 'load import file folder drop ply spz sog splat',
  },
  {
    name: 'add',
    label: 'Add files to the scene',
    key: 'j',
    isInPanel: true,
    words: 'load import merge append file',
  },
  {
    name: 'frame',
    label: 'Frame the scene',
    key: 'f',
    isOfCamera: true,
    words: 'zoom fit center centre focus whole all home',
  },
  {
    name: 'view',
    label: 'View and camera',
    key: 'v',
    words:
      'field of view fov lens zoom background colour color saved views bookmarks path orthographic perspective projection up axis full screen fullscreen annotations notes story',
  },
  {
    name: 'accuracy',
    label: 'Accuracy and its cost',
    key: 'c',
    words:
      'quality error psnr decibels db preset presets settings reference balanced fast compare difference speed detail levels',
  },
  {
    name: 'effects',
    label: 'Effects and their cost',
    key: 'e',
    words: 'fog tint clip fade reveal light wind depth of field filter',
  },
  {
    name: 'inspect',
    label: 'Inspect, measure, crop',
    key: 'i',
    words:
      'histogram opacity distance ruler length scale box select remove delete erase clean undo redo splat cut',
  },
  {
    name: 'hud',
    label: 'Show or hide figures',
    key: 'h',
    words: 'fps frame rate time milliseconds ms memory statistics stats performance profiler gpu',
  },
  { name: 'reset', label: 'Reset the view', key: 'r', isOfCamera: true, words: 'home start begin camera' },
  {
    name: 'clouds',
    label: 'Files of the scene',
    key: 'n',
    words: 'layers list move rotate turn scale hide show place transform remove',
  },
  {
    name: 'flip',
    label: 'Turn upside down',
    key: 'u',
    isOfCamera: true,
    words: 'mirror upright up axis rotate',
  },
  {
    name: 'outside',
    label: 'Look from outside',
    key: 'k',
    isInPanel: true,
    isOfCamera: true,
    words: 'orbit object around',
  },
  {
    name: 'inside',
    label: 'Look from inside',
    key: 'y',
    isInPanel: true,
    isOfCamera: true,
    words: 'room interior',
  },
  { name: 'fly', label: 'Fly', key: 'g', isInPanel: true, words: 'wasd drone game free camera' },
  {
    name: 'walk',
    label: 'Walk',
    key: 'b',
    isInPanel: true,
    words: 'wasd ground first person collision game',
  },
  {
    name: 'annotate',
    label: 'Place an annotation',
    key: 'p',
    isInPanel: true,
    words: 'note comment label marker pin text',
  },
  {
    name: 'bring-back',
    label: 'Bring back the last scene with its edits',
    key: 'z',
    isInPanel: true,
    words: 'undo restore recover lost',
  },
  {
    name: 'mode',
    label: 'Next view mode',
    key: 'm',
    isInPanel: true,
    words: 'depth overdraw points centres ellipsoids heat map debug wireframe',
  },
  ...SELECT_TOOLS.map(
    ({ name, label, key }) =>
      ({ name: `select-${name}`, label: `Select by ${label.toLowerCase()}`, key, isInPanel: true }) as const,
  ),
  {
    name: 'save',
    label: 'Save and share',
    key: 'x',
    word: 'Save',
    words:
      'export download video film movie webm mp4 picture image photo screenshot png jpg web page html zip embed iframe link publish send settings json',
  },
  {
    name: 'link',
    label: 'Copy a link to this view',
    key: 'l',
    isInPanel: true,
    words: 'share url address send',
  },
  {
    name: 'theme',
    label: 'Light or dark theme',
    key: 't',
    isInPanel: true,
    words: 'appearance colours colors',
  },
  {
    name: 'help',
    label: 'Help: commands, keys, gestures',
    key: '?',
    word: 'Help',
    words: 'shortcuts controls mouse touch search find about',
  },
];

export const TRAVEL_COMMANDS = TRAVEL_NAMES.flatMap((each) =>
  COMMANDS.flatMap((command) => (command.name === each ? { ...command, name: each } : [])),
);

const NEED_SCENE: readonly CommandName[] = [
  'reset',
  'frame',
  'inspect',
  'save',
  'link',
  'clouds',
  ...TRAVEL_NAMES,
  'annotate',
  'add',
  ...SELECT_TOOLS.map(({ name }) => `select-${name}` as const),
];

/** Commands that have all words of `query` in their labels or among their other words, labels first. */
export function foundCommands(query: string): readonly Command[] {
  const asked = query.toLowerCase().split(/\s+/).filter(Boolean);
  const has = (text: string) => asked.every((word) => text.toLowerCase().includes(word));
  const found = COMMANDS.filter(({ label, words = '' }) => has(`${label} ${words}`));
  return found.toSorted((a, b) => Number(has(b.label)) - Number(has(a.label)));
}

/** Cases with cameras of their own are shown as they are. */
const TURNING: readonly CommandName[] = ['flip', 'outside', 'inside'];

/** Whether a command can do anything now. */
export function isAvailable(
  name: CommandName,
  { scene, leftScene }: Pick<ViewerState, 'scene' | 'leftScene'>,
): boolean {
  if (name === 'bring-back') return leftScene !== null;
  if (TURNING.includes(name)) return scene?.canFlip ?? false;
  return scene !== null || !NEED_SCENE.includes(name);
}

export type RunCommand = (name: CommandName) => void;
