import type { FrustumSide } from '../data/camera/frustum.ts';
import type { CoarseSplats } from './coarse-splats.ts';

/** How a view sees a cloud whose scene is not all on the GPU. */
export interface CloudSight {
  /** Its cut: see `LevelCut`. */
  readonly cut: {
    readonly camera: readonly [number, number, number];
    readonly squaredPerDistance: number;
    readonly leastSquared: number;
    readonly margin: number;
  };
  /** Factor of squared thresholds by which a budget has shifted them; 0 where no error is allowed. */
  readonly squaredShift: number;
  /**
   * Most splats that it draws, if it has a budget, and whether it allows any error until then; else
   * it draws what the cut asks for.
   */
  readonly budget?: { readonly splats: number; readonly isFinest: boolean } | null;
  /** Sides of its frustum, about the scene's origin. */
  readonly sides: readonly FrustumSide[];
}

/** What is on the GPU of a scene that streams. */
export interface StreamReport {
  /**
   * Parts of the scene, bricks of its file or, of streamed SOG, chunks of 256 splats of all levels;
   * those on the GPU; and those that it has room for.
   */
  readonly bricks: number;
  readonly residentBricks: number;
  readonly mostBricks: number;
  /** Parts that views would draw, as far as is known, and that are not there. */
  readonly missingBricks: number;
  /** Of these, those for which there is no room. */
  readonly refusedBricks: number;
  /** Parts that are being fetched, and bytes of those that were. */
  readonly fetching: number;
  readonly fetchedBytes: number;
  /** Of the last two seconds; 0 while nothing is being fetched. */
  readonly bytesPerSecond: number;
  /** Whether all that views need is there, as far as there is room; false before a view shows it. */
  readonly isComplete: boolean;
  /**
   * Why the last fetch failed; null where none has. What is there stays, and nothing more is fetched
   * until `retry`, or, after a SplatSourceError, until the browser is online again.
   */
  readonly error: Error | null;
}

/** Brings what views need of a scene to the GPU. */
export interface CloudStream {
  report(): StreamReport;
  /**
   * Calls `listener` in a task of its own after the report has changed, once for all changes before.
   * An error in it is reported as an uncaught one.
   * Returns a function that ends this; the end of the cloud does, too.
   */
  subscribe(listener: () => void): () => void;
  /**
   * Fetches again what could not be; nothing without an error. Of a file that has changed on its
   * server, that fails again.
   */
  retry(): void;
  /** @internal Settles when nothing is missing that there is room for; null if nothing is. */
  readonly complete: Promise<void> | null;
  /**
   * @internal Says how a view sees the scene, once for each time that it shows it and with each
   *   frame that it is about to draw; null while that is not known. `redraw` is called when what is
   *   there changes; the next call waits for its promise.
   */
  see(view: object, sights: readonly CloudSight[] | null, redraw: () => Promise<unknown>): void;
  /** @internal Says how a view sees the scene in the frame of its last `see`, now that it is known. */
  learn(view: object, sights: readonly CloudSight[]): void;
  /** @internal A view has submitted a frame that shows the scene. */
  shown(): void;
  /** @internal Parts that the view would draw, as far as is known, and that are not there. */
  missingFor(view: object): number;
  /** @internal Cells whose leaves, or splats, stand for what views lack. */
  lackingCells(): Set<number>;
  /**
   * @internal Returns splats or blobs that show all of the scene coarsely.
   *
   * @throws the errors of reads of the scene; the signal's reason.
   */
  coarse(signal?: AbortSignal): Promise<CoarseSplats>;
  /** @internal The view shows the scene no longer. */
  leave(view: object): void;
  /** @internal What is on the GPU stays as it is until `until` settles. */
  hold(until: Promise<unknown>): void;
  /** @internal */
  end(): void;
}
