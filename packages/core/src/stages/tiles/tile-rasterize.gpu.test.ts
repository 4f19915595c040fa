// Proves: every pixel as the reference's: records, targets, the depth of hosts.
import { gpuTest } from '@websplatter/node/gpu-test';
import { describe, expect } from 'vitest';
import {
  type Camera,
  cameraFromMatrices,
  orthographicCamera,
  perspectiveCamera,
} from '../../data/camera/camera.ts';
import { type DepthConvention, depthMapping } from '../../data/camera/depth-convention.ts';
import { SHADER_CONSTANTS } from '../../data/layout/constants.ts';
import type { Pipelines } from '../../gpu/pipelines.ts';
import { type DrawnSplat, shuffled } from '../../testing/ranked-records.ts';
import { testGpu } from '../../testing/test-gpu.ts';
import { MERGED_OPACITIES, merged } from '../../testing/tile-buffers.ts';
import { always, checkTiles, type Scene, SIZE, splats, veil } from '../../testing/tile-pixels.ts';
import { withClipDepth } from '../../testing/with-clip-depth.ts';
import { TILE_THREADS } from './tiles.ts';

const { BIN_PX } = SHADER_CONSTANTS;

const isFull = process.env.WEBSPLATTER_FULL === '1';

const gpu = testGpu();
const check = (scene: Scene, drawing?: Pipelines) => checkTiles(gpu, scene, drawing);

describe('tile-rasterize', () => {
  const records = ['f32', 'f16', 'paper'] as const;
  const targets = ['rgba32float', 'rgba16float', 'rgba8unorm'] as const;
  for (const [i, recordPrecision] of records.entries()) {
    // The test of frames by tiles draws all pairs.
    for (const colorTarget of isFull ? targets : [targets[i]]) {
      gpuTest(
        `${recordPrecision} records in ${colorTarget}: every pixel as the reference`,
        { tags: 'deeper' },
        async () => {
          const { covered } = await check({ ranked: splats(150), recordPrecision, colorTarget });
          expect(covered).toBeGreaterThan(0.9 * SIZE.widthPx * SIZE.heightPx);
        },
      );
    }
  }

  // Masks and counts of merged splats are tested in every precision.
  for (const recordPrecision of isFull ? records : (['f32'] as const)) {
    gpuTest(
      `${recordPrecision} records of merged splats among others: every pixel as the reference`,
      { tags: 'deeper' },
      async () => {
        // Few enough that the tiles do not end.
        const sparse = { ranked: splats(24).map(merged), recordPrecision, isStacked: true };
        expect((await check(sparse)).covered).toBeGreaterThan(2000);
        await check({ ranked: splats(150).map(merged), recordPrecision, isStacked: true });
        const needles = MERGED_OPACITIES.map((opacity) =>
          veil(opacity, { minorLengthPx: 0.8, angle: opacity }),
        );
        await check({ ranked: needles, recordPrecision, isStacked: true });
      },
    );
  }

  for (const [i, recordPrecision] of records.entries()) {
    const name = `${recordPrecision} records of needles at any angle, with centres near and far`;
    gpuTest(name, { tags: 'deeper' }, async () => {
      // In the first tier, by the shaders of the test of every pixel.
      const colorTarget = isFull ? 'rgba32float' : targets[i];
      const angles = [0, 0.001, 0.3, Math.PI / 4, Math.PI / 2, 2.2, Math.PI];
      const ranked = angles.flatMap((angle, i) =>
        [0, 1e4].map((distancePx) =>
          veil(0.4, {
            angle,
            majorLengthPx: 3e4,
            minorLengthPx: 0.8,
            centerPx: [20 + 4 * i + distancePx * Math.cos(angle), 30 + distancePx * Math.sin(angle)],
          }),
        ),
      );
      const needles = { ranked, recordPrecision, colorTarget, isListed: always, isMasked: always };
      const { covered } = await check(needles);
      expect(covered).toBeGreaterThan(500);
    });
  }

  gpuTest('layers of any size, down to a pixel', async () => {
    for (const [widthPx, heightPx] of [
      [1, 1],
      [64, 64],
      [65, 3],
      [9, 130],
      [8, 8],
    ]) {
      const size = { widthPx, heightPx };
      const { covered } = await check({ ranked: splats(60, size), size });
      expect(covered).toBeGreaterThan(0);
    }
  });

  gpuTest('more pairs per bin than one window of masks', async () => {
    expect(2500).toBeGreaterThan(2 * 32 * TILE_THREADS);
    // Two bins, the second of which begins inside a word. Their pixels decide what the reference takes.
    const size = { widthPx: 20, heightPx: 70 };
    const { covered, ended } = await check({ ranked: splats(2500, size, 0.03), size, isListed: always });
    expect(covered).toBeGreaterThan(1000);
    expect(ended).toBe(0);
    // Long runs of empty words, and single bits at the ends of words.
    const isMasked = (pair: number, tile: number) => pair % 512 === tile || (pair * tile) % 1031 === 31;
    await check({ ranked: splats(2400, size, 0.3), size, isListed: always, isMasked });
  });

  gpuTest('bins without pairs, and tiles without any', async () => {
    const ranked = splats(50);
    const onlyThird = await check({ ranked, isListed: (bin) => bin === 2 });
    expect(onlyThird.covered).toBeGreaterThan(0);
    for (let pixel = 0; pixel < BIN_PX; pixel++) expect(onlyThird.data[4 * pixel + 3]).toBe(0);
    const nothing = await check({ ranked, isMasked: () => false });
    expect(nothing.data.every((value) => value === 0)).toBe(true);
  });

  gpuTest('larger bins over layers of any size', async () => {
    for (const [widthPx, heightPx, binShift] of [
      [75, 69, 1],
      [75, 69, 3],
      [1, 1, 1],
      // Of several columns and rows of larger bins, so that their row stride counts.
      [65, 129, 1],
      [140, 75, 1],
      [9, 330, 2],
      [512, 8, 3],
    ]) {
      const size = { widthPx, heightPx };
      expect((await check({ ranked: splats(90, size), size, binShift })).covered).toBeGreaterThan(0);
    }
  });

  gpuTest('bins that begin at every place of a word', { tags: 'deeper' }, async () => {
    // Two bins of few pixels: the second begins behind the first.
    const size = { widthPx: 75, heightPx: 9 };
    const ranked = splats(70, size);
    for (let length = 1; length < 33; length += isFull ? 1 : 3) {
      const isListed = (bin: number, rank: number) => (bin === 0 ? rank < length : rank % 2 === bin % 2);
      expect((await check({ ranked, size, isListed })).covered).toBeGreaterThan(0);
    }
  });

  gpuTest('a tile ends when less than 2⁻¹⁶ of the light behind passes through, and not before', async () => {
    // 16,000 times as bright as white, so that it shows through less than that.
    const bright = veil(0.99, { rgb: [16_384, 16_384, 16_384] });
    const brightAt = async (front: readonly DrawnSplat[]) => {
      const faint = Array<DrawnSplat>(TILE_THREADS - front.length).fill(veil(0.001));
      const ranked = [...front, ...faint, bright];
      const { data, ended } = await check({ ranked, isListed: always, isMasked: always });
      return { red: data[0], ended };
    };
    // 10⁻⁴ · 0.2 = 2⁻¹⁵·⁶, and 10⁻⁴ · 0.1 = 2⁻¹⁶·⁶.
    const open = await brightAt([veil(1), veil(1), veil(0.8)]);
    expect(open.red).toBeCloseTo(1 + 2e-5 * 0.99 * 16_384, 2);
    expect(open.ended).toBe(0);
    const closed = await brightAt([veil(1), veil(1), veil(0.9)]);
    expect(closed.red).toBeCloseTo(1, 3);
    expect(closed.ended).toBe(SIZE.widthPx * SIZE.heightPx);
  });

  gpuTest('a tile with one open pixel does not end', async () => {
    // All pixels but those around the corner of the first tile are opaque.
    const disc = { majorLengthPx: 6, minorLengthPx: 6, centerPx: [7.5, 7.5] } as const;
    const ranked = [
      ...Array<DrawnSplat>(2 * TILE_THREADS).fill(veil(1, disc)),
      ...splats(100).map((splat) => ({ ...splat, opacity: 0.9 })),
    ];
    const { covered } = await check({ ranked, isListed: always, isMasked: always });
    expect(covered).toBe(SIZE.widthPx * SIZE.heightPx);
  });

  gpuTest('full opacity is capped, and opacities below the cutoff draw nothing', async () => {
    const capped = await check({ ranked: [veil(1)], isListed: always, isMasked: always });
    expect(capped.data[3]).toBeCloseTo(0.99, 6);
    const faint = await check({ ranked: [veil(0.0039)], isListed: always, isMasked: always });
    expect(faint.covered).toBe(0);
    expect(faint.data.every((value) => value === 0)).toBe(true);
  });
});

const place = { position: [0, 0, 4], target: [0, 0, 0], aspect: 75 / 69, near: 0.5, far: 40 } as const;
const perspective = withClipDepth(perspectiveCamera({ ...place, fovYDegrees: 50 }), false);
const orthographic = withClipDepth(orthographicCamera({ ...place, height: 3 }), false);
const tilted = (camera: Camera): Camera => {
  const matrix = Float64Array.from(camera.projectionMatrix);
  matrix[2] = 0.02;
  matrix[6] = -0.03;
  return cameraFromMatrices(camera.viewMatrix, matrix, camera);
};
const CONVENTIONS: Readonly<
  Record<string, readonly [Camera, DepthConvention['mapping'], DepthConvention['compare']]>
> = {
  'depth as projected': [perspective, 'projection', 'less-equal'],
  'reversed depth': [withClipDepth(perspective, true), 'projection', 'greater-equal'],
  'a tilted near plane': [tilted(perspective), 'projection', 'less-equal'],
  'a tilted near plane, reversed': [tilted(withClipDepth(perspective, true)), 'projection', 'greater-equal'],
  'depth of parallel rays': [orthographic, 'projection', 'less-equal'],
  'reversed depth of parallel rays': [withClipDepth(orthographic, true), 'projection', 'greater-equal'],
  'logarithmic depth': [perspective, 'logarithmic', 'less-equal'],
  'logarithmic depth of parallel rays': [orthographic, 'logarithmic', 'less-equal'],
};

/** Surfaces of the host between the depths of `splats`, in stripes; nothing in between. */
const surfaceView = (x: number, y: number) =>
  [1.7, 3.1, Number.POSITIVE_INFINITY, 22, 0.6][(Math.floor(x / 5) + Math.floor(y / 9)) % 5];

describe('tile-rasterize with the depth of a host', () => {
  /** Of each projection, mapping and comparison one, and the near planes that are tilted. */
  const some = [
    'depth as projected',
    'a tilted near plane',
    'a tilted near plane, reversed',
    'reversed depth of parallel rays',
    'logarithmic depth',
  ];
  const conventions = Object.entries(CONVENTIONS).filter(([name]) => isFull || some.includes(name));
  for (const [index, [name, [camera, mapping, compare]]] of conventions.entries()) {
    gpuTest(`${name}: hides splats, and writes the median of their depth`, { tags: 'deeper' }, async () => {
      const host = { camera, mapping, compare, surfaceView, isExactOrder: true };
      const scene = { ranked: splats(200, SIZE, 0.4) };
      const { covered, hidden, medians } = await check({ ...scene, host: { ...host, hasDepthLayer: true } });
      expect(covered).toBeGreaterThan(2000);
      expect(medians).toBeGreaterThan(1000);
      expect(hidden).toBeGreaterThan(2000);
      // The host's depth means the same whether a depth is written or not.
      if (isFull || index === 0) await check({ ...scene, host: { ...host, hasDepthLayer: false } });
    });

    gpuTest(`${name}: splats that short keys leave unordered`, { tags: 'deeper' }, async ({ skip }) => {
      // The order of splats does not change the meaning of the host's depth.
      if (!isFull && index > 0) skip('set WEBSPLATTER_FULL=1');
      const inOrder = splats(200, SIZE, 0.4);
      const ranked = Array.from(shuffled(inOrder.length), (rank) => inOrder[rank]);
      const host = { camera, mapping, compare, surfaceView, isExactOrder: false, hasDepthLayer: true };
      const { hidden } = await check({ ranked, host });
      expect(hidden).toBeGreaterThan(2000);
    });
  }

  gpuTest('a depth that rounding alone puts outside of 0…1 is not clipped', async () => {
    const host = { camera: perspective, mapping: 'projection', compare: 'less-equal' } as const;
    const nowhere = { surfaceView: () => Number.POSITIVE_INFINITY, isExactOrder: true, hasDepthLayer: true };
    for (const depthView of [0.5 * (1 - 2e-6), 40 * (1 + 1e-4)]) {
      const stored = depthMapping(perspective, 'projection');
      const depth = stored.offset + stored.factor / depthView;
      expect(depth < 0 || depth > 1).toBe(true);
      const ranked = [veil(0.7, { depthView })];
      const { covered } = await check({
        ranked,
        host: { ...host, ...nowhere },
        isMasked: always,
        isListed: always,
      });
      expect(covered).toBe(SIZE.widthPx * SIZE.heightPx);
    }
  });
});
