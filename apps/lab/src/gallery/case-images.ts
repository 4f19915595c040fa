import {
  type DeviceCase,
  type Mutation,
  minPsnrOf,
  ORDINARY_SCENE,
  type SceneCase,
  truncatesHalves,
} from '@websplatter/conformance';
import {
  type AccuracyPreset,
  type Camera,
  type CloudInstance,
  type FrameRasterizer,
  packCloud,
  readSplats,
  type SplatEngine,
} from '@websplatter/core';
import { createEngine } from '@websplatter/core/inspect';

/** Runs tasks one at a time, in the order of requests, each when the page is idle. */
export class Turns {
  readonly #whenIdle: () => Promise<void>;
  #last: Promise<unknown> = Promise.resolve();

  /** @param whenIdle resolves when the page has time; for tests. */
  constructor(whenIdle = pageIsIdle) {
    this.#whenIdle = whenIdle;
  }

  /**
   * Settles as `work` does. Rejects with the reason of `signal` if it aborts before the task
   * starts.
   */
  take<Result>(work: () => Promise<Result>, signal: AbortSignal): Promise<Result> {
    const turn = this.#last.then(async () => {
      signal.throwIfAborted();
      await this.#whenIdle();
      signal.throwIfAborted();
      return work();
    });
    // The next task follows success and failure alike.
    this.#last = turn.catch(() => {});
    return turn;
  }
}

/** Longest wait for an idle page, ms: a busy page gets its work done too. */
const LONGEST_WAIT_MS = 500;

function pageIsIdle(): Promise<void> {
  return new Promise((resolve) => {
    // Safari has no `requestIdleCallback`.
    if (typeof requestIdleCallback === 'function')
      requestIdleCallback(() => resolve(), { timeout: LONGEST_WAIT_MS });
    else setTimeout(resolve);
  });
}

/** A case with an image. */
export type ImageCase = SceneCase | DeviceCase;

export interface SizePx {
  readonly widthPx: number;
  readonly heightPx: number;
}

export interface CaseImageRequest extends SizePx {
  readonly hardCase: ImageCase;
  readonly camera: Camera;
  readonly preset: AccuracyPreset;
  readonly rasterizer: FrameRasterizer;
}

/** An image drawn by this device. */
export interface CaseImage {
  /** Premultiplied RGBA, top row first. */
  readonly data: Float32Array;
  /** Least PSNR that the tests require at their size, dB; null for none. */
  readonly minPsnrDb: number | null;
}

/** The engine that draws the images, and whether its device truncates float16 when blending. */
interface Draughtsman {
  readonly engine: SplatEngine;
  readonly isTruncating: boolean;
}

/** Draws images of cases one at a time with one engine, which is created for the first image. */
export class CaseImages {
  readonly #turns = new Turns();
  #draughtsman: Promise<Draughtsman> | null = null;
  #ordinary: Promise<CaseImage> | null = null;
  #isDestroyed = false;
  readonly #mutation: Mutation | undefined;

  /** @param mutation a shader remedy to disable; default: none. */
  constructor(mutation?: Mutation) {
    this.#mutation = mutation;
  }

  /** Rejects if there is no GPU, if drawing fails, or with the reason of `signal`. */
  draw(request: CaseImageRequest, signal: AbortSignal): Promise<CaseImage> {
    return this.#turns.take(async () => {
      this.#draughtsman ??= this.#create();
      return drawCase(await this.#draughtsman, request);
    }, signal);
  }

  /**
   * Draws the splats that most cases have in common, once; the first request determines the size.
   */
  ordinary(request: Omit<CaseImageRequest, 'hardCase' | 'camera'>): Promise<CaseImage> {
    const { front } = ORDINARY_SCENE.cameras(request.widthPx / request.heightPx);
    this.#ordinary ??= this.draw(
      { hardCase: ORDINARY_SCENE, camera: front, ...request },
      new AbortController().signal,
    );
    // After a failure, the next request tries again.
    this.#ordinary.catch(() => {
      this.#ordinary = null;
    });
    return this.#ordinary;
  }

  destroy(): void {
    this.#isDestroyed = true;
    // `draw` has reported an engine that could not be made.
    this.#draughtsman?.then(
      ({ engine }) => engine.destroy(),
      () => {},
    );
  }

  async #create(): Promise<Draughtsman> {
    if (this.#isDestroyed) throw new Error('The page of the cases is closed.');
    const engine = await createEngine({ accuracy: 'reference' }, { mutation: this.#mutation });
    void engine.lost.then(() => {
      // The next image requests a new device.
      this.#draughtsman = null;
    });
    return { engine, isTruncating: await truncatesHalves(engine.device) };
  }
}

async function drawCase(
  { engine, isTruncating }: Draughtsman,
  { hardCase, camera, widthPx, heightPx, preset, rasterizer }: CaseImageRequest,
): Promise<CaseImage> {
  const { settings } = engine.resolveAccuracy({ preset, rasterizer });
  const clouds: CloudInstance[] = [];
  const view = engine.createView();
  try {
    for (const given of hardCase.clouds()) {
      const set = 'set' in given ? given.set : await readSplats(given.file, { shPrecision: 'f32' });
      const { geometryPrecision, shPrecision } = settings;
      const packed = packCloud(set, { geometryPrecision, shPrecision });
      const cloud = engine.addPacked(packed, { name: hardCase.name });
      clouds.push({ cloud, modelMatrix: given.modelMatrix });
    }
    view.render({ camera, clouds, widthPx, heightPx, accuracy: settings });
    const { data } = await view.readPixels();
    const { colorTarget } = settings;
    return { data, minPsnrDb: minPsnrOf(hardCase, { preset, rasterizer, colorTarget, isTruncating }) };
  } finally {
    view.destroy();
    for (const { cloud } of clouds) cloud.destroy();
  }
}
