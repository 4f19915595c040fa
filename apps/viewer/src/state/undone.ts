import type { FramesState } from './frames.ts';
import type { HistoryState } from './history.ts';
import type { MeasuredState } from './measured.ts';
import type { MessagesState } from './messages.ts';
import type { PageState } from './page.ts';
import type { SavingsState } from './saving.ts';
import type { SessionState } from './session.ts';
import type { ViewerState } from './store.ts';

/** Slices that say nothing of a scene or its picture. */
type Passing = SessionState &
  MessagesState &
  FramesState &
  MeasuredState &
  HistoryState &
  SavingsState &
  PageState;

/**
 * How undo brings each part of the state back. A part without a line here does not compile.
 *
 * - A name: a setting of the picture, which `editPicture` undoes by itself. Parts of one name are undone together.
 * - `own`: each change is an edit of its own, made by `makeEdit`.
 * - Null: it stays. It is a place to look from, a moment, an open tool, or a fact that follows from the rest.
 */
export const UNDONE = {
  // Its files: hidden, removed, added, placed.
  scene: 'own',
  sceneTime: null,
  isScenePlaying: null,
  isFrameAwaited: null,
  frameLoad: null,
  load: null,
  waiting: null,
  preparing: null,
  leftScene: null,
  keptVersions: null,
  warning: null,
  lastFile: null,
  selectedPart: null,

  cameraIndex: null,
  isOwnCamera: null,
  isFlipped: 'up',
  isZUp: 'up',
  firstUp: null,
  look: 'look',
  travelling: null,
  groundPart: null,

  savedViews: 'own',
  path: 'own',
  isPathPlaying: null,
  playheadMs: null,
  isPathVisible: null,

  viewMode: 'viewMode',
  mapFigures: null,

  accuracyTab: null,
  accuracy: 'accuracy',
  target: 'accuracy',
  choice: 'accuracy',
  defaultAccuracy: null,
  accuracyNotices: null,
  detail: 'detail',
  isDetailChosen: 'detail',
  wholeFrameMs: null,

  comparison: 'comparison',
  splitPart: null,
  errorFigures: null,

  effects: null,
  requested: 'effects',
  isRevealPlaying: null,

  inspecting: 'own',
  annotating: 'own',
} as const satisfies Record<Exclude<keyof ViewerState, keyof Passing>, string | null>;

type Ways = typeof UNDONE;
/** Settings of the picture that are undone together. */
export type PictureSetting = Exclude<Ways[keyof Ways], 'own' | null>;
/** Parts of the state of a setting. */
export type SettingFields<Setting extends PictureSetting> = Pick<
  ViewerState,
  { [Name in keyof Ways]: Ways[Name] extends Setting ? Name : never }[keyof Ways]
>;

/** The parts of the state that make up a setting. */
export function settingFields<Setting extends PictureSetting>(
  setting: Setting,
  state: ViewerState,
): SettingFields<Setting> {
  const names = Object.keys(UNDONE) as (keyof Ways)[];
  const fields = names.filter((name) => UNDONE[name] === setting).map((name) => [name, state[name]]);
  return Object.fromEntries(fields) as SettingFields<Setting>;
}
