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
  | 'undo'
  | 'redo'
  | 'bring-back'
  | 'inspect'
  | 'mode'
  | 'reset'
  | 'frame'
  | 'hud'
  | 'accuracy'
  | 'effects'
  | 'save'
  | 'save-project'
  | 'link'
  | 'theme'
  | 'help';

export interface Command {
  readonly name: CommandName;
  readonly label: string;
  /** Compared with `KeyboardEvent.key`, lower case; `ctrl+` before keys of the history. */
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
  { name: 'undo', label: 'Undo', key: 'ctrl+z', isInPanel: true },
  { name: 'redo', label: 'Redo', key: 'ctrl+y', isInPanel: true },
  { name: 'bring-back', label: 'Bring back the last scene with its edits', key: 'z', isInPanel: true },
  { name: 'mode', label: 'Next view mode', key: 'm', isInPanel: true },
  ...SELECT_TOOLS.map(
    ({ name, label, key }) =>
      ({ name: `select-${name}`, label: `Select by ${label.toLowerCase()}`, key, isInPanel: true }) as const,
  ),
  { name: 'save', label: 'Save and share', key: 'x', word: 'Save' },
  { name: 'save-project', label: 'Save the project', key: 'ctrl+s', isInPanel: true },
  { name: 'link', label: 'Copy a link to this view', key: 'l', isInPanel: true },
  { name: 'theme', label: 'Light or dark theme', key: 't', isInPanel: true },
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
  'save-project',
  'link',
  'clouds',
  ...TRAVEL_NAMES,
  'annotate',
  'add',
  ...SELECT_TOOLS.map(({ name }) => `select-${name}` as const),
];

/** Cases with cameras of their own are shown as they are. */
const TURNING: readonly CommandName[] = ['flip', 'outside', 'inside'];

/** Parts of the state that decide which commands can do anything. */
export type CommandState = Pick<ViewerState, 'scene' | 'leftScene' | 'past' | 'undone'>;

export function commandState({ scene, leftScene, past, undone }: ViewerState): CommandState {
  return { scene, leftScene, past, undone };
}

/** Whether a command can do anything now. */
export function isAvailable(name: CommandName, { scene, leftScene, past, undone }: CommandState): boolean {
  if (name === 'undo') return past.length > 0 || leftScene !== null;
  if (name === 'redo') return undone.length > 0;
  if (name === 'bring-back') return leftScene !== null;
  if (TURNING.includes(name)) return scene?.canFlip ?? false;
  return scene !== null || !NEED_SCENE.includes(name);
}

/** A command's label, with the edit that it would undo or redo. */
export function labelNow({ name, label }: Command, { past, undone }: CommandState): string {
  const edit = name === 'undo' ? past.at(-1) : name === 'redo' ? undone.at(-1) : undefined;
  return edit ? `${label} ${edit.name}` : label;
}

/** A command's key as keyboards show it: `O`, `Ctrl+Z`. */
export function shownKey({ key }: Command): string {
  return key.replace(/(^|\+)./g, (letter) => letter.toUpperCase());
}

export type RunCommand = (name: CommandName) => void;
