import { SELECT_TOOLS, type SelectTool } from '../state/selecting.ts';
import type { ViewerStore } from '../state/store.ts';
import { TRAVEL_NAMES, type TravelName } from '../state/travelling.ts';
import { viewModeAfter } from '../state/view-mode.ts';
import { type DockName, isGpuLost, type ViewerState } from '../state/viewer-state.ts';
import { toggleTheme } from '../ui/theme.ts';
import type { Viewer } from '../viewer/viewer.ts';
import { keyScope, mayMoveCamera } from './key-scope.ts';

type SelectCommand = `select-${SelectTool}`;

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
  { name: 'open', label: 'Open files', key: 'o', word: 'Open' },
  { name: 'add', label: 'Add files to the scene', key: 'j', isInPanel: true },
  { name: 'frame', label: 'Frame the scene', key: 'f', isOfCamera: true },
  { name: 'view', label: 'View and camera', key: 'v' },
  { name: 'accuracy', label: 'Accuracy and its cost', key: 'c' },
  { name: 'effects', label: 'Effects and their cost', key: 'e' },
  { name: 'inspect', label: 'Inspect, measure, crop', key: 'i' },
  { name: 'hud', label: 'Show or hide figures', key: 'h' },
  { name: 'reset', label: 'Reset the view', key: 'r', isOfCamera: true },
  { name: 'clouds', label: 'Files of the scene', key: 'n' },
  { name: 'flip', label: 'Turn upside down', key: 'u', isOfCamera: true },
  { name: 'outside', label: 'Look from outside', key: 'k', isInPanel: true, isOfCamera: true },
  { name: 'inside', label: 'Look from inside', key: 'y', isInPanel: true, isOfCamera: true },
  { name: 'fly', label: 'Fly', key: 'g', isInPanel: true },
  { name: 'walk', label: 'Walk', key: 'b', isInPanel: true },
  { name: 'annotate', label: 'Place an annotation', key: 'p', isInPanel: true },
  { name: 'mode', label: 'Next view mode', key: 'm', isInPanel: true },
  ...SELECT_TOOLS.map(
    ({ name, label, key }) =>
      ({ name: `select-${name}`, label: `Select by ${label.toLowerCase()}`, key, isInPanel: true }) as const,
  ),
  { name: 'save', label: 'Save and share', key: 'x', word: 'Save' },
  { name: 'link', label: 'Copy a link to this view', key: 'l', isInPanel: true },
  { name: 'theme', label: 'Light or dark', key: 't', isInPanel: true },
  { name: 'help', label: 'Help: commands, keys, gestures', key: '?', word: 'Help' },
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

/** Cases with cameras of their own are shown as they are. */
const TURNING: readonly CommandName[] = ['flip', 'outside', 'inside'];

/** Whether a command can do anything now. */
export function isAvailable(name: CommandName, { scene }: Pick<ViewerState, 'scene'>): boolean {
  if (TURNING.includes(name)) return scene?.canFlip ?? false;
  return scene !== null || !NEED_SCENE.includes(name);
}

export type RunCommand = (name: CommandName) => void;

/** What a saved page with the picture alone does not do. */
export interface InterfaceCommands {
  /** Lets a person choose files to open, or to add to the scene. */
  readonly chooseFiles: (isAdded: boolean) => void;
  /** Begins to walk through the scene, or ends it. */
  readonly walk: () => void;
}

export function createCommands(
  viewer: Viewer,
  store: ViewerStore,
  { chooseFiles, walk }: InterfaceCommands,
): RunCommand {
  const toggle = (name: DockName) => () =>
    store.setState(({ dock }) => ({ dock: dock === name ? null : name }));
  const selectBy = (tool: SelectTool) =>
    store.setState(({ inspecting }) => ({
      dock: 'inspect',
      inspecting: {
        ...inspecting,
        tab: 'select',
        problem: null,
        selecting: { ...inspecting.selecting, tool, dragged: null },
      },
    }));
  const run: Record<CommandName, () => void> = {
    ...(Object.fromEntries(
      SELECT_TOOLS.map(({ name }) => [`select-${name}`, () => selectBy(name)]),
    ) as Record<SelectCommand, () => void>),
    open: () => chooseFiles(false),
    add: () => chooseFiles(true),
    clouds: toggle('clouds'),
    flip: () => viewer.camera.toggleFlip(),
    reset: () => viewer.camera.controls.reset(),
    outside: () => void viewer.scenes.lookFrom('object'),
    inside: () => void viewer.scenes.lookFrom('enclosed'),
    frame: () => void viewer.scenes.frameAll(),
    view: toggle('view'),
    fly: () => void import('../navigation/flight.ts').then(({ toggleFlight }) => toggleFlight(viewer, store)),
    walk,
    annotate: () =>
      store.setState(({ annotating, dock }) => ({
        annotating: { ...annotating, isPlacing: !annotating.isPlacing },
        // Its clicks mean something else.
        dock: dock === 'inspect' ? null : dock,
      })),
    mode: () => store.setState(({ viewMode }) => ({ viewMode: viewModeAfter(viewMode, 1) })),
    inspect: toggle('inspect'),
    hud: () => store.setState(({ isHudVisible }) => ({ isHudVisible: !isHudVisible })),
    accuracy: toggle('accuracy'),
    effects: toggle('effects'),
    save: toggle('save'),
    link: () => void import('../links/copy-link.ts').then(({ copyLink }) => copyLink(viewer, store)),
    theme: toggleTheme,
    help: () => store.setState(({ isHelpVisible }) => ({ isHelpVisible: !isHelpVisible })),
  };
  return (name) => run[name]();
}

/** Listens to the whole window's keys; returns a function that stops this. */
export function listenToKeys(viewer: Viewer, store: ViewerStore, run: RunCommand): () => void {
  const onKeyDown = (event: KeyboardEvent) => {
    if ((event.ctrlKey || event.metaKey) && event.key.toLowerCase() === 'k' && !isGpuLost(store.getState())) {
      store.setState({ isHelpVisible: true });
      event.preventDefault();
      return;
    }
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const scope = keyScope(event.target);
    const state = store.getState();
    const { isHelpVisible, status, hasInterface } = state;
    if (event.key === 'Escape') {
      // It closes the list first.
      if (scope === 'open list') return;
      // The page that says so lies on top, and stays.
      if (isGpuLost(state)) event.preventDefault();
      else store.setState(withoutTopmost(state));
      return;
    }
    if (status !== 'running' || scope === 'text' || scope === 'open list') return;
    const command = COMMANDS.find(
      ({ key, isOfCamera }) => key === event.key.toLowerCase() && (hasInterface || isOfCamera),
    );
    // A held key repeats, which suits moving but not switching.
    if (command && !event.repeat && (!isHelpVisible || command.name === 'help')) run(command.name);
    else if (command || isHelpVisible || !mayMoveCamera(scope, event.key)) return;
    else if (!viewer.camera.handleKey(event)) return;
    event.preventDefault();
  };
  window.addEventListener('keydown', onKeyDown);
  return () => window.removeEventListener('keydown', onKeyDown);
}

/** Closes the topmost thing, as Escape does. */
function withoutTopmost(state: ViewerState): Partial<ViewerState> {
  // The dialog closes itself too, but later: keys pressed meanwhile would count as the help's.
  if (state.isHelpVisible) return { isHelpVisible: false };
  if (state.isDroppedVisible) return { isDroppedVisible: false };
  if (state.failure) return { failure: null };
  if (state.warning) return { warning: null };
  if (state.groundPart !== null) return { groundPart: null };
  const { annotating } = state;
  if (annotating.isPlacing || annotating.openIndex !== null)
    return { annotating: { ...annotating, isPlacing: false, openIndex: null } };
  return { dock: null };
}
