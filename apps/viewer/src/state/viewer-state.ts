import type {
  AccuracyChoice,
  AccuracySettings,
  AccuracyTarget,
  Detail,
  EffectEntry,
  FixedDetail,
  FrameRasterizer,
  FrameStatistics,
  RasterizerReport,
  StreamReport,
} from '@websplatter/core';
import type { Annotating } from './annotating.ts';
import type { Comparison } from './comparison.ts';
import type { FailureReport } from './failure.ts';
import type { Inspecting } from './inspecting.ts';
import type { Look } from './look.ts';
import type {
  FailedMeasurement,
  JudgedPictures,
  MeasuredAccuracy,
  MeasuredEffects,
  RunningMeasurement,
} from './measured.ts';
import type { Notice } from './notice.ts';
import type { RequestedEffects } from './requested-effects.ts';
import type { SavedView } from './saved-view.ts';
import type { FilmingState, PicturingState, SavingState } from './saving.ts';
import type { WaitingPart } from './scene-part.ts';
import type { LoadState, SceneSummary, SceneWarning } from './scene-summary.ts';
import type { Travelling } from './travelling.ts';
import type { UpAxis } from './up-axis.ts';
import { isMapMode, type MapModeName, type ViewModeName } from './view-mode.ts';

/** Panels beside the image; one at a time. */
export type DockName = 'view' | 'clouds' | 'inspect' | 'accuracy' | 'effects' | 'save';

export type AccuracyTab = 'measure' | 'compare' | 'settings';

/** Extent of the frames' figures: only their pace, also their stages, or all that is known. */
export const HUD_SIZES = ['small', 'medium', 'large'] as const;
export type HudSize = (typeof HUD_SIZES)[number];

export type ViewerStatus =
  /** Asking for a GPU. */
  | 'starting'
  | 'running'
  /** There is no WebGPU here, or no code of the engine. */
  | 'unavailable'
  /** The GPU was taken away and is not back: nothing is drawn until it is requested again. */
  | 'lost'
  /** Asking for it again. */
  | 'recovering';

/** Whether a page over the viewer says that the GPU was taken away. */
export function isGpuLost({ status }: Pick<ViewerState, 'status'>): boolean {
  return status === 'lost' || status === 'recovering';
}

/** Whether the code of the view mode is still on its way: until then there is no picture. */
export function awaitsViewMode({
  viewMode,
  requested,
}: Pick<ViewerState, 'viewMode' | 'requested'>): boolean {
  return viewMode !== 'colours' && !isMapMode(viewMode) && requested['view-mode'].length === 0;
}

/** On slow devices: 20 frames a second show more of the scene than 60, which `auto` aims at. */
const COARSER_IN_MOTION: Detail = { maxFrameMs: 50 };

/**
 * The detail of frames: the chosen one. Without a choice, slow devices draw fewer splats while
 * something moves; not where two accuracies are compared, which would differ in that too.
 */
export function detailOfFrames({
  detail,
  isDetailChosen,
  wholeFrameMs,
  comparison,
}: Pick<ViewerState, 'detail' | 'isDetailChosen' | 'wholeFrameMs' | 'comparison'>): Detail {
  const isCoarser = !isDetailChosen && wholeFrameMs !== null && comparison?.kind !== 'split';
  return isCoarser ? COARSER_IN_MOTION : detail;
}

/** A file that was open once. */
export interface LastFile {
  readonly name: string;
  /** Whether the browser can open it, with a person's leave; else it must be chosen again. */
  readonly isReachable: boolean;
}

/** Pace of the newest run of frames. */
export interface FrameRate {
  /** Mean time between frames. */
  readonly frameMs: number;
  readonly framesPerSecond: number;
}

/** The calls that asked the engine for one frame: of both sides, in a split image. */
export interface RenderCall {
  /** CPU time until they returned. */
  readonly elapsedMs: number;
}

/** The figures of an error map. */
export interface ErrorFigures {
  /** Largest difference of a channel, in steps of an 8-bit channel. */
  readonly maxSteps: number;
  /** Part of the pixels in each class of errors, 0…1. */
  readonly parts: readonly number[];
}

/** The figures of a view mode's map. */
export type MapFigures = {
  readonly mode: MapModeName;
  /** `restedFrames` of the picture that was counted. */
  readonly restedFrames: number;
} & (
  | {
      readonly kind: 'cost';
      /** The rasteriser of the picture: tiles go through lists, quads blend everything. */
      readonly rasterizer: FrameRasterizer;
      readonly max: number;
      readonly mean: number;
      /** Where the scale ends; 1 % of tiles or pixels may have more. */
      readonly end: number;
      /** Part of the steps that blend a splat, 0…1. */
      readonly blendedPart: number;
    }
  | {
      readonly kind: 'contribution';
      /** Splats that culling kept. */
      readonly splats: number;
      /** Those of them that contribute too little to be seen. */
      readonly unseen: number;
    }
  /** Why there is no map. */
  | { readonly kind: 'failure'; readonly message: string }
);

/** What is there of all scenes that stream. */
export type Streaming = Pick<
  StreamReport,
  'bricks' | 'residentBricks' | 'missingBricks' | 'fetchedBytes' | 'bytesPerSecond' | 'error'
>;

export interface ViewerState {
  readonly status: ViewerStatus;
  /** Why there is no GPU, in the browser's words. */
  readonly statusReason: string;
  /** Whether the reason is that the engine's code could not be fetched. */
  readonly isCodeMissing: boolean;
  /** Wait before the viewer asks for a lost GPU again by itself, ms; null if it does not. */
  readonly retryWaitMs: number | null;
  readonly scene: SceneSummary | null;
  readonly load: LoadState | null;
  /** Files that are opened when the one that is being loaded is there. */
  readonly waiting: readonly WaitingPart[];
  /** Key of the file that the Scene panel moves; null for none. */
  readonly selectedPart: number | null;
  /** The scene on the screen, while it is read again to be drawn with another accuracy. */
  readonly preparing: LoadState | null;
  readonly saving: SavingState | null;
  /** The scene that is being written as a web page. */
  readonly savingPage: SavingState | null;
  readonly picturing: PicturingState | null;
  readonly filming: FilmingState | null;
  readonly failure: FailureReport | null;
  /** The problem of the scene that is shown; stays until it is dismissed. */
  readonly warning: SceneWarning | null;
  /** The file that was open before the page was loaded, to be opened again. */
  readonly lastFile: LastFile | null;
  /** A sentence that needs no answer; some offer one. */
  readonly notice: string | Notice | null;
  /** Which of the scene's cameras was chosen last. */
  readonly cameraIndex: number;
  /** Whether that camera itself is shown, not an orbit that went on from it. */
  readonly isOwnCamera: boolean;
  readonly isFlipped: boolean;
  /** Whether there is more than the picture: toolbar, panels and their keys (`?noui` has none). */
  readonly hasInterface: boolean;
  /** The axis of the scene's own that its first view shows upwards, or comes closest to that. */
  readonly firstUp: UpAxis;
  /** The z axis of the drawn scene points up, not the y axis. */
  readonly isZUp: boolean;
  readonly look: Look;
  readonly viewMode: ViewModeName;
  /** Views that a person has saved of this scene. */
  readonly savedViews: readonly SavedView[];
  readonly annotating: Annotating;
  /** Whether the camera follows the path through the saved views, or that of settings. */
  readonly isPathPlaying: boolean;
  /** Null while the camera moves around the scene. */
  readonly travelling: Travelling | null;
  /** How much of the ground to walk on has been made, 0…1; null while none is being made. */
  readonly groundPart: number | null;
  readonly isHudVisible: boolean;
  readonly hudSize: HudSize;
  /** Whether the figures stay as they are, to be read and copied. */
  readonly isHudFrozen: boolean;
  readonly isHelpVisible: boolean;
  /** The panel that is shown beside the image. */
  readonly dock: DockName | null;
  /** Height of a panel that is a sheet, as on phones, as a part of the window's: of `SHEET_PARTS`. */
  readonly sheetPart: number;
  readonly accuracyTab: AccuracyTab;
  /** Settings that frames are drawn with: asked for, or chosen because of the target. */
  readonly accuracy: AccuracySettings;
  /** Settings that this device begins with; the page's address does not mention them. */
  readonly defaultAccuracy: AccuracySettings;
  /** The outcome to keep in every scene; null if settings were chosen by hand. */
  readonly target: AccuracyTarget | null;
  /** The settings chosen for the target, and why; null until this scene has been measured. */
  readonly choice: AccuracyChoice | null;
  /** Settings that the GPU cannot honour, in words. */
  readonly accuracyNotices: readonly string[];
  /** How many splats are asked for; by default all of them. */
  readonly detail: Detail;
  /** Whether a person or the address asked for that. */
  readonly isDetailChosen: boolean;
  /** Time of a frame of all splats where this device is slow to draw it, ms; else null. */
  readonly wholeFrameMs: number | null;
  readonly comparison: Comparison | null;
  readonly measuring: RunningMeasurement | null;
  /** Why the last measurement came to nothing, if it did. */
  readonly failedMeasurement: FailedMeasurement | null;
  readonly measured: MeasuredAccuracy | null;
  /** Of the measured presets, as far as they have been drawn; null for another image. */
  readonly judged: JudgedPictures | null;
  /** The measured preset whose picture is shown while the pointer is on its row. */
  readonly looked: string | null;
  /** Effects on and off, and why: of each frame while listed, else of the frame at rest. */
  readonly effects: readonly EffectEntry[];
  readonly effectCosts: MeasuredEffects | null;
  /** Effects that panels ask for; another scene begins without any. */
  readonly requested: RequestedEffects;
  /** Whether the effect `reveal` lets the scene appear by itself. */
  readonly isRevealPlaying: boolean;
  /** Inspection, distances and crop of this scene; another scene begins without any. */
  readonly inspecting: Inspecting;
  /** How far the image on the screen is from `reference`, if that is asked for and known. */
  readonly errorFigures: ErrorFigures | null;
  /** Figures of the view mode's map; those of the last rest while the picture moves. */
  readonly mapFigures: MapFigures | null;
  /** Place of a split image's line, 0…1 of its width. */
  readonly splitPart: number;
  /** Whether the list of reasons for which splats were left out is open. */
  readonly isDroppedVisible: boolean;
  readonly adapterLabel: string;
  readonly widthPx: number;
  readonly heightPx: number;
  /** Another number for each scene, view, size and detail that came to rest, at any accuracy. */
  readonly imageId: number;
  /** How many frames had been drawn when the image came to rest. */
  readonly restedFrames: number;
  readonly statistics: FrameStatistics | null;
  /** The rasteriser after that frame, and the facts known about both. */
  readonly rasterizer: RasterizerReport | null;
  /** The detail that was drawn with last. */
  readonly drawnDetail: FixedDetail;
  /** The same of the right side of a split image; null without one. */
  readonly rightStatistics: FrameStatistics | null;
  readonly rightRasterizer: RasterizerReport | null;
  /** Null where nothing streams. */
  readonly streaming: Streaming | null;
  readonly lastRender: RenderCall | null;
  /** Null after a single frame, which has no pace. */
  readonly frameRate: FrameRate | null;
  /** Nothing changes, so nothing is drawn. */
  readonly isIdle: boolean;
}
