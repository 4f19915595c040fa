import { IconButton } from '@websplatter/kit/controls';
import { useEffect, useRef, useState } from 'react';
import { useStore } from 'zustand';
import { benchmarkAddress, galleryAddress, IS_ONE_FILE } from '../engine/link/lab-address.ts';
import { READABLE_FORMATS } from '../engine/open/file-drop.ts';
import {
  COMMANDS,
  type Command,
  type CommandName,
  isAvailable,
  labelNow,
  type RunCommand,
  shownKey,
} from '../state/command-list.ts';
import { LICENSES_ADDRESS } from '../state/licenses-address.ts';
import type { ViewerStore } from '../state/store.ts';
import { useCommandState } from './use-command-state.ts';

/** A thing to do, by a mouse or by fingers. */
const GESTURES: readonly { readonly what: string; readonly mouse: string; readonly touch: string }[] = [
  { what: 'Orbit', mouse: 'Left drag', touch: 'One finger' },
  { what: 'Pan', mouse: 'Right, middle or Shift drag', touch: 'Two fingers' },
  { what: 'Zoom', mouse: 'Wheel, to the cursor', touch: 'Pinch' },
  { what: 'Orbit around a place', mouse: 'Double-click', touch: 'Double tap' },
  { what: 'Inspect, measure', mouse: 'Click', touch: 'Tap' },
  { what: 'Select', mouse: 'Drag or click', touch: 'One finger' },
];

const OTHER_KEYS: readonly (readonly [string, readonly string[]])[] = [
  ['Orbit', ['←', '→', '↑', '↓']],
  ['Pan', ['Shift', 'arrows']],
  ['Zoom', ['+', '−']],
  ['Move', ['W', 'A', 'S', 'D']],
  ['Down, up', ['Page Down', 'Page Up']],
  ['Reset the view', ['Home']],
  ['A hard case’s cameras', ['[', ']']],
  ['Find a command', ['Ctrl', 'K']],
  ['Remove the selection', ['Delete']],
];

/** Searches to try where nothing was found. */
const SUGGESTIONS = ['crop', 'video', 'background'] as const;

/** A dialog with gestures, and with all commands, to search and to run. */
export function Help({ store, run }: { store: ViewerStore; run: RunCommand }) {
  const isVisible = useStore(store, (state) => state.isHelpVisible);
  const state = useCommandState(store);
  const [query, setQuery] = useState('');
  const [markedIndex, setMarkedIndex] = useState(0);
  const dialog = useRef<HTMLDialogElement>(null);
  const field = useRef<HTMLInputElement>(null);
  useEffect(() => {
    if (!isVisible) return dialog.current?.close();
    setQuery('');
    dialog.current?.showModal();
    // On a phone, focus would open the on-screen keyboard.
    if (!isTouch()) field.current?.focus();
  }, [isVisible]);
  const gallery = galleryAddress();
  const benchmark = benchmarkAddress(new URLSearchParams(location.search));
  const hide = () => store.setState({ isHelpVisible: false });
  const found = findCommands(query);
  // Hits of a search are in the order of their rank, which arrow keys follow.
  const groups = query ? [''] : [...new Set(found.map(({ group }) => group))];
  const sections = groups.map((group) => ({
    group,
    commands: found.filter((command) => !group || command.group === group),
  }));
  const runnable = found.filter(({ name }) => name !== 'help' && isAvailable(name, state));
  const marked = query ? runnable[Math.min(markedIndex, runnable.length - 1)] : undefined;
  const choose = (name: CommandName) => {
    hide();
    run(name);
  };
  return (
    <dialog
      ref={dialog}
      className="panel help"
      aria-labelledby="help-title"
      data-testid="help"
      // The event is delayed: the dialog may be open again.
      onClose={({ currentTarget }) => {
        if (!currentTarget.open) hide();
      }}
      // The dialog has no padding, so a click on the element itself is outside of its content.
      onPointerDown={(event) => event.target === event.currentTarget && hide()}
    >
      <div className="help-body">
        <header className="spread">
          <h2 id="help-title">Help</h2>
          <IconButton icon="close" label="Close" onClick={hide} />
        </header>
        <search>
          <form
            onSubmit={(event) => {
              event.preventDefault();
              if (marked) choose(marked.name);
            }}
          >
            <input
              ref={field}
              type="search"
              value={query}
              placeholder="Find a command"
              aria-label="Find a command"
              data-testid="find-command"
              onChange={({ target }) => {
                setQuery(target.value);
                setMarkedIndex(0);
              }}
              onKeyDown={(event) => {
                const step = { ArrowDown: 1, ArrowUp: -1 }[event.key];
                if (step && marked) {
                  event.preventDefault();
                  setMarkedIndex((runnable.indexOf(marked) + step + runnable.length) % runnable.length);
                }
                if (event.key !== '?' || query) return;
                event.preventDefault();
                hide();
              }}
            />
          </form>
        </search>
        <div className="help-columns">
          {query === '' && <Gestures />}
          <div className="help-commands">
            {sections.map(({ group, commands }) => (
              <section key={group}>
                {group && <h3>{group}</h3>}
                <ul>
                  {commands.map((command) => (
                    <li key={command.name}>
                      <button
                        type="button"
                        className="spread"
                        aria-current={command === marked}
                        disabled={!runnable.includes(command)}
                        data-testid={`run-${command.name}`}
                        onClick={() => choose(command.name)}
                      >
                        {labelNow(command, state)} <kbd>{shownKey(command)}</kbd>
                      </button>
                    </li>
                  ))}
                </ul>
              </section>
            ))}
            {found.length === 0 && !isOfLab(query) && (
              <p role="status">
                Nothing found. Try{' '}
                {SUGGESTIONS.map((word) => (
                  <button
                    key={word}
                    type="button"
                    className="chip"
                    onClick={() => {
                      setQuery(word);
                      field.current?.focus();
                    }}
                  >
                    {word}
                  </button>
                ))}
              </p>
            )}
          </div>
        </div>
        {gallery && benchmark && (
          <p>
            Scenes that break splat renderers: <a href={gallery}>all hard cases</a>. How fast this device
            draws, to be compared with others: <a href={benchmark}>benchmark</a>.
          </p>
        )}
        {!IS_ONE_FILE && import.meta.env.PROD && (
          <p>
            <a href={LICENSES_ADDRESS}>Licences</a> of the npm packages in this page.
          </p>
        )}
      </div>
    </dialog>
  );
}

/** Whether a query matches the links to the lab, which stay below the commands. */
function isOfLab(query: string): boolean {
  return 'gallery of hard cases, benchmark, lab, conformance'.includes(query.trim().toLowerCase());
}

/** Whether fingers are the main pointer: then keys and a mouse are not worth a word. */
function isTouch(): boolean {
  return matchMedia('(pointer: coarse)').matches;
}

/** Gestures of this device, other keys, gamepads and drops. */
function Gestures() {
  const hasFingers = isTouch();
  return (
    <div className="help-gestures">
      <dl>
        {GESTURES.map(({ what, mouse, touch }) => (
          <div key={what}>
            <dt>{what}</dt>
            <dd>{hasFingers ? touch : mouse}</dd>
          </div>
        ))}
      </dl>
      {!hasFingers && (
        <dl>
          {OTHER_KEYS.map(([what, keys]) => (
            <div key={what}>
              <dt>{what}</dt>
              <dd>
                {keys.map((key) => (
                  <kbd key={key}>{key}</kbd>
                ))}
              </dd>
            </div>
          ))}
        </dl>
      )}
      <p>
        {hasFingers
          ? 'Fly and Walk: one finger looks around, and a second one moves ahead.'
          : 'Fly (G): the mouse looks around, and W, A, S, D, Q and E move. Shift is faster, the wheel changes the speed, and Escape stops. Walk (B): the same on the ground, but Space jumps, and the wheel changes your height.'}
      </p>
      <p>
        On a gamepad, the right stick turns and the left one moves. The triggers zoom in and out. A frames the
        scene, B resets the view, and Y flies.
      </p>
      {!hasFingers && (
        <p>
          Drop Gaussian-splat scenes ({READABLE_FORMATS}), their folders or a link anywhere in the window.
          Several at once are shown together. With Shift, they are added to the scene.
        </p>
      )}
    </div>
  );
}

/** Search words besides labels, lower case: contents of panels, and names in other viewers. */
export const OTHER_WORDS: Readonly<Partial<Record<CommandName, string>>> = {
  open: 'load import file files folder drop ply spz sog splat url address link sample example demo recent',
  add: 'load import merge append file',
  frame: 'zoom fit center centre focus whole all home',
  view: 'field of view fov lens zoom background colour color saved views bookmarks path orthographic perspective projection up axis full screen fullscreen annotations notes story',
  accuracy:
    'quality error psnr decibels db preset presets settings reference balanced fast compare difference speed detail levels',
  effects:
    'brightness exposure contrast saturation fog tint clip fade reveal light wind depth of field filter',
  inspect: 'histogram opacity values row pixel pick splat information',
  select: 'remove delete erase clean cut pick lasso brush rectangle polygon sphere colour edit',
  measure: 'distance ruler length scale size metres tape',
  crop: 'cut box clip trim isolate edit',
  hud: 'fps frame rate time milliseconds ms memory statistics stats performance profiler gpu',
  reset: 'home start begin camera',
  clouds: 'layers list move rotate turn scale hide show place transform remove',
  flip: 'mirror upright up axis rotate',
  outside: 'orbit object around',
  inside: 'room interior',
  fly: 'wasd drone game free camera',
  walk: 'wasd ground first person collision game',
  annotate: 'annotation hotspot note comment label marker pin text',
  undo: 'back revert history take back',
  redo: 'again forward repeat history',
  'bring-back': 'undo restore recover lost',
  mode: 'depth overdraw points centres ellipsoids heat map debug wireframe',
  save: 'export download convert gif video film movie webm mp4 picture image photo screenshot png jpg web page html zip embed iframe link publish send settings json',
  'save-project': 'project wsplat session file save edits work keep ssproj',
  link: 'share url address send',
  theme: 'appearance colours colors',
  help: 'shortcuts keyboard controls mouse touch search find about',
};

/** Commands that have all words of `query` in their labels or among their other words, labels first. */
export function findCommands(query: string): readonly Command[] {
  const asked = query.toLowerCase().split(/\s+/).filter(Boolean);
  const has = (text: string) => asked.every((word) => text.toLowerCase().includes(word));
  const found = COMMANDS.filter(({ name, label }) => has(`${label} ${OTHER_WORDS[name] ?? ''}`));
  return found.toSorted((a, b) => Number(has(b.label)) - Number(has(a.label)));
}
