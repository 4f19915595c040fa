import { subscribeWithSelector } from 'zustand/middleware';
import { createStore } from 'zustand/vanilla';
import { type AccuracyState, type ComparisonState, FIRST_ACCURACY, FIRST_COMPARISON } from './accuracy.ts';
import { type AnnotatingState, FIRST_ANNOTATING } from './annotating.ts';
import { type CameraState, FIRST_CAMERA } from './camera.ts';
import { type EffectsState, FIRST_EFFECTS } from './effects.ts';
import { FIRST_FRAMES, type FramesState } from './frames.ts';
import { type HistoryState, NO_HISTORY } from './history.ts';
import { FIRST_INSPECTING, type InspectingState } from './inspecting.ts';
import { FIRST_MEASURED, type MeasuredState } from './measured.ts';
import { FIRST_MESSAGES, type MessagesState } from './messages.ts';
import { FIRST_PAGE, type PageState } from './page.ts';
import { FIRST_SAVED_VIEWS, type SavedViewsState } from './saved-view.ts';
import { FIRST_SAVINGS, type SavingsState } from './saving.ts';
import { FIRST_SCENE, type SceneState } from './scene.ts';
import { FIRST_SESSION, type SessionState } from './session.ts';
import { FIRST_VIEW_MODE, type ViewModeState } from './view-mode.ts';

/** The state of a viewer: a slice of each feature, with no field in two of them. */
export interface ViewerState
  extends SessionState,
    SceneState,
    MessagesState,
    CameraState,
    SavedViewsState,
    FramesState,
    ViewModeState,
    AccuracyState,
    ComparisonState,
    MeasuredState,
    EffectsState,
    HistoryState,
    InspectingState,
    AnnotatingState,
    SavingsState,
    PageState {}

const FIRST: ViewerState = {
  ...FIRST_SESSION,
  ...FIRST_SCENE,
  ...FIRST_MESSAGES,
  ...FIRST_CAMERA,
  ...FIRST_SAVED_VIEWS,
  ...FIRST_FRAMES,
  ...FIRST_VIEW_MODE,
  ...FIRST_ACCURACY,
  ...FIRST_COMPARISON,
  ...FIRST_MEASURED,
  ...FIRST_EFFECTS,
  ...NO_HISTORY,
  ...FIRST_INSPECTING,
  ...FIRST_ANNOTATING,
  ...FIRST_SAVINGS,
  ...FIRST_PAGE,
};

export type ViewerStore = ReturnType<typeof createViewerStore>;

export function createViewerStore() {
  return createStore<ViewerState>()(subscribeWithSelector(() => FIRST));
}
