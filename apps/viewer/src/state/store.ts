import {
  type AccuracyChoice,
  type AccuracySettings,
  type AccuracyWish,
  type DropCounts,
  type EffectEntry,
  type FrameStatistics,
  type LoadProgress,
  resolveAccuracy,
} from '@websplatter/core';
import type { AccuracyTable, EffectCost, MeasureProgress } from '@websplatter/core/measure';
import { createStore, type StoreApi } from 'zustand/vanilla';
import type { ErrorFigures } from '../comparison/error-map.ts';
import type { FrameRate } from '../drawing/frame-meter.ts';
import type { ErrorReport } from '../messages/failure-report.ts';
import type { SceneWarning } from '../scene/dropped-splats.ts';
import type { SceneAbout } from '../scene/scene-source.ts';
import { addressWithAccuracy } from '../words/accuracy-text.ts';

/** The scene that is on the screen. */
export interface SceneSummary {
  /** For people: a built-in scene's title, a file's name. */
  readonly title: string;
  readonly clouds: number;
  /** Of all clouds. */
  readonly splats: number;
  /** Degree of the spherical harmonics in the files, the highest of any cloud. */
  readonly declaredShDegree: number;
  /** Degree up to which they can be seen, the highest of any cloud. */
  readonly shDegree: number;
  /** Rows of files that could not be drawn, by reason. */
  readonly dropped: DropCounts;
  readonly about: SceneAbout | null;
  /** Names of the cameras that the scene comes with and that are to be shown as they are; mostly none. */
  readonly cameras: readonly string[];
  readonly canFlip: boolean;
}

/** A scene on its way. */
export interface LoadState {
  readonly title: string;
  /** `make` for built-in scenes, which are computed instead of read. */
  readonly phase: LoadProgress['phase'] | 'make';
  readonly loadedBytes: number;
  readonly totalBytes: number | undefined;
  readonly splats: number;
}

/** What one side of a split picture shows: `current` follows the chosen accuracy. */
export type ComparisonSide = 'current' | AccuracySettings;

/** Two accuracies of the same view, shown at once. */
export type Comparison =
  /** Side by side, divided by a line that can be moved. */
  | { readonly kind: 'split'; readonly left: ComparisonSide; readonly right: ComparisonSide }
  /** How far the shown accuracy is from `reference`, pixel by pixel. */
  | { readonly kind: 'error' };

/** Panels beside the picture; one at a time. */
export type DockName = 'accuracy' | 'effects';
/** Both can be measured. */
export type MeasuredThing = DockName;

export const ACCURACY_TABS = ['measure', 'compare', 'settings'] as const;
export type AccuracyTab = (typeof ACCURACY_TABS)[number];

export type ViewerStatus =
  /** Asking for a GPU. */
  | 'starting'
  | 'running'
  /** There is no WebGPU here. */
  | 'unavailable'
  /** The GPU was taken away: nothing can be drawn until it is asked for again. */
  | 'lost';

export interface ViewerState {
  readonly status: ViewerStatus;
  /** Why the status is `unavailable` or `lost`, as the browser says it. */
  readonly statusReason: string;
  readonly scene: SceneSummary | null;
  readonly load: LoadState | null;
  readonly error: ErrorReport | null;
  /** What is wrong with the scene that is shown; stays until it is dismissed. */
  readonly warning: SceneWarning | null;
  /** One sentence that needs no answer. */
  readonly notice: string | null;
  /** Which of the scene's cameras was chosen last. */
  readonly cameraIndex: number;
  /** That camera itself is shown, not an orbit that went on from it. */
  readonly isOwnCamera: boolean;
  readonly isFlipped: boolean;
  readonly isHudVisible: boolean;
  readonly isHelpVisible: boolean;
  /** The panel that is shown beside the picture. */
  readonly dock: DockName | null;
  readonly accuracyTab: AccuracyTab;
  /** What pictures are drawn with, as it was asked for or chosen because of the wish. */
  readonly accuracy: AccuracySettings;
  /** What is to be kept in every scene; null where settings were chosen by hand. */
  readonly wish: AccuracyWish | null;
  /** What was chosen because of the wish, and why; null until this scene has been measured. */
  readonly choice: AccuracyChoice | null;
  /** What of that the GPU cannot do, in words. */
  readonly accuracyNotices: readonly string[];
  readonly comparison: Comparison | null;
  /** A measurement under way. */
  readonly sweep: (MeasureProgress & { readonly of: MeasuredThing }) | null;
  /** Why the last measurement came to nothing, where it did. */
  readonly sweepProblem: { readonly of: MeasuredThing; readonly text: string } | null;
  readonly measured: MeasuredAccuracy | null;
  /** What there is in the picture and what is not, and why: of each frame while they are shown, else of those that stand. */
  readonly effects: readonly EffectEntry[];
  readonly effectCosts: MeasuredEffects | null;
  /** How far the picture that stands is from `reference`, where that is asked for and known. */
  readonly errorFigures: ErrorFigures | null;
  /** Where the line of a split picture is, 0…1 of its width. */
  readonly splitPart: number;
  /** The list of reasons for which splats were left out. */
  readonly isDroppedVisible: boolean;
  readonly adapterLabel: string;
  readonly widthPx: number;
  readonly heightPx: number;
  /** Another number for each scene, view and size that came to rest on the screen, whatever its accuracy. */
  readonly pictureId: number;
  /** How many frames had been drawn when the picture came to rest. */
  readonly restedFrames: number;
  readonly statistics: FrameStatistics | null;
  /** Pace of the newest run of frames; null where that was a single one. */
  readonly frameRate: FrameRate | null;
  /** Nothing changes, so nothing is drawn. */
  readonly isIdle: boolean;
}

/** Which picture was measured, and on what. */
export interface MeasuredPicture {
  /** Others make what was measured stale. */
  readonly pictureId: number;
  readonly isSoftware: boolean;
}

/** What accuracy was measured to cost. */
export interface MeasuredAccuracy extends MeasuredPicture {
  readonly table: AccuracyTable;
}

/** What effects were measured to cost. */
export interface MeasuredEffects extends MeasuredPicture {
  readonly costs: readonly EffectCost[];
  /** What was drawn with: others make it stale. */
  readonly accuracy: AccuracySettings;
}

/** @param current what is chosen: settings, or a wish. */
export function sideAccuracy<T>(side: ComparisonSide, current: T): AccuracySettings | T {
  return side === 'current' ? current : side;
}

export type ViewerStore = StoreApi<ViewerState>;

export function createViewerStore(): ViewerStore {
  return createStore<ViewerState>(() => ({
    status: 'starting',
    statusReason: '',
    scene: null,
    load: null,
    error: null,
    warning: null,
    notice: null,
    cameraIndex: 0,
    isOwnCamera: false,
    isFlipped: false,
    isHudVisible: true,
    isHelpVisible: false,
    dock: null,
    accuracyTab: 'measure',
    accuracy: resolveAccuracy(),
    wish: null,
    choice: null,
    accuracyNotices: [],
    comparison: null,
    sweep: null,
    measured: null,
    sweepProblem: null,
    effects: [],
    effectCosts: null,
    errorFigures: null,
    splitPart: 0.5,
    isDroppedVisible: false,
    adapterLabel: '',
    widthPx: 0,
    heightPx: 0,
    pictureId: 0,
    restedFrames: 0,
    statistics: null,
    frameRate: null,
    isIdle: true,
  }));
}

/** The viewer's state in one word, for style sheets and for tests (`data-state` of the document's element). */
export type DocumentState = 'starting' | 'loading' | 'ready' | 'error' | 'unavailable' | 'lost';

export function documentState(state: ViewerState): DocumentState {
  if (state.status === 'unavailable' || state.status === 'lost') return state.status;
  if (state.load) return 'loading';
  if (state.error) return 'error';
  return state.status === 'running' && state.scene ? 'ready' : 'starting';
}

/** For how long the address waits for the next change: browsers count how often it is written. */
const ADDRESS_DELAY_MS = 250;

/** Keeps the accuracy in the page's address, so that it can be shared; returns what stops that. */
export function mirrorToAddress(store: ViewerStore): () => void {
  let timer: ReturnType<typeof setTimeout> | undefined;
  const write = () => {
    const { wish, accuracy } = store.getState();
    const address = addressWithAccuracy(new URL(location.href), wish ?? accuracy);
    history.replaceState(history.state, '', address);
  };
  const unsubscribe = store.subscribe((state, before) => {
    if (state.accuracy === before.accuracy && state.wish === before.wish) return;
    clearTimeout(timer);
    timer = setTimeout(write, ADDRESS_DELAY_MS);
  });
  return () => {
    clearTimeout(timer);
    unsubscribe();
  };
}

export function documentTitle({ scene }: ViewerState): string {
  return scene ? `${scene.title} · WebSplatter` : 'WebSplatter';
}

/** Keeps the document's state and title in step with the store; returns what stops that. */
export function mirrorToDocument(store: ViewerStore, target: Document): () => void {
  const write = (state: ViewerState) => {
    const word = documentState(state);
    const title = documentTitle(state);
    // Written only on change: the store changes with every frame.
    if (target.documentElement.dataset.state !== word) target.documentElement.dataset.state = word;
    if (target.title !== title) target.title = title;
  };
  write(store.getState());
  return store.subscribe(write);
}
