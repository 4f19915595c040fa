import type { Camera } from '../camera.ts';

/** How the renderer around the splats stores depth. */
export interface DepthConvention {
  /** `greater-equal` where depth is reversed: 1 at the near plane. */
  readonly compare: 'less-equal' | 'greater-equal';
  /**
   * `projection`: as the camera's projection matrix says, from 0 to 1; `logarithmic`: log2(depth/near)/log2(far/near)
   * for perspective cameras, linear between near and far for orthographic ones.
   */
  readonly mapping: 'projection' | 'logarithmic';
}

/** Stored depth of a point at view depth d: offset + factor·f(d), f being 1/d, d or log2 d. */
export interface DepthMapping {
  readonly offset: number;
  readonly factor: number;
}

/**
 * Perspective projections map 1/d, orthographic ones d, logarithmic depth (of perspective cameras alone) log2 d.
 *
 * @returns the two numbers in float64.
 */
export function depthMapping(camera: Camera, mapping: DepthConvention['mapping']): DepthMapping {
  const { projectionMatrix: p, near, far } = camera;
  const isOrthographic = p[11] === 0;
  if (mapping === 'projection') {
    // Clip z is −p10·d + p14; clip w is d, or p15.
    return isOrthographic
      ? { offset: p[14] / p[15], factor: -p[10] / p[15] }
      : { offset: p[10] / p[11], factor: -p[14] / p[11] };
  }
  if (isOrthographic) return { offset: -near / (far - near), factor: 1 / (far - near) };
  const octaves = Math.log2(far / near);
  return { offset: -Math.log2(near) / octaves, factor: 1 / octaves };
}

/** The same for one depth, as the host's depth buffer would hold it. */
export function storedDepth(depthView: number, camera: Camera, mapping: DepthConvention['mapping']): number {
  const { offset, factor } = depthMapping(camera, mapping);
  const isOrthographic = camera.projectionMatrix[11] === 0;
  const f = isOrthographic ? depthView : mapping === 'projection' ? 1 / depthView : Math.log2(depthView);
  return Math.min(1, Math.max(0, offset + factor * f));
}
