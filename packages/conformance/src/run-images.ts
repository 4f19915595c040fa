import type {
  AccuracyPreset,
  AccuracySettings,
  CloudInstance,
  FrameRasterizer,
  SplatEngine,
  SplatView,
} from '@websplatter/core';
import { describePixel, nonFiniteWord } from '@websplatter/core/inspect';
import { compareImages, type ReferenceImage } from '@websplatter/core/reference';
import type { DeviceCase, SceneCase } from './hard-case.ts';
import { type ImageResult, MIN_REFERENCE_PSNR_DB, type ResultBuilder } from './run-result.ts';
import type { CaseFrame, PlacedSet } from './run-stages.ts';

/**
 * Presets whose images are compared with float64, the most exact first. Settings that only other
 * presets have are covered by tests of their own, so that the catalogue stays within its time.
 */
export const COMPARED_PRESETS: readonly AccuracyPreset[] = ['reference', 'high', 'balanced'];

/** Clouds of a case, added once to each engine that draws them, with a view for each rasteriser. */
export class CaseViews {
  readonly #clouds: readonly PlacedSet[];
  readonly #instances = new Map<SplatEngine, readonly CloudInstance[]>();
  readonly #views = new Map<SplatEngine, Map<FrameRasterizer, SplatView>>();

  constructor(clouds: readonly PlacedSet[]) {
    this.#clouds = clouds;
  }

  instances(engine: SplatEngine): readonly CloudInstance[] {
    const added =
      this.#instances.get(engine) ??
      this.#clouds.map(({ set, modelMatrix }) => ({ cloud: engine.add(set), modelMatrix }));
    this.#instances.set(engine, added);
    return added;
  }

  view(engine: SplatEngine, rasterizer: FrameRasterizer): SplatView {
    const views = this.#views.get(engine) ?? new Map<FrameRasterizer, SplatView>();
    this.#views.set(engine, views);
    const view = views.get(rasterizer) ?? engine.createView();
    views.set(rasterizer, view);
    return view;
  }

  destroy(): void {
    for (const views of this.#views.values()) for (const view of views.values()) view.destroy();
    for (const instances of this.#instances.values()) for (const { cloud } of instances) cloud.destroy();
  }
}

/**
 * Draws the frame `frames` times, as an application would, and returns the first image.
 *
 * @param fail called for the earliest frame that differs from the first in any bit.
 */
export async function drawFrames(
  views: CaseViews,
  engine: SplatEngine,
  { camera, widthPx, heightPx }: CaseFrame,
  accuracy: { readonly preset: AccuracyPreset; readonly rasterizer: FrameRasterizer },
  frames: number,
  fail: (what: string) => void,
): Promise<Float32Array> {
  const clouds = views.instances(engine);
  const view = views.view(engine, accuracy.rasterizer);
  let first: Float32Array | undefined;
  for (let frame = 1; frame <= frames; frame++) {
    const isDrawn = view.render({ camera, clouds, widthPx, heightPx, accuracy, force: true });
    // A frame without pixels is not drawn, and that is no failure.
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
}

/** Returns the index of the first value whose bits differ, or −1. */
export function firstDifference(a: Float32Array, b: Float32Array): number {
  const [wordsA, wordsB] = [a, b].map(
    ({ buffer, byteOffset, length }) => new Uint32Array(buffer, byteOffset, length),
  );
  return wordsA.findIndex((word, i) => word !== wordsB[i]);
}

/** Compares an image with float64's: it must be finite and reach `minPsnrDb`, unless null. */
export function checkImage(
  minPsnrDb: number | null,
  preset: AccuracyPreset,
  rasterizer: FrameRasterizer,
  caseFrame: CaseFrame,
  data: Float32Array,
  reference: ReferenceImage | null,
  result: ResultBuilder,
): void {
  const where = [caseFrame.caseName, `camera ${caseFrame.cameraName}`, preset, rasterizer];
  const at = nonFiniteWord(new Uint32Array(data.buffer, data.byteOffset, data.length));
  if (at >= 0) {
    result.fail(where, `${describePixel(caseFrame.widthPx, at)}: got ${data[at]}, which is not finite`);
    return;
  }
  if (!reference || data.length === 0) return;
  const { psnrDb, maxError } = compareImages(data, reference.data, caseFrame);
  const image: ImageResult = { camera: caseFrame.cameraName, psnrDb, maxError, minPsnrDb };
  result.addImage(preset, rasterizer, image);
  if (minPsnrDb === null || psnrDb >= minPsnrDb) return;
  const worst = worstPixel(data, reference);
  result.fail(
    where,
    `${psnrDb.toFixed(2)} dB, expected at least ${minPsnrDb} dB; worst at ${describePixel(caseFrame.widthPx, worst)}: got ${data[worst]}, expected ${reference.data[worst]}`,
  );
}

/** How an image is drawn. */
export interface ImageTarget extends Pick<AccuracySettings, 'colorTarget'> {
  readonly preset: AccuracyPreset;
  readonly rasterizer: FrameRasterizer;
  /** Whether the device blends halves by truncation. */
  readonly isTruncating: boolean;
}

/** Least PSNR that a case demands of an image, dB; null if it is only reported. */
export function minPsnrOf(
  { kind, bounds }: Pick<SceneCase | DeviceCase, 'kind' | 'bounds'>,
  { preset, rasterizer, colorTarget, isTruncating }: ImageTarget,
): number | null {
  // Quads draw `reference` in halves if float32 cannot be blended, as they do `high`; tiles blend
  // in registers. Cases about such devices are made so that halves suffice.
  const isInHalves = rasterizer === 'quads' && colorTarget !== 'rgba32float' && kind === 'scene';
  const demanded = preset === 'reference' && isInHalves ? 'high' : preset;
  const bound = bounds?.[demanded];
  if (!bound) return demanded === 'reference' ? MIN_REFERENCE_PSNR_DB : null;
  return (isTruncating ? bound.minPsnrTruncatedDb : undefined) ?? bound.minPsnrDb;
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
