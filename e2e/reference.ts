import { type Camera, cameraFromMatrices, type Harmonics, type SplatSet } from '@websplatter/core';
import type { EffectUse } from '@websplatter/core/effects';
import {
  compareImages,
  type ReferenceFrame,
  type ReferenceFunction,
  renderReference,
} from '@websplatter/core/reference';
import type { Screenshot } from './screenshot.ts';
import type { DrawnCamera } from './viewer-page.ts';

/**
 * Least PSNR of a screenshot against float64, both rounded to the screen's 8 bits. Packed geometry,
 * 8-bit spherical harmonics and half-float blending flip the rounding of single pixels: 68 dB were
 * measured on SwiftShader. Another GPU may filter and round otherwise, hence the margin; the same
 * scene the other way up reaches 15 dB.
 */
export const MIN_PSNR_DB = 45;

/** Options with which all clouds of a page are drawn. */
export interface ReferenceEffects {
  readonly effects?: readonly EffectUse[];
  /** References of the page's own effects. */
  readonly effectReferences?: Readonly<Record<string, ReferenceFunction>>;
  readonly settings?: ReferenceFrame['settings'];
}

/** The report of a page that draws one cloud, without a transform, by `camera` over `background`. */
export function drawnBy(camera: Camera, background: DrawnCamera['background']): DrawnCamera {
  const { viewMatrix, projectionMatrix, near, far } = camera;
  return {
    viewMatrix: Array.from(viewMatrix),
    projectionMatrix: Array.from(projectionMatrix),
    near,
    far,
    modelMatrices: [null],
    background,
  };
}

/**
 * Draws `sets` in float64, with the camera and the matrices that a page reports. Returns a function
 * that computes the PSNR of a screenshot of that size against the result.
 */
export function referenceImage(
  drawn: DrawnCamera,
  sets: readonly SplatSet<Harmonics>[],
  { widthPx, heightPx }: Pick<Screenshot, 'widthPx' | 'heightPx'>,
  { effects, effectReferences, settings }: ReferenceEffects = {},
): (shot: Screenshot) => number {
  const { viewMatrix, projectionMatrix, near, far, modelMatrices, opacities, background } = drawn;
  const camera = cameraFromMatrices(viewMatrix, projectionMatrix, { near, far });
  const clouds = sets.map((set, i) => ({
    set,
    modelMatrix: modelMatrices[i] ?? undefined,
    opacity: opacities?.[i],
    effects,
  }));
  const reference = renderReference({ clouds, camera, widthPx, heightPx, effectReferences, settings });
  return ({ data }) => {
    const actual = Float64Array.from(data, (value) => value / 255);
    return compareImages(actual, reference.data, { widthPx, heightPx, background, quantize: 'png' }).psnrDb;
  };
}

/** PSNR of a single screenshot against the same reference. */
export function psnrAgainstReference(
  shot: Screenshot,
  drawn: DrawnCamera,
  sets: readonly SplatSet<Harmonics>[],
  options?: ReferenceEffects,
): number {
  return referenceImage(drawn, sets, shot, options)(shot);
}
