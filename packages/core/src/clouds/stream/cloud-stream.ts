import type { GeometryPrecision } from '../../data/packing/precision.ts';
import type { CloudSight } from './cloud-sight.ts';

/** State of a streamed scene on the GPU. */
export interface StreamReport {
  /**
   * Parts of the scene, parts on the GPU, and parts that fit. A part is a brick of the file or, for
   * streamed SOG, a chunk of 256 splats of any level.
   */
  readonly bricks: number;
  readonly residentBricks: number;
  readonly mostBricks: number;
  /** Parts that views would draw but that are not on the GPU, as far as is known. */
  readonly missingBricks: number;
  /** Missing parts that do not fit. */
  readonly refusedBricks: number;
  /** Parts being fetched, and total bytes of fetched parts. */
  readonly fetching: number;
  readonly fetchedBytes: number;
  /**
   * Bytes of fetched parts that are kept for later, compressed, outside of the GPU and mostly of the
   * page's heap; at most 256 MiB, 0 for bricks.
   */
  readonly keptBytes: number;
  /** Averaged over the last two seconds; 0 while nothing is being fetched. */
  readonly bytesPerSecond: number;
  /**
   * Whether all parts that views need and that fit are on the GPU; false before a view draws the
   * scene.
   */
  readonly isComplete: boolean;
  /**
   * Error of the last fetch; null if none failed. Resident parts stay, and fetching stops until
   * `retry`. After a SplatSourceError it also resumes once the browser is online again.
   */
  readonly error: Error | null;
}

/** Streams the parts of a scene that views need to the GPU. */
export interface CloudStream {
  report(): StreamReport;
  /**
   * Calls `listener` in its own task after the report has changed, once for all changes before.
   * Errors in it are reported as uncaught. The returned function unsubscribes; so does the end of
   * the cloud.
   */
  subscribe(listener: () => void): () => void;
  /**
   * Resumes fetching after an error; does nothing without one. It fails again if the file has
   * changed on its server.
   */
  retry(): void;
  /** @internal Settles when all missing parts that fit have arrived; null if none is missing. */
  readonly complete: Promise<void> | null;
  /**
   * @internal Sets the sights of a view, one per instance of the cloud, for each frame about to be
   *   drawn. `redraw` is called when resident parts change; the next call waits for its promise.
   */
  setSights(view: object, sights: readonly CloudSight[], redraw: () => Promise<unknown>): void;
  /** @internal Replaces the sights of the last `setSights`, without a new frame. */
  updateSights(view: object, sights: readonly CloudSight[]): void;
  /** @internal Called when a view has submitted a frame that draws the scene. */
  onFrame(): void;
  /**
   * @internal Count of parts that the view would draw but that are not on the GPU, as far as is
   *   known.
   */
  missingFor(view: object): number;
  /** @internal Cells whose leaves or splats are drawn in place of missing parts. */
  lackingCells(): Set<number>;
  /**
   * @internal Returns splats or blobs that approximate the whole scene.
   *
   * @throws errors of reading the scene; the signal's reason.
   */
  coarse(signal?: AbortSignal): Promise<CoarseSplats>;
  /** @internal Called when the view no longer draws the scene. */
  leave(view: object): void;
  /** @internal Defers all changes on the GPU until `until` settles. */
  deferUploads(until: Promise<unknown>): void;
  /** @internal */
  end(): void;
}

/**
 * Splats or blobs that approximate a whole streamed scene. They and their order do not depend on
 * the parts that are on the GPU. Unused slots between them are 0.
 */
export interface CoarseSplats {
  /** Unused slots included. */
  readonly count: number;
  readonly precision: GeometryPrecision;
  /** Packed geometry relative to the scene's origin; null if it is in the cloud's planes. */
  readonly words: Uint32Array | null;
  /**
   * Current position of the splats. The planes of a stream may change whenever this thread yields.
   */
  readonly spans: () => readonly SplatSpan[];
}

/** Successive splats of a plane, in whole chunks; the last chunk may be partial. */
export interface SplatSpan {
  /** Slot of the first splat in the plane, a multiple of 256. */
  readonly first: number;
  readonly count: number;
  /** Words of the `Chunk` structs of these splats. */
  readonly chunks: Float32Array;
}
