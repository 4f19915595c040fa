import type { Vec3 } from '../math/mat4.ts';

/** Colour that a visible splat was drawn with. */
export interface DrawnColor {
  /** Number of the splat, counted through all chunks of the frame. */
  readonly splat: number;
  readonly color: Vec3;
}

/**
 * Twin of keep-colors: the colours of a page, splat by splat.
 *
 * @param drawn all visible splats of the frame.
 * @returns null for splats that were not drawn.
 */
export function keepColors(
  drawn: readonly DrawnColor[],
  firstSplat: number,
  splatCount: number,
): (Vec3 | null)[] {
  const colors = new Map(drawn.map(({ splat, color }) => [splat, color]));
  return Array.from({ length: splatCount }, (_, index) => colors.get(firstSplat + index) ?? null);
}
