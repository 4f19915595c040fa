import type { Loaded, Measured, PageState } from '../page/protocol.ts';
import type { RunReport } from '../runner/report.ts';
import type { SceneFormat } from '../runner/scenes.ts';
import type { Heap } from '../runner/visit.ts';

/** One peer in one round, in a browser of its own. */
export interface Round {
  /** From 0; of a peer that failed in one, that is missing. */
  readonly round: number;
  readonly loaded: Loaded;
  /** Null where loads alone are measured. */
  readonly measured: Measured | null;
  readonly state: PageState;
  readonly heap: Heap;
}

/** How far a picture is from float64, both rounded to 8 bits. */
export interface PictureError {
  readonly camera: string;
  readonly psnrDb: number;
}

/** One peer with one scene, which is filled in as it is measured. */
export interface Row {
  readonly peer: string;
  readonly isFloor: boolean;
  /** Null where the peer is no package. */
  readonly version: string | null;
  /** Whether the peer reads the scene's format; it is left out where not. */
  isReader: boolean;
  readonly rounds: Round[];
  readonly pictures: PictureError[];
  /** Why rounds or pictures are missing. */
  readonly failures: string[];
}

export interface SceneReport {
  readonly scene: string;
  readonly format: SceneFormat;
  readonly fileBytes: number;
  readonly splats: number;
  readonly shDegree: number;
  readonly rows: readonly Row[];
}

/** Everything that one run found. */
export interface Report extends RunReport {
  /** Whether the page was given the scenes as files, instead of fetching them. */
  readonly isFromFile: boolean;
  readonly isLoads: boolean;
  readonly widthPx: number;
  readonly heightPx: number;
  readonly pictureWidthPx: number;
  readonly pictureHeightPx: number;
  readonly jumps: number;
  readonly scenes: readonly SceneReport[];
}
