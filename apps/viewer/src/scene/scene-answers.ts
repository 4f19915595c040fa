import { type Bounds, type Harmonics, readCoefficients, type SplatSet } from '@websplatter/core';
import { flippedPoint } from '../camera/flip.ts';
import { transformedPoint } from '../camera/scene-bounds.ts';
import type { Histogram, Histograms, Quantity } from '../state/inspecting.ts';
import type { Vec3 } from '../state/vec3.ts';
import { baseColorOf } from './base-color.ts';
import { binOf, opacityEdges, scaleEdges } from './histogram.ts';
import type { SceneLook } from './inspect-messages.ts';

/** A cloud of the scene with the values of its file. */
export interface ReadCloud {
  readonly set: SplatSet<Harmonics>;
  /** Cloud to scene, column-major; null for the identity. */
  readonly modelMatrix: readonly number[] | null;
}

/** Harmonics up to degree 3 without the base: 15 coefficients for each of three channels. */
const MOST_COEFFICIENTS = 45;

/**
 * A splat set with only the splat in `row` of its file, with harmonics as trained; null if the row
 * has none.
 */
export function splatInRow({ set }: ReadCloud, row: number): SplatSet | null {
  // Mostly no row was dropped or moved.
  const index = set.fileIndices[row] === row ? row : set.fileIndices.indexOf(row);
  if (index < 0) return null;
  const { degree } = set.harmonics;
  const rest = new Float32Array(MOST_COEFFICIENTS);
  readCoefficients(set.harmonics, index, rest);
  const width = 3 * ((degree + 1) ** 2 - 1);
  const of = (column: Float32Array, length: number) => column.slice(length * index, length * (index + 1));
  return {
    count: 1,
    origin: set.origin,
    positions: of(set.positions, 3),
    logScales: of(set.logScales, 3),
    rotations: of(set.rotations, 4),
    opacityLogits: of(set.opacityLogits, 1),
    colorDc: of(set.colorDc, 3),
    harmonics: { degree, coefficients: rest.slice(0, width) },
    fileIndices: Uint32Array.of(row),
    dropped: {},
  };
}

/** A splat's quantities: standard deviations along its longest and shortest axis; opacity. */
export const VALUES: Readonly<Record<Quantity, (set: SplatSet<Harmonics>, index: number) => number>> = {
  longest: ({ logScales }, i) =>
    Math.exp(Math.max(logScales[3 * i], logScales[3 * i + 1], logScales[3 * i + 2])),
  shortest: ({ logScales }, i) =>
    Math.exp(Math.min(logScales[3 * i], logScales[3 * i + 1], logScales[3 * i + 2])),
  opacity: ({ opacityLogits }, i) => 1 / (1 + Math.exp(-opacityLogits[i])),
};

export function histogramsOf(clouds: readonly ReadCloud[]): Histograms {
  return {
    longest: scaleHistogram(clouds, 'longest'),
    shortest: scaleHistogram(clouds, 'shortest'),
    opacity: counted(clouds, 'opacity', { edges: opacityEdges(), isByRatio: false }),
  };
}

function scaleHistogram(clouds: readonly ReadCloud[], quantity: Quantity): Histogram {
  let [least, most] = [Number.POSITIVE_INFINITY, 0];
  eachValue(clouds, quantity, (value) => {
    least = Math.min(least, value);
    most = Math.max(most, value);
  });
  return counted(clouds, quantity, { edges: scaleEdges(least, most), isByRatio: true });
}

function counted(
  clouds: readonly ReadCloud[],
  quantity: Quantity,
  bins: Pick<Histogram, 'edges' | 'isByRatio'>,
): Histogram {
  const counts = Array<number>(bins.edges.length - 1).fill(0);
  eachValue(clouds, quantity, (value) => {
    counts[binOf(value, bins)]++;
  });
  return { ...bins, counts };
}

function eachValue(clouds: readonly ReadCloud[], quantity: Quantity, take: (value: number) => void): void {
  for (const { set } of clouds) for (let i = 0; i < set.count; i++) take(VALUES[quantity](set, i));
}

/** Colours of marks, sRGB, 0…1, the preferred one first: bright, saturated, of distant hues. */
const MARK_COLORS: readonly Vec3[] = [
  [1, 0.1, 0.85],
  [0, 0.9, 1],
  [0.3, 1, 0.1],
  [1, 0.36, 0.05],
];
/** Share of the scene's opacity up to which a hue counts as absent. */
const ABSENT = 0.01;

/** A colour for marks whose hue is absent from the scene, or rarest in it. */
export function markColor(clouds: readonly ReadCloud[]): Vec3 {
  const hues = MARK_COLORS.map(hueOf);
  const amounts = MARK_COLORS.map(() => 0);
  let total = 0;
  for (const { set } of clouds) {
    for (let i = 0; i < set.count; i++) {
      const color = baseColorOf(set, i);
      const opacity = VALUES.opacity(set, i);
      const amount = (opacity * (Math.max(...color) - Math.min(...color))) / 255;
      const hue = hueOf(color);
      total += opacity;
      for (const [m, each] of hues.entries())
        if (Math.abs(((hue - each + 9) % 6) - 3) < 1) amounts[m] += amount;
    }
  }
  const absent = amounts.findIndex((amount) => amount <= ABSENT * total);
  return MARK_COLORS[absent >= 0 ? absent : amounts.indexOf(Math.min(...amounts))];
}

/** Hue in sixths of a turn: 0 is red, 2 green, 4 blue; 0 for greys. */
function hueOf([r, g, b]: Vec3): number {
  const most = Math.max(r, g, b);
  const chroma = most - Math.min(r, g, b);
  if (chroma === 0) return 0;
  if (most === r) return ((g - b) / chroma + 6) % 6;
  return most === g ? (b - r) / chroma + 2 : (r - g) / chroma + 4;
}

/** Bounding box of all centres in the image, in the scene's own space; null if there are none. */
export function boundsInImage(clouds: readonly ReadCloud[], look: SceneLook): Bounds | null {
  const min: [number, number, number] = [Infinity, Infinity, Infinity];
  const max: [number, number, number] = [-Infinity, -Infinity, -Infinity];
  eachCenter(clouds, (center) => {
    if (imagePlace(look, center) === null) return;
    for (const axis of [0, 1, 2]) {
      min[axis] = Math.min(min[axis], center[axis]);
      max[axis] = Math.max(max[axis], center[axis]);
    }
  });
  return min[0] <= max[0] ? { min, max } : null;
}

/** Image position of a point of the scene: right and up, −1…1; null outside of the image. */
export function imagePlace(
  { viewMatrix, projectionMatrix: p, isFlipped }: SceneLook,
  point: Vec3,
): readonly [right: number, up: number] | null {
  const [x, y, z] = transformedPoint(viewMatrix, isFlipped ? flippedPoint(point) : point);
  const w = p[11] * z + p[15];
  const right = p[0] * x + p[8] * z + p[12];
  const up = p[5] * y + p[9] * z + p[13];
  return w > 0 && Math.abs(right) <= w && Math.abs(up) <= w ? [right / w, up / w] : null;
}

/** Centres of at most `most` splats of the masks' rows, evenly chosen. */
export function sampledCenters(
  clouds: readonly ReadCloud[],
  rows: readonly (Uint32Array | null)[],
  most: number,
): readonly Vec3[] {
  const chosen: Vec3[] = [];
  for (const [i, cloud] of clouds.entries()) {
    const { fileIndices } = cloud.set;
    const words = rows[i];
    if (!words) continue;
    eachCenter([cloud], (center, index) => {
      const row = fileIndices[index];
      if ((words[row >>> 5] >>> (row & 31)) & 1) chosen.push(center);
    });
  }
  const step = Math.max(1, chosen.length / most);
  return Array.from({ length: Math.min(most, chosen.length) }, (_, i) => chosen[Math.floor(i * step)]);
}

/** Calls `take` with each splat's centre, in the scene's own space, and its index in its cloud. */
export function eachCenter(clouds: readonly ReadCloud[], take: (center: Vec3, index: number) => void): void {
  for (const { set, modelMatrix } of clouds) {
    const { positions, origin, count } = set;
    for (let i = 0; i < count; i++) {
      const center: Vec3 = [
        origin[0] + positions[3 * i],
        origin[1] + positions[3 * i + 1],
        origin[2] + positions[3 * i + 2],
      ];
      take(modelMatrix ? transformedPoint(modelMatrix, center) : center, i);
    }
  }
}
