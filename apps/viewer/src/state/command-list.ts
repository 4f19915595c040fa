import { TRAVEL_NAMES, type TravelName } from './camera.ts';
import type { InspectTab } from './inspecting.ts';
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
  | 'path'
  | 'annotate'
  | 'undo'
  | 'redo'
  | 'bring-back'
  | 'inspect'
  | 'select'
  | 'measure'
  | 'crop'
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
  /** Title of the group in which toolbar and help show it. */
  readonly group: string;
  readonly label: string;
  /** Compared with `KeyboardEvent.key`, lower case; `ctrl+` before keys of the history. */
  readonly key: string;
  /** Its button in the toolbar; other commands have theirs in a panel. */
  readonly bar?: BarButton;
  /** It moves the camera only, so that it is there without the interface too. */
  readonly isOfCamera?: boolean;
}

interface BarButton {
  /** One short word below the icon. */
  readonly word: string;
  /** Where room is short, buttons of high rank go into the menu. */
  readonly rank: number;
}

interface CommandGroup {
  readonly title: string;
  readonly commands: readonly Omit<Command, 'group'>[];
}

/** Commands that have both a button and a key, in the toolbar's order. */
const GROUPS: readonly CommandGroup[] = [
  {
    title: 'Open',
    commands: [
      { name: 'open', label: 'Open a scene', key: 'o', bar: { word: 'Open', rank: 0 } },
      { name: 'clouds', label: 'Files of the scene', key: 'n', bar: { word: 'Files', rank: 13 } },
      { name: 'add', label: 'Add files to the scene', key: 'j' },
      { name: 'bring-back', label: 'Bring back the last scene with its edits', key: 'z' },
    ],
  },
  {
    title: 'Move',
    commands: [
      {
        name: 'frame',
        label: 'Frame the scene',
        key: 'f',
        bar: { word: 'Frame', rank: 10 },
        isOfCamera: true,
      },
      {
        name: 'reset',
        label: 'Reset the view',
        key: 'r',
        bar: { word: 'Reset', rank: 14 },
        isOfCamera: true,
      },
      { name: 'view', label: 'View and camera', key: 'v', bar: { word: 'View', rank: 3 } },
      { name: 'outside', label: 'Look from outside', key: 'k', isOfCamera: true },
      { name: 'inside', label: 'Look from inside', key: 'y', isOfCamera: true },
      { name: 'flip', label: 'Turn upside down', key: 'u', isOfCamera: true },
      { name: 'fly', label: 'Fly', key: 'g' },
      { name: 'walk', label: 'Walk', key: 'b' },
      { name: 'path', label: 'Camera path', key: 'q' },
    ],
  },
  {
    title: 'Look into',
    commands: [
      { name: 'accuracy', label: 'Accuracy and its cost', key: 'c', bar: { word: 'Accuracy', rank: 4 } },
      { name: 'effects', label: 'Effects and their cost', key: 'e', bar: { word: 'Effects', rank: 6 } },
      { name: 'inspect', label: 'Inspect splats', key: 'i', bar: { word: 'Inspect', rank: 5 } },
      { name: 'hud', label: 'Show or hide figures', key: 'h', bar: { word: 'Figures', rank: 12 } },
      { name: 'mode', label: 'Next view mode', key: 'm' },
    ],
  },
  {
    title: 'Edit',
    commands: [
      { name: 'select', label: 'Select splats', key: '0', bar: { word: 'Select', rank: 7 } },
      ...SELECT_TOOLS.map(
        ({ name, label, key }) =>
          ({ name: `select-${name}`, label: `Select by ${label.toLowerCase()}`, key }) as const,
      ),
      { name: 'measure', label: 'Measure a distance', key: '6', bar: { word: 'Measure', rank: 8 } },
      { name: 'crop', label: 'Crop to a box', key: '7', bar: { word: 'Crop', rank: 9 } },
      { name: 'annotate', label: 'Annotate a place', key: 'p', bar: { word: 'Annotate', rank: 15 } },
      { name: 'undo', label: 'Undo', key: 'ctrl+z', bar: { word: 'Undo', rank: 11 } },
      { name: 'redo', label: 'Redo', key: 'ctrl+y' },
    ],
  },
  {
    title: 'Share',
    commands: [
      { name: 'save', label: 'Save and share', key: 'x', bar: { word: 'Save', rank: 1 } },
      { name: 'save-project', label: 'Save the project', key: 'ctrl+s' },
      { name: 'link', label: 'Copy a link to this view', key: 'l' },
    ],
  },
  {
    title: 'This page',
    commands: [
      { name: 'theme', label: 'Light or dark theme', key: 't' },
      { name: 'help', label: 'Help: gestures, commands, keys', key: '?', bar: { word: 'Help', rank: 2 } },
    ],
  },
];

export const COMMANDS: readonly Command[] = GROUPS.flatMap(({ title, commands }) =>
  commands.map((command) => ({ ...command, group: title })),
);

export const TRAVEL_COMMANDS = TRAVEL_NAMES.flatMap((each) =>
  COMMANDS.flatMap((command) => (command.name === each ? { ...command, name: each } : [])),
);

const NEED_SCENE: readonly CommandName[] = [
  'reset',
  'frame',
  'inspect',
  'select',
  'measure',
  'crop',
  'save',
  'save-project',
  'link',
  'clouds',
  ...TRAVEL_NAMES,
  'path',
  'annotate',
  'add',
  ...SELECT_TOOLS.map(({ name }) => `select-${name}` as const),
];

/** Commands that open the panel Inspect, each at a tool of its own. */
export type InspectCommand = 'inspect' | 'select' | 'measure' | 'crop';

const COMMAND_OF_TAB: Readonly<Record<InspectTab, InspectCommand>> = {
  splat: 'inspect',
  histogram: 'inspect',
  distance: 'measure',
  select: 'select',
  crop: 'crop',
};

/** The command of the tool that is open in the panel Inspect; null without one. */
export function openTool({
  dock,
  inspecting,
}: Pick<ViewerState, 'dock' | 'inspecting'>): InspectCommand | null {
  return dock === 'inspect' ? COMMAND_OF_TAB[inspecting.tab] : null;
}

/** Cases with cameras of their own are shown as they are. */
const TURNING: readonly CommandName[] = ['flip', 'outside', 'inside'];

/** Parts of the state that decide which commands can do anything. */
export type CommandState = Pick<ViewerState, 'scene' | 'leftScene' | 'past' | 'undone'>;

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
