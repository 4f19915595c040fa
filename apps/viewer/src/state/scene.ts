import type { DropCounts, LoadProgress } from '@websplatter/core';
import type { ScenePartSummary, WaitingPart } from './scene-part.ts';

/** Purpose of a scene that demonstrates something. */
export interface SceneAbout {
  readonly topic: string;
  readonly text: string;
}

/** The scene that is on the screen. */
export interface SceneSummary {
  /** For people: a built-in scene's title, a file's name, or several. */
  readonly title: string;
  /**
   * `contentKeyOf` its first file. Annotations and views are stored under it, so they stay when other
   * files join.
   */
  readonly contentKey: string;
  /** Its files, in the order in which they were opened. */
  readonly parts: readonly ScenePartSummary[];
  readonly clouds: number;
  /** Number in all clouds. */
  readonly splats: number;
  /** Degree of the spherical harmonics in the files, the highest of any cloud. */
  readonly declaredShDegree: number;
  /** Degree up to which they can be seen, the highest of any cloud. */
  readonly shDegree: number;
  /** Rows of files that could not be drawn, by reason. */
  readonly dropped: DropCounts;
  /** Sentences on its files, for example that only a coarser level was read. */
  readonly notes: readonly string[];
  readonly about: SceneAbout | null;
  /** Names of the scene's own cameras that are to be shown as they are; mostly none. */
  readonly cameras: readonly string[];
  readonly canFlip: boolean;
  /** Its y axis points down, so that the viewer turns it by itself. */
  readonly isUpsideDown: boolean;
  /** Whether it can be read again to be written as a file. */
  readonly canSave: boolean;
}

/** A problem of a scene that is shown nevertheless. */
export interface SceneWarning {
  readonly title: string;
  readonly message: string;
}

/** A file that is being loaded, or a scene that is read again. */
export interface LoadState {
  readonly title: string;
  /**
   * `make` for built-in scenes, which are computed instead of read; `keep` while a file is arranged
   * for streaming.
   */
  readonly phase: LoadProgress['phase'] | 'make' | 'keep';
  readonly loadedBytes: number;
  readonly totalBytes: number | undefined;
  readonly splats: number;
  readonly bytesPerSecond: number;
}

/** A file that was open once. */
export interface LastFile {
  readonly name: string;
  /** Whether the browser can open it, with a person's leave; else it must be chosen again. */
  readonly isReachable: boolean;
}

/** Edits that are not on the screen, and the way back to them. */
export interface LeftScene {
  /** Of the scene that they belong to. */
  readonly title: string;
  readonly bringBack: () => void;
}

/** Edits of this scene that the browser keeps beside those on the screen. */
export interface KeptVersion {
  readonly id: string;
  /** As `describeEdits` lists them. */
  readonly edits: string;
  readonly savedAtMs: number;
  /** Whether another tab goes on with them. */
  readonly isElsewhere: boolean;
  /** Shows them in place of the present ones, as a step that can be undone. */
  readonly bringBack: () => void;
}

/** Versions that can be brought back, the newest first. */
export interface KeptVersions {
  /** Whether another tab edits the scene, too. */
  readonly isElsewhere: boolean;
  readonly versions: readonly KeptVersion[];
}

/** The scene and its files. */
export interface SceneState {
  /** The scene on the screen. */
  readonly scene: SceneSummary | null;
  /** Time at which a moving scene is shown; null: its first. */
  readonly sceneTime: number | null;
  /** Whether the time of a moving scene runs. */
  readonly isScenePlaying: boolean;
  /** Whether the frame of that time is not there yet, and another one is shown. The time stands still then. */
  readonly isFrameAwaited: boolean;
  /** Bytes of a file of frames, fetched as it is played; null if all are there, and for local files. */
  readonly frameLoad: LoadState | null;
  /** The file that is being loaded. */
  readonly load: LoadState | null;
  /** Files that are opened after the one that is being loaded. */
  readonly waiting: readonly WaitingPart[];
  /** The scene on the screen, while it is read again to be drawn with another accuracy. */
  readonly preparing: LoadState | null;
  /** The last scene if it had edits that no file has, or this scene as it was when it was open last. */
  readonly leftScene: LeftScene | null;
  /** Other edits of this scene; null if there are none, or once a person has dismissed them. */
  readonly keptVersions: KeptVersions | null;
  /** The problem of the scene on the screen, until a person dismisses it. */
  readonly warning: SceneWarning | null;
  /** The file that was open before the page was loaded, to be opened again. */
  readonly lastFile: LastFile | null;
  /** Key of the file that the Scene panel moves; null for none. */
  readonly selectedPart: number | null;
}

export const FIRST_SCENE: SceneState = {
  scene: null,
  sceneTime: null,
  isScenePlaying: false,
  isFrameAwaited: false,
  frameLoad: null,
  load: null,
  waiting: [],
  preparing: null,
  leftScene: null,
  keptVersions: null,
  warning: null,
  lastFile: null,
  selectedPart: null,
};
