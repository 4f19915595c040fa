import { perspectiveCamera, type SplatSet } from '@websplatter/core';
import { colorDcOf } from '@websplatter/core/own-data';
import fc from 'fast-check';
import { describe, expect, it } from 'vitest';
import type { DragRegion } from '../state/selecting.ts';
import type { Vec3 } from '../state/vec3.ts';
import type { Region } from './inspect-messages.ts';
import { rowsWithin } from './rows-within.ts';
import { histogramsOf } from './scene-answers.ts';

/** Splats at x, y in the plane z = 0 or at depths of their own, in rows 30, 31, 32 … of a file. */
function setOf(positions: readonly (readonly [number, number, number])[]): SplatSet {
  const count = positions.length;
  return {
    count,
    origin: [0, 0, 0],
    positions: Float32Array.from(positions.flat()),
    logScales: Float32Array.from({ length: 3 * count }, (_, i) => Math.floor(i / 3)),
    rotations: new Float32Array(4 * count),
    opacityLogits: new Float32Array(count),
    colorDc: new Float32Array(3 * count),
    harmonics: { degree: 0, coefficients: new Float32Array() },
    fileIndices: Uint32Array.from({ length: count }, (_, i) => i + 30),
    dropped: {},
  };
}

const MOVED = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -6, 0, 1];
const plane = setOf([
  [0, 0, 0],
  [4, 0, 0],
  [0, 3, 0],
  // Behind the first, and behind the camera.
  [0, 0, -20],
  [0, 0, 20],
]);
const clouds = [
  { set: plane, modelMatrix: null },
  { set: setOf([[0, 3, 0]]), modelMatrix: MOVED },
];
// A unit is 10 px at z = 0.
const camera = perspectiveCamera({
  position: [0, 0, 10],
  target: [0, 0, 0],
  aspect: 1.5,
  fovYDegrees: 90,
  near: 1,
});
const look = {
  viewMatrix: Array.from(camera.viewMatrix),
  projectionMatrix: Array.from(camera.projectionMatrix),
  isFlipped: false,
};
const size = { width: 300, height: 200 };

const UNIT = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];
/** Of 16 by 16 pixels, a unit each. */
const PARALLEL = [1 / 8, 0, 0, 0, 0, 1 / 8, 0, 0, 0, 0, -1 / 8, 0, 0, 0, 0, 1];

/** Brute force: on one of the lines, or surrounded an odd number of times, by the angles seen. */
function isInPolygon(corners: readonly (readonly [number, number])[], x: number, y: number): boolean {
  let turned = 0;
  for (const [i, [ax, ay]] of corners.entries()) {
    const [bx, by] = corners[(i + 1) % corners.length];
    const [fromA, fromB, side] = [
      Math.hypot(ax - x, ay - y),
      Math.hypot(bx - x, by - y),
      Math.hypot(bx - ax, by - ay),
    ];
    // Of lines between whole numbers, others are further than that.
    if (fromA + fromB - side < 1e-9) return true;
    const angle = Math.atan2(by - y, bx - x) - Math.atan2(ay - y, ax - x);
    turned += Math.atan2(Math.sin(angle), Math.cos(angle));
  }
  return Math.abs(Math.round(turned / (2 * Math.PI))) % 2 === 1;
}

const rowsIn = (words: Uint32Array) =>
  Array.from({ length: 32 * words.length }, (_, row) => row).filter(
    (row) => (words[row >>> 5] >>> (row & 31)) & 1,
  );
const within = (region: Region, crop: Parameters<typeof rowsWithin>[2] = null) =>
  rowsWithin(clouds, region, crop, () => histogramsOf(clouds)).map(rowsIn);
const dragged = (region: DragRegion, isFlipped = false) =>
  within({ kind: 'dragged', dragged: region, ...size, look: { ...look, isFlipped } });

describe('the rows of a region', () => {
  it('are those of a rectangle, whichever way it was drawn, however deep', () => {
    const [from, to] = [
      [140, 90],
      [160, 110],
    ] as const;
    expect(dragged({ kind: 'rectangle', from, to })).toEqual([[30, 33], []]);
    expect(dragged({ kind: 'rectangle', from: to, to: from })).toEqual([[30, 33], []]);
    expect(dragged({ kind: 'rectangle', from: [185, 95], to: [195, 105] })).toEqual([[31], []]);
    // Below the middle is the splat of the other cloud, where it stands.
    expect(dragged({ kind: 'rectangle', from: [140, 120], to: [160, 140] })).toEqual([[], [30]]);
    expect(dragged({ kind: 'rectangle', from: [140, 120], to: [160, 140] }, true)).toEqual([[32], []]);
    expect(dragged({ kind: 'rectangle', from: [0, 0], to: [20, 20] })).toEqual([[], []]);
  });

  it('are those that the brush has touched', () => {
    expect(dragged({ kind: 'brush', points: [190, 100], radius: 4 })).toEqual([[31], []]);
    expect(dragged({ kind: 'brush', points: [100, 70, 200, 70], radius: 4 })).toEqual([[32], []]);
    expect(dragged({ kind: 'brush', points: [100, 80, 200, 80], radius: 4 })).toEqual([[], []]);
    // It may go beyond the image.
    expect(dragged({ kind: 'brush', points: [-50, 100, 400, 100], radius: 40 })).toEqual([
      [30, 31, 32, 33],
      [30],
    ]);
  });

  it('are those in a polygon and on its line, without what the line goes around twice', () => {
    const places = fc.tuple(fc.integer({ min: 0, max: 9 }), fc.integer({ min: 0, max: 9 }));
    fc.assert(
      fc.property(fc.array(places, { minLength: 3, maxLength: 7 }), (corners) => {
        // A unit of the plane is a pixel of the image, whose middle is at 8, 8.
        const grid = Array.from({ length: 100 }, (_, i) => [i % 10, Math.floor(i / 10)] as const);
        const set = setOf(grid.map(([x, y]) => [x - 8, 8 - y, 0] as const));
        const look = { viewMatrix: UNIT, projectionMatrix: PARALLEL, isFlipped: false };
        const dragged = { kind: 'polygon', points: corners.flat() } as const;
        const region = { kind: 'dragged', dragged, width: 16, height: 16, look } as const;
        const [found] = rowsWithin([{ set, modelMatrix: null }], region, null, () => histogramsOf([]));
        const expected = grid.flatMap(([x, y], i) => (isInPolygon(corners, x, y) ? [i + 30] : []));
        expect(rowsIn(found)).toEqual(expected);
      }),
    );
  });

  it('are those in a sphere and on it, where their clouds stand', () => {
    const sphere = (center: Vec3, radius: number) => within({ kind: 'sphere', center, radius });
    expect(sphere([0, 0, 0], 3)).toEqual([[30, 32], [30]]);
    expect(sphere([0, 0, 0], 2.999999999)).toEqual([[30], []]);
    expect(sphere([0, -6, 0], 3)).toEqual([[], [30]]);
    expect(sphere([4, 3, 0], 5)).toEqual([[30, 31, 32], []]);
    expect(sphere([0, 0, 20], 0)).toEqual([[34], []]);
  });

  it('are those whose base colour differs by no more than the tolerance in any channel', () => {
    const channels = fc.integer({ min: -40, max: 300 });
    const colors = fc.array(fc.tuple(channels, channels, channels), { minLength: 1 });
    fc.assert(
      fc.property(colors, fc.nat({ max: 255 }), (found, tolerance) => {
        const set = setOf(found.map(() => [0, 0, 0]));
        set.colorDc.set(found.flat().map((channel) => colorDcOf(channel / 255)));
        // Screens show no other colours.
        const shown = found.map((color) => color.map((channel) => Math.min(255, Math.max(0, channel))));
        const color = shown[0] as unknown as Vec3;
        const region = { kind: 'color', color, tolerance } as const;
        const [words] = rowsWithin([{ set, modelMatrix: null }], region, null, () => histogramsOf([]));
        const expected = shown.flatMap((each, i) =>
          Math.max(...each.map((channel, k) => Math.abs(channel - color[k]))) <= tolerance ? [i + 30] : [],
        );
        expect(rowsIn(words)).toEqual(expected);
      }),
    );
  });

  it('are all, or those of a bin, but for what a crop leaves out', () => {
    expect(within({ kind: 'all' })).toEqual([[30, 31, 32, 33, 34], [30]]);
    const crop = { min: [-1, -9, -1], max: [5, 9, 1] } as const;
    expect(within({ kind: 'all' }, { ...crop, keep: 'inside' })).toEqual([[30, 31, 32], [30]]);
    expect(within({ kind: 'all' }, { ...crop, keep: 'outside' })).toEqual([[33, 34], []]);
    const { counts } = histogramsOf(clouds).longest;
    const marked = { quantity: 'longest', bin: counts.length - 1 } as const;
    expect(within({ kind: 'bin', marked })).toEqual([[34], []]);
    expect(within({ kind: 'bin', marked: { ...marked, bin: 0 } })).toEqual([[30], [30]]);
  });
});
