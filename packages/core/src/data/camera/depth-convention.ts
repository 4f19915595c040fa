import type { Camera } from './camera.ts';

/** How the host renderer stores depth. */
export interface DepthConvention {
  /** `greater-equal` for reversed depth: 1 at the near plane. */
  readonly compare: 'less-equal' | 'greater-equal';
  /**
   * `projection`: the depth of the camera's projection matrix, from 0 to 1. `logarithmic`:
   * log2(depth/near)/log2(far/near) for perspective cameras, linear between near and far for
   * orthographic ones.
   */
  readonly mapping: 'projection' | 'logarithmic';
}

/**
 * Stored depth of a point at view depth d and normalised device coordinates x, y (−1…1, y up):
 * offset + factor·f(d) + slope·(x, y), where f(d) is 1/d, d or log2 d.
 */
export interface DepthMapping {
  readonly offset: number;
  readonly factor: number;
  /** 0, except for an oblique near plane: mirrors use their surface as one. */
  readonly slope: readonly [number, number];
}

/** Stored depths outside of 0…1 by no more than this are due to rounding. */
const ROUNDING = 1e-5;

/**
 * Returns the mapping in float64. f(d) is 1/d for perspective projections, d for orthographic ones,
 * and log2 d for the logarithmic depth of perspective cameras.
 */
export function depthMapping(camera: Camera, mapping: DepthConvention['mapping']): DepthMapping {
  const { projectionMatrix: p, near, far } = camera;
  const isOrthographic = p[11] === 0;
  if (mapping === 'logarithmic') {
    if (isOrthographic) return { slope: [0, 0], offset: -near / (far - near), factor: 1 / (far - near) };
    const octaves = Math.log2(far / near);
    return { slope: [0, 0], offset: -Math.log2(near) / octaves, factor: 1 / octaves };
  }
  // Clip z is p2·x + p6·y − p10·d + p14; clip w is −p11·d, or p15; x is (w·ndc x + p8·d)/p0, or
  // (w·ndc x − p12)/p0.
  const slope = [p[2] / p[0], p[6] / p[5]] as const;
  const [level, shiftX, shiftY, factor] = isOrthographic
    ? [p[14] / p[15], p[12] / p[15], p[13] / p[15], -p[10] / p[15]]
    : [p[10] / p[11], p[8] / p[11], p[9] / p[11], -p[14] / p[11]];
  return { offset: level - slope[0] * shiftX - slope[1] * shiftY, factor, slope };
}

/** Returns a point's depth as the host's depth buffer would hold it; outside of 0…1 if clipped. */
export function storedDepth(
  depthView: number,
  camera: Camera,
  mapping: DepthConvention['mapping'],
  ndc: readonly [number, number] = [0, 0],
): number {
  const { offset, factor, slope } = depthMapping(camera, mapping);
  const isOrthographic = camera.projectionMatrix[11] === 0;
  const f = isOrthographic ? depthView : mapping === 'projection' ? 1 / depthView : Math.log2(depthView);
  const stored = offset + factor * f + slope[0] * ndc[0] + slope[1] * ndc[1];
  const clamped = Math.min(1, Math.max(0, stored));
  return Math.abs(stored - clamped) < ROUNDING ? clamped : stored;
}
