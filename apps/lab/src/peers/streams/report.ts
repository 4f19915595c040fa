import type { Measured, PageState, Streamed, Watched } from '../page/protocol.ts';
import type { SizePx } from '../runner/options.ts';
import type { RunReport } from '../runner/report.ts';
import type { Heap } from '../runner/visit.ts';
import type { StreamFormat } from './stream-peers.ts';

/** Bytes of the scene that had been sent at some moments of a round. */
export interface SentBytes {
  readonly firstPicture: number;
  readonly complete: number;
  /** At the end of the second of rest, in which nothing should come. */
  readonly rest: number;
  /** At the end of the turns. */
  readonly turn: number;
}

/** One peer in one round, in two browsers of its own: looking for the first picture takes the page's time. */
export interface StreamRound {
  readonly round: number;
  /** In the first browser. */
  readonly watched: Watched;
  /** In the second, as all that follows. */
  readonly streamed: Streamed;
  /** After streaming, as {@link heap}. */
  readonly state: PageState;
  readonly heap: Heap;
  readonly measured: Measured;
  readonly bytes: SentBytes;
  readonly requests: number;
}

/** A picture at rest, within the budget. */
export interface StreamPicture {
  readonly camera: string;
  /** PSNR against the same renderer's picture with everything loaded and no limit of splats, dB. */
  readonly ownPsnrDb: number;
  /** Against float64 of the scene that all files were made of, dB; null without `--scene`. */
  readonly psnrDb: number | null;
  /** Picture without a budget against float64, dB; null without `--scene`. */
  readonly finestPsnrDb: number | null;
}

/** One peer, which is filled in as it is measured. */
export interface StreamRow {
  readonly peer: string;
  readonly version: string | null;
  readonly format: StreamFormat;
  readonly rounds: StreamRound[];
  readonly pictures: StreamPicture[];
  /** Why rounds or pictures are missing. */
  readonly failures: string[];
}

/** Everything that one run found. */
export interface StreamsReport extends RunReport {
  readonly size: SizePx;
  readonly pictureSize: SizePx;
  readonly maxSplats: number;
  readonly poolBytes: number;
  /** Null without a limit. */
  readonly bitsPerSecond: number | null;
  readonly latencyMs: number;
  readonly rows: readonly StreamRow[];
}
