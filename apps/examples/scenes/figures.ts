import { encodePly, type SplatSet } from '@websplatter/core';
import { GOLDEN_RATIO, splatsOf, wheel } from './splats.ts';

/** Profile of a figure from foot to crown: radius by height, like a chess piece. */
const PROFILE = [
  [0, 0.1],
  [0.03, 0.105],
  [0.05, 0.075],
  [0.1, 0.05],
  [0.2, 0.033],
  [0.235, 0.06],
  [0.25, 0.035],
  [0.28, 0.06],
  [0.32, 0.07],
  [0.36, 0.055],
  [0.385, 0.01],
] as const;
const HEIGHT = 0.385;

/** A figure of few splats, about 0.4 high; white, so that instances can tint it. */
export const figurePly = (): Uint8Array => encodePly(figures(180, [{ place: [0, 0, 0], color: [1, 1, 1] }]));

/** Seven figures in an arc, each in its own colour. */
export function figuresPly(): Uint8Array {
  const row = Array.from({ length: 7 }, (_, i) => {
    const angle = (i / 6 - 0.5) * 2.2;
    const place = [0.62 * Math.sin(angle), -0.16, 0.75 - 0.62 * Math.cos(angle)];
    return { place, color: wheel(i / 7, 0.55, 0.38) };
  });
  return encodePly(figures(2_600, row));
}

interface Figure {
  readonly place: readonly number[];
  readonly color: readonly number[];
}

function figures(each: number, row: readonly Figure[]): SplatSet {
  const size = 0.55 / Math.sqrt(each);
  return splatsOf(each * row.length, (i) => {
    const { place, color } = row[Math.floor(i / each)];
    const height = (((i % each) + 0.5) / each) * HEIGHT;
    const angle = 2 * Math.PI * ((i * GOLDEN_RATIO) % 1);
    const radius = radiusAt(height);
    const slope = (radiusAt(height + 0.004) - radiusAt(height - 0.004)) / 0.008;
    const axis = [Math.cos(angle), -slope, Math.sin(angle)];
    const facing = (0.5 * axis[0] + 0.6 * axis[1] + 0.6 * axis[2]) / Math.hypot(...axis);
    const light = 0.72 + 0.36 * facing;
    return {
      position: [place[0] + radius * axis[0], place[1] + height, place[2] + radius * axis[2]],
      scale: [size, 0.25 * size, size],
      axis,
      color: color.map((value) => value * light),
    };
  });
}

function radiusAt(height: number): number {
  const next = Math.max(
    1,
    PROFILE.findIndex(([each]) => each >= Math.min(Math.max(height, 0), HEIGHT)),
  );
  const [[lowAt, low], [highAt, high]] = [PROFILE[next - 1], PROFILE[next]];
  const share = Math.min(1, Math.max(0, (height - lowAt) / (highAt - lowAt)));
  return low + (high - low) * share;
}
