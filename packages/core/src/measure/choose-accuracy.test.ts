import { describe, expect, test } from 'vitest';
import { internAccuracy } from '../data/accuracy/accuracy.ts';
import { InvalidArgumentError } from '../data/errors.ts';
import { singleCandidates } from './candidates.ts';
import { chooseFrom } from './choose-accuracy.ts';
import { combineChanges } from './combine-changes.ts';
import type { AccuracyPoint, AccuracyTable } from './measure-accuracy.ts';

type Row = readonly [name: 'high' | 'balanced' | 'fast', psnrDb: number, medianMs: number, spreadMs?: number];

function table(...rows: readonly Row[]): AccuracyTable {
  const points = rows.map(([name, psnrDb, median, spread = 0.1]): AccuracyPoint => {
    const total = { median, low: median - spread, high: median + spread, p99: median + spread };
    return {
      name,
      settings: internAccuracy(name),
      changed: [],
      detail: 'full',
      splats: 1,
      filteredPsnrDb: null,
      error: { psnrDb, maxError: 0, p999Error: 0, ssim: 1 },
      timeMs: { preprocess: null, sort: null, rasterize: null, total },
      rasterizers: ['quads'],
      isOnFront: true,
      bytes: 0,
      notes: [],
    };
  });
  const reference = { settings: internAccuracy('reference'), notes: [] };
  const size = { widthPx: 1, heightPx: 1, splats: 1, views: 1, frames: 1, elapsedMs: 0 };
  return {
    points,
    base: points[0].settings,
    detail: 'full',
    reference,
    notes: [],
    timing: 'gpu-timestamps',
    adapter: '',
    ...size,
  };
}

const ordinary = table(['high', 65, 9], ['balanced', 52, 6], ['fast', 40, 3]);

describe('chooseFrom', () => {
  test('chooses no point of less detail, which its settings would not draw', () => {
    const [high, balanced, fast] = ordinary.points;
    const points = [high, { ...balanced, detail: { maxSplats: 1 } }, fast];
    const choice = chooseFrom({ ...ordinary, points }, { minPsnrDb: 45 });
    expect(choice.point).toBe(high);
    expect(choice.why).toContain('Of 2 settings measured, “high” is the fastest');
  });

  test('chooses the fastest that is accurate enough', () => {
    const choice = chooseFrom(ordinary, { minPsnrDb: 45 });
    expect(choice).toMatchObject({ isMet: true, settings: internAccuracy('balanced') });
    expect(choice.why).toBe(
      'Of 3 settings measured, “balanced” is the fastest to reach 45 dB: 52.0 dB in 6 ms.',
    );
  });

  test('chooses the most accurate that is fast enough, by the whole interval', () => {
    expect(chooseFrom(ordinary, { maxFrameMs: 8 }).point.name).toBe('balanced');
    expect(chooseFrom(ordinary, { maxFrameMs: 6.05 }).point.name).toBe('fast');
  });

  test('chooses the closest if nothing meets the target, and says so', () => {
    expect(chooseFrom(ordinary, { minPsnrDb: 80 })).toMatchObject({
      isMet: false,
      why: 'None of the 3 settings measured can reach 80 dB; “high” comes closest with 65.0 dB in 9 ms.',
    });
    expect(chooseFrom(ordinary, { maxFrameMs: 1 })).toMatchObject({
      isMet: false,
      settings: internAccuracy('fast'),
    });
  });

  test('chooses the lowest median if nothing is fast enough, though times cannot be told apart', () => {
    const slow = table(['high', 94.9, 254, 120], ['balanced', 52, 230, 120], ['fast', 40, 190, 120]);
    const choice = chooseFrom(slow, { maxFrameMs: 8 });
    expect(choice.point.name).toBe('fast');
    const [high] = slow.points;
    const before = { ...choice, settings: high.settings, point: high };
    expect(chooseFrom(slow, { maxFrameMs: 8 }, before).point.name).toBe('fast');
    const alike = table(['high', 94.9, 254, 120], ['balanced', 52, 195, 120], ['fast', 40, 190, 120]);
    const [, balanced] = alike.points;
    expect(chooseFrom(alike, { maxFrameMs: 8 }, { ...choice, settings: balanced.settings }).point).toBe(
      balanced,
    );
  });

  test('does not flip between settings whose times cannot be told apart', () => {
    const target = { maxFrameMs: 6.2 };
    const first = chooseFrom(ordinary, target);
    expect(first.point.name).toBe('balanced');
    const slightlySlower = table(['high', 65, 9], ['balanced', 52, 6.15], ['fast', 40, 6.0]);
    expect(chooseFrom(slightlySlower, target).point.name).toBe('fast');
    const kept = chooseFrom(slightlySlower, target, first);
    expect(kept.point.name).toBe('balanced');
    expect(kept.why).toContain('stays');
    const muchSlower = table(['high', 65, 12], ['balanced', 52, 9], ['fast', 40, 4]);
    expect(chooseFrom(muchSlower, target, first).point.name).toBe('fast');
    // The more accurate of equally fast settings is chosen, whichever median happens to be lower.
    for (const noise of [-0.05, 0.05]) {
      const close = table(['high', 65, 6 + noise], ['balanced', 52, 6], ['fast', 40, 6 - noise]);
      const { point, why } = chooseFrom(close, { minPsnrDb: 35 });
      expect(point.name).toBe('high');
      expect(why).toContain(
        noise < 0 ? '“high” is the fastest' : 'none can reach 35 dB measurably faster than “high”',
      );
    }
  });

  test('rejects invalid targets', () => {
    for (const target of [
      {},
      { minPsnrDb: -1 },
      { maxFrameMs: Number.NaN },
      { minPsnrDb: 40, maxFrameMs: 8 },
    ])
      expect(() => chooseFrom(ordinary, target as never)).toThrow(InvalidArgumentError);
  });
});

describe('candidates', () => {
  const candidates = singleCandidates('balanced');

  test('the base comes first, then presets, the ablations, and each other value of each setting, none twice', () => {
    const names = candidates.map(({ name }) => name);
    expect(names.slice(0, 5)).toEqual(['balanced', 'reference', 'high', 'fast', 'paper']);
    expect(names).toEqual(
      expect.arrayContaining(['paper −CULL', 'paper −RADIUS', 'sortKeyBits 16', 'alphaCutoff 1/128']),
    );
    expect(new Set(candidates.map(({ settings }) => settings)).size).toBe(candidates.length);
    expect(candidates[0].changed).toEqual([]);
  });

  test('changes that pay are combined, the best first, one value of each setting', () => {
    const named = (name: string, psnrDb: number, totalMs: number) => ({
      candidate: candidates.find((each) => each.name === name)!,
      psnrDb,
      totalMs,
    });
    const combinations = combineChanges(named('balanced', 50, 10), [
      named('colorTarget rgba8unorm', 45, 6),
      named('alphaCutoff 1/128', 48, 9),
      named('alphaCutoff 1/64', 40, 8.5),
      named('sortKeyBits 16', 50, 9),
      named('recordPrecision paper', 30, 9.9),
    ]);
    expect(combinations).toEqual([
      { sortKeyBits: 16, colorTarget: 'rgba8unorm' },
      { sortKeyBits: 16, colorTarget: 'rgba8unorm', alphaCutoff: 1 / 128 },
    ]);
  });
});
