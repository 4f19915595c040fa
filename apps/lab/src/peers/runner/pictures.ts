import os from 'node:os';
import { Worker } from 'node:worker_threads';
import { compareImages } from '@websplatter/core/reference';
import { Remote } from '@websplatter/core/write';
import { threadPort } from '@websplatter/node';
import type { SceneCamera } from '@websplatter/scenes';
import type { Picture } from '../page/protocol.ts';
import type { SizePx } from './options.ts';
import type { BenchScene } from './scenes.ts';

/** Request to a thread. */
export interface ReferenceRequest extends SizePx {
  readonly file: string;
  readonly camera: SceneCamera;
}

/** The thread, which draws. */
type ReferenceTasks = { readonly draw: (request: ReferenceRequest) => Float64Array };

/** Most memory of a thread, in copies of its splats: as read, in Morton order, and visible. */
const COPIES = 4;
/** Of a splat in float32. */
const SPLAT_BYTES = 4 * 62;
/** Node's own limit is too low for the splats that are seen of the largest scenes. */
const MAX_HEAP_MB = 16_384;

/** Draws a scene by each camera in float64, in as many threads as fit: premultiplied RGBA. */
export async function drawReferences(
  { file, splats, cameras }: Pick<BenchScene, 'file' | 'splats' | 'cameras'>,
  { widthPx, heightPx }: SizePx,
): Promise<Float64Array[]> {
  const fitting = Math.floor(os.freemem() / (COPIES * SPLAT_BYTES * splats));
  const atOnce = Math.max(1, Math.min(cameras.length, os.availableParallelism(), fitting));
  const references: Float64Array[] = [];
  let next = 0;
  const drawSome = async () => {
    while (next < cameras.length) {
      const view = next++;
      references[view] = await drawInThread({ file, camera: cameras[view], widthPx, heightPx });
    }
  };
  await Promise.all(Array.from({ length: atOnce }, drawSome));
  return references;
}

async function drawInThread(request: ReferenceRequest): Promise<Float64Array> {
  const worker = new Worker(new URL('./reference-worker.mjs', import.meta.url), {
    resourceLimits: { maxOldGenerationSizeMb: MAX_HEAP_MB },
  });
  const remote = new Remote<ReferenceTasks>(() => threadPort('reference', worker), {
    failure: ({ error }) => error,
  });
  return remote.call('draw', request).finally(() => remote.end());
}

/** PSNR of a picture against a reference of its size, both over black and in 8 bits; dB. */
export function psnrOf(picture: Picture, reference: Float64Array): number {
  const { widthPx, heightPx } = picture;
  return compareImages(levelsOf(picture), reference, { widthPx, heightPx, quantize: 'png' }).psnrDb;
}

/** RGBA of a picture over black, 0…1. */
export function levelsOf({ rgbaBase64 }: Picture): Float64Array {
  return Float64Array.from(Buffer.from(rgbaBase64, 'base64'), (value) => value / 255);
}
