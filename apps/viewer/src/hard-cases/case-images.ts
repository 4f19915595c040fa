import {
  type AccuracyPreset,
  type Camera,
  type CloudInstance,
  type FrameRasterizer,
  packCloud,
  readSplats,
  SplatEngine,
} from '@websplatter/core';
import {
  type DeviceCase,
  type Mutation,
  minPsnrOf,
  ORDINARY_SCENE,
  type SceneCase,
  truncatesHalves,
} from '@websplatter/hardcases';
import { Turns } from './turns.ts';

/** A case that is about images. */
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

/** An image that this device drew. */
export interface CaseImage {
  /** Premultiplied RGBA, top row first. */
  readonly data: Float32Array;
  /** Least PSNR that the tests demand of such an image at their size, dB; null for none. */
  readonly minPsnrDb: number | null;
}

/** The engine that draws the images, and whether its device blends halves by truncation. */
interface Draughtsman {
  readonly engine: SplatEngine;
  readonly isTruncating: boolean;
}

/** Draws images of cases in turns by one engine, which is requested with the first of them. */
export class CaseImages {
  readonly #turns = new Turns();
  #draughtsman: Promise<Draughtsman> | null = null;
  #ordinary: Promise<CaseImage> | null = null;
  #isDestroyed = false;
  readonly #mutation: Mutation | undefined;

  /** @param mutation a remedy of the shaders that they are drawn without; default none. */
  constructor(mutation?: Mutation) {
    this.#mutation = mutation;
  }

  /** Rejects without a GPU, with errors of drawing, and with the reason of `signal`. */
  draw(request: CaseImageRequest, signal: AbortSignal): Promise<CaseImage> {
    return this.#turns.take(async () => {
      this.#draughtsman ??= this.#create();
      return drawCase(await this.#draughtsman, request);
    }, signal);
  }

  /** Draws the splats that most cases add theirs to, once for all; the first request tells how. */
  ordinary(request: Omit<CaseImageRequest, 'hardCase' | 'camera'>): Promise<CaseImage> {
    const { front } = ORDINARY_SCENE.cameras(request.widthPx / request.heightPx);
    this.#ordinary ??= this.draw(
      { hardCase: ORDINARY_SCENE, camera: front, ...request },
      new AbortController().signal,
    );
    // The next one who asks tries again.
    this.#ordinary.catch(() => {
      this.#ordinary = null;
    });
    return this.#ordinary;
  }

  destroy(): void {
    this.#isDestroyed = true;
    this.#draughtsman?.then(
      ({ engine }) => engine.destroy(),
      () => {},
    );
  }

  async #create(): Promise<Draughtsman> {
    if (this.#isDestroyed) throw new Error('The page of the cases is closed.');
    const engine = await SplatEngine.create({ accuracy: 'reference', mutation: this.#mutation });
    void engine.lost.then(() => {
      // The next image asks for another device.
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
