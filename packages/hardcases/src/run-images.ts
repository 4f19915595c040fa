import type { AccuracyPreset, SplatEngine } from '@websplatter/core';
import { describePixel, nonFiniteWord } from '@websplatter/core/inspect';
import { compareImages, type ReferenceImage } from '@websplatter/core/reference';
import type { SceneCase } from './hard-case.ts';
import { type ImageResult, MIN_REFERENCE_PSNR_DB, type ResultBuilder } from './run-result.ts';
import type { CasePicture } from './run-stages.ts';

/**
 * Presets whose pictures are held against float64, the most exact first. What others do not share with these is in each
 * setting's own tests, so that the catalogue stays within its time.
 */
export const COMPARED_PRESETS: readonly AccuracyPreset[] = ['reference', 'high', 'balanced'];

/**
 * Draws the picture as often as asked, as an application would, and answers the first of them.
 *
 * @param fail is told of every frame that is not the first one bit for bit.
 */
export async function drawPicture(
  engine: SplatEngine,
  { clouds, camera, widthPx, heightPx }: CasePicture,
  frames: number,
  fail: (what: string) => void,
): Promise<Float32Array> {
  const instances = clouds.map(({ set, modelMatrix }) => ({ cloud: engine.add(set), modelMatrix }));
  const view = engine.createView();
  try {
    let first: Float32Array | undefined;
    for (let frame = 1; frame <= frames; frame++) {
      const isDrawn = view.render({ camera, clouds: instances, widthPx, heightPx, force: true });
      // A picture without pixels is none, and nothing to complain of.
      if (!isDrawn && widthPx * heightPx === 0) return new Float32Array();
      const { data } = await view.readPixels();
      first ??= data;
      const at = firstDifference(first, data);
      if (at < 0) continue;
      fail(
        `frame ${frame} of ${frames}, ${describePixel(widthPx, at)}: got ${data[at]}, the first had ${first[at]}`,
      );
      break;
    }
    return first!;
  } finally {
    view.destroy();
    for (const { cloud } of instances) cloud.destroy();
  }
}

/** Index of the first value whose bits differ, or −1. */
export function firstDifference(a: Float32Array, b: Float32Array): number {
  const [wordsA, wordsB] = [a, b].map(
    ({ buffer, byteOffset, length }) => new Uint32Array(buffer, byteOffset, length),
  );
  return wordsA.findIndex((word, i) => word !== wordsB[i]);
}

/** Holds a picture against the float64 one: finite always, and as close as the case says. */
export function checkImage(
  { bounds }: Pick<SceneCase, 'bounds'>,
  preset: AccuracyPreset,
  picture: CasePicture,
  data: Float32Array,
  reference: ReferenceImage | null,
  result: ResultBuilder,
): void {
  const where = [picture.caseName, `camera ${picture.cameraName}`, preset];
  const at = nonFiniteWord(new Uint32Array(data.buffer, data.byteOffset, data.length));
  if (at >= 0) {
    result.fail(where, `${describePixel(picture.widthPx, at)}: got ${data[at]}, which is not finite`);
    return;
  }
  if (!reference || data.length === 0) return;
  const minPsnrDb = minPsnrOf(bounds, preset);
  const { psnrDb, maxError } = compareImages(data, reference.data, picture);
  const image: ImageResult = { camera: picture.cameraName, psnrDb, maxError, minPsnrDb };
  result.addImage(preset, image);
  if (minPsnrDb === null || psnrDb >= minPsnrDb) return;
  const worst = worstPixel(data, reference);
  result.fail(
    where,
    `${psnrDb.toFixed(2)} dB, expected at least ${minPsnrDb} dB; worst at ${describePixel(picture.widthPx, worst)}: got ${data[worst]}, expected ${reference.data[worst]}`,
  );
}

function minPsnrOf(bounds: SceneCase['bounds'], preset: AccuracyPreset): number | null {
  return bounds?.[preset]?.minPsnrDb ?? (preset === 'reference' ? MIN_REFERENCE_PSNR_DB : null);
}

function worstPixel(data: Float32Array, reference: ReferenceImage): number {
  let worst = 0;
  let largest = -1;
  for (const [i, value] of data.entries()) {
    const error = Math.abs(value - reference.data[i]);
    if (error <= largest) continue;
    worst = i;
    largest = error;
  }
  return worst;
}
