import { describe, expect, test } from 'vitest';
import { internAccuracy } from '../data/accuracy/accuracy.ts';
import { frameStages } from '../frame/frame-passes.ts';
import type { FrameShape } from '../frame/plan/frame-shape.ts';
import { blockKeysOf, sortShapeFor } from '../stages/sort/sort.ts';
import { type CountedFrame, leastBytes } from './least-bytes.ts';

/** Labels of the passes of frames outside of other renderers. */
const PARTS = ['pre-process', 'sort', 'tile lists', 'tiles', 'rasterize', 'upscale', 'composite'];
const WORKGROUP_BYTES = 16_384;
const VISIBLE = 5000;
const PAIRS = 7000;

function shapeOf(rasterizer: 'tiles' | 'quads', output: FrameShape['output'], keyBits = 24): FrameShape {
  return {
    clouds: [],
    isOrthographic: false,
    sortsByDistance: false,
    isStacked: false,
    isBudgeted: false,
    accuracy: internAccuracy({ preset: 'balanced', rasterizer, resolutionScale: 0.5 }),
    dispatchRow: 65_535,
    sortDevice: { workgroupBytes: WORKGROUP_BYTES, isNarrow: false, ballots: null },
    visibleCapacity: VISIBLE,
    keyBits,
    shortensKeys: false,
    depth: null,
    isFaded: false,
    output,
    rasterizer,
    binCount: rasterizer === 'tiles' ? 4 : 0,
  };
}

function frameOf(shape: FrameShape): CountedFrame {
  const { rasterizer } = shape;
  const statistics = {
    candidateSplats: 6000,
    visibleSplats: VISIBLE,
    rasterizer,
    tilePairs: rasterizer === 'tiles' ? PAIRS : null,
  };
  return { shape, statistics, size: { widthPx: 200, heightPx: 100 }, pixelBytes: 8 };
}

const image = { kind: 'image' } as const;
const canvas = { kind: 'canvas', format: 'bgra8unorm', storable: null } as const;

describe('leastBytes', () => {
  test.each([
    ['tiles', 24],
    ['tiles', 56],
    ['quads', 24],
  ] as const)(
    'has a rule for every stage of frames drawn by %s with keys of %i bits',
    (rasterizer, keyBits) => {
      const shape = shapeOf(rasterizer, canvas, keyBits);
      const bytesOf = leastBytes(frameOf(shape));
      const stages = frameStages(shape).map((each) => ('stage' in each ? each : each[0]).stage);
      expect(stages).toContain('composite');
      for (const stage of stages) {
        const found = PARTS.map((part) => bytesOf(part, stage)).filter((bytes) => bytes !== null);
        expect(found.length, stage).toBeGreaterThan(0);
        for (const { read, written } of found) {
          expect(read, stage).toBeGreaterThanOrEqual(0);
          expect(written, stage).toBeGreaterThanOrEqual(0);
        }
      }
    },
  );

  test('has none for passes inside of another renderer, or that do not exist', () => {
    const bytesOf = leastBytes(frameOf(shapeOf('tiles', image)));
    expect(bytesOf('compose', 'compose')).toBeNull();
    expect(bytesOf('sort', 'project')).toBeNull();
  });

  test('counts each pass of a sort', () => {
    const bytesOf = leastBytes(frameOf(shapeOf('tiles', image)));
    const shape = sortShapeFor(24, { workgroupBytes: WORKGROUP_BYTES });
    expect([shape.passes, shape.digitBits]).toEqual([3, 8]);
    const digitCounts = 4 * 256 * Math.ceil(VISIBLE / blockKeysOf(shape));
    expect(bytesOf('sort', 'sort-histogram')).toEqual({ read: 3 * 4 * VISIBLE, written: 3 * digitCounts });
    expect(bytesOf('sort', 'sort-scan')).toEqual({ read: 3 * digitCounts, written: 3 * digitCounts });
    // The first pass makes its payloads, the last writes no keys.
    const scattered = { read: (3 + 2) * 4 * VISIBLE + 3 * digitCounts, written: (3 + 2) * 4 * VISIBLE };
    expect(bytesOf('sort', 'sort-scatter')).toEqual(scattered);
    const wide = leastBytes(frameOf(shapeOf('tiles', image, 56)));
    // Seven passes, of which the last over each word writes no keys.
    expect(wide('sort', 'sort-scatter')).toEqual({
      read: (7 + 6) * 4 * VISIBLE + 7 * digitCounts,
      written: (7 + 5) * 4 * VISIBLE,
    });
    expect(wide('sort', 'sort-gather')).toEqual({ read: 2 * 4 * VISIBLE, written: 4 * VISIBLE });
    // One pass by bin: digits are counted while pairs are listed; payloads are given, keys written.
    expect(bytesOf('tile lists', 'sort-histogram')).toEqual({ read: 0, written: 0 });
    expect(bytesOf('tile lists', 'sort-scatter')).toMatchObject({ written: 2 * 4 * PAIRS });
  });

  test('counts the pixels of the layer and of the image', () => {
    const bytesOf = leastBytes(frameOf(shapeOf('quads', canvas)));
    expect(bytesOf('rasterize', 'rasterize')!.written).toBe(8 * 100 * 50);
    // Draws quads of a few splats, outside of the layer.
    expect(bytesOf('quads sample', 'rasterize')).toEqual({ read: 0, written: 0 });
    expect(bytesOf('upscale', 'upscale')).toEqual({ read: 8 * 100 * 50, written: 8 * 200 * 100 });
    expect(bytesOf('composite', 'composite')).toEqual({ read: 8 * 200 * 100, written: 4 * 200 * 100 });
  });

  test('counts no pairs where tiles had no room, and the quads instead', () => {
    const frame = frameOf(shapeOf('tiles', image));
    const fallback = { ...frame, statistics: { ...frame.statistics, rasterizer: 'quads' as const } };
    const [tiles, quads] = [leastBytes(frame), leastBytes(fallback)];
    expect(tiles('rasterize', 'rasterize')).toEqual({ read: 0, written: 0 });
    expect(quads('tile lists', 'tile-masks')).toEqual({ read: 0, written: 0 });
    expect(quads('rasterize', 'rasterize')!.read).toBe((4 + 32) * VISIBLE);
    expect(tiles('tiles', 'tile-rasterize')!.read).toBe((8 + 4) * PAIRS + 32 * VISIBLE);
  });
});

test('an entry of a palette counts once, and two bytes for each visible splat', () => {
  const splatCount = 8000;
  const entries = 30;
  const page = { splatCount, shRest: { size: 4 * (45 * entries + splatCount / 2) } };
  const cloudOf = (shPrecision: string) => ({
    cloud: { count: splatCount, shDegree: 3 },
    planes: { geometryPrecision: 'packed', shPrecision, pages: [page] },
    shDegree: 3,
  });
  const readOf = (shPrecision: string) => {
    const clouds = [cloudOf(shPrecision)] as unknown as FrameShape['clouds'];
    return leastBytes(frameOf({ ...shapeOf('quads', image), clouds }))('pre-process', 'project')!.read;
  };
  expect(readOf('u8') - readOf('palette')).toBe(48 * VISIBLE - (2 * VISIBLE + 180 * entries));
});
