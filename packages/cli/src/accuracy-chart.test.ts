import { resolveAccuracy } from '@websplatter/core';
import type { AccuracyPoint, AccuracyTable } from '@websplatter/core/measure';
import { describe, expect, test } from 'vitest';
import { accuracyChart } from './accuracy-chart.ts';
import { accuracyJson, accuracyText } from './accuracy-report.ts';

type Row = readonly [
  name: string,
  psnrDb: number,
  totalMs: number,
  isOnFront?: boolean,
  /** Of less detail. */
  splats?: number,
];

/** As crowded as a real measurement: many settings differ little and lie close together. */
const ROWS: readonly Row[] = [
  ['balanced', 52.1, 6.2],
  ['reference', Number.POSITIVE_INFINITY, 11.4, true],
  ['high', 66.2, 6.9, true],
  ['fast', 38.4, 4.1, true],
  ['paper', 45.2, 6.6],
  ['paper −CULL', 45.2, 6.8],
  ['paper −RADIUS', 45.2, 8.1],
  ['geometryPrecision f32', 53.9, 6.5],
  ['shPrecision f16', 55.1, 6.3, true],
  ['recordPrecision f32', 47.3, 6.05],
  ['recordPrecision paper', 41.2, 5.9],
  ['alphaCutoff 1/64', 31.8, 5.8],
  ['sortKeyBits 24', 52.1, 6.1],
  ['rasterizer tiles', 52.0, 6.0, true],
  ['sortKeyBits 16', 50.2, 5.7, true],
  ['shPrecision f32', 49.0, 7.7],
  ['alphaCutoff 1/128', 46.1, 5.5, true],
  ['extent fixed', 52.1, 7.4],
  ['culling frustum', 52.1, 6.35],
  ['colorTarget rgba32float', 52.2, 9.6],
  ['colorTarget rgba8unorm', 43.1, 5.0, true],
  ['rasterizer quads', 33.4, 4.6],
  ['resolutionScale 0.5', 28.9, 3.2, true],
  ['sortKeyBits 24, colorTarget rgba8unorm', 43.0, 4.8, true],
];

/** Each with the base's settings. */
const DETAIL_ROWS: readonly Row[] = [
  ['25 % of splats', 35.5, 3.6, true, 1_400_000],
  ['50 % of splats', 40.1, 4.4, false, 2_900_000],
];

function table(rows = [...ROWS, ...DETAIL_ROWS]): AccuracyTable {
  const base = resolveAccuracy('balanced');
  const hasDetails = rows.some(([, , , , splats]) => splats !== undefined);
  const points = rows.map(([name, psnrDb, median, isOnFront = false, splats], i): AccuracyPoint => {
    const total = { median, low: median - 0.12, high: median + 0.15, p99: median + 0.6 };
    const part = (share: number) => ({ ...total, median: share * median });
    return {
      name,
      settings: i === 0 || splats !== undefined ? base : resolveAccuracy('high'),
      changed: [],
      detail: splats === undefined ? 'full' : { maxSplats: splats },
      splats: splats ?? 5_800_000,
      filteredPsnrDb: hasDetails ? 30 + median : null,
      error: { psnrDb, maxError: 0.01, p999Error: 0.001, ssim: 0.999 },
      timeMs: { preprocess: part(0.2), sort: part(0.2), rasterize: part(0.6), total },
      rasterizers: i === 0 ? ['tiles', 'quads'] : ['tiles'],
      isOnFront,
      bytes: 5e8,
      notes: [],
    };
  });
  return {
    points,
    base,
    detail: 'full',
    reference: { settings: resolveAccuracy('reference'), notes: [] },
    notes: [
      'shPrecision f16 is left out: still life is drawn with u8 spherical harmonics, the nearest it holds.',
    ],
    timing: 'gpu-timestamps',
    adapter: 'Some adapter',
    widthPx: 1920,
    heightPx: 1080,
    splats: 5_834_784,
    views: 1,
    frames: 15,
    elapsedMs: 9000,
  };
}

describe('accuracyChart', () => {
  const chart = accuracyChart(table(), 'garden <1> & more');

  test('labels every point, marks the front and the base, and escapes its text', () => {
    for (const [name] of [...ROWS, ...DETAIL_ROWS]) expect(chart).toContain(`>${name}</text>`);
    // A combination is a letter in the plot, and a line of the key.
    expect(chart.match(/>A<\/text>/g)).toHaveLength(2);
    expect(chart.match(/class="dot onFront"/g)!.length).toBeGreaterThan(8);
    expect(chart).toContain('garden &lt;1&gt; &amp; more');
    expect(chart).not.toMatch(/NaN|Infinity|undefined/);
  });

  test('draws less detail as diamonds on a line from the base, below the front', () => {
    const placeOf = (name: string) => {
      const [, x, y] = new RegExp(`(?:cx="|d="M)([\\d.]+)(?:" cy="| )([\\d.]+)[^>]*><title>${name}:`).exec(
        chart,
      )!;
      return [Number(x), Number(y)] as const;
    };
    const line = /class="details" d="M([^"]+)"/.exec(chart)![1].split('L');
    const [base, half, quarter] = line.map((place) => place.split(' ').map(Number));
    expect(base).toEqual(placeOf('balanced'));
    // Diamonds begin at their left corner.
    expect(half).toEqual([placeOf('50 % of splats')[0] + 5, placeOf('50 % of splats')[1]]);
    expect(quarter).toEqual([placeOf('25 % of splats')[0] + 5, placeOf('25 % of splats')[1]]);
    expect(line).toHaveLength(3);
    expect(chart.indexOf('class="details"')).toBeLessThan(chart.indexOf('class="front"'));
    expect(chart.match(/<path class="dot detail/g)).toHaveLength(3);
    expect(chart.match(/<path class="dot detail onFront"/g)).toHaveLength(1);
    expect(chart.match(/<circle class="dot base"/g)).toHaveLength(2);
    expect(accuracyChart(table([...ROWS]), 'garden')).not.toMatch(/<path class="(details|dot)/);
  });
});

describe('the report', () => {
  test('is sorted by time and aligned, the base and the front marked', () => {
    const lines = accuracyText(table(), 'garden').split('\n');
    const rows = lines.slice(3, 3 + ROWS.length + DETAIL_ROWS.length);
    expect(rows[0]).toMatch(/^\* {3}resolutionScale 0\.5/);
    expect(rows.find((row) => row.includes('balanced'))).toMatch(/^ > {2}balanced/);
    expect(rows.filter((row) => row.startsWith(' >') || row.startsWith('*>'))).toHaveLength(1);
    expect(new Set(rows.map((row) => row.length)).size).toBe(1);
    expect(lines[2]).toMatch(/setting +splats +PSNR dB +filtered dB/);
    expect(rows.find((row) => row.includes('25 %'))).toMatch(
      /^\* {3}25 % of splats +1,400,000 +35\.5 +33\.6 /,
    );
    expect(lines.join()).toContain('Filtered is against the reference with 4×4 samples per pixel');
    expect(lines).toContain(
      'note: shPrecision f16 is left out: still life is drawn with u8 spherical harmonics, the nearest it holds.',
    );
  });

  test('says nothing of filtered pictures where there are none', () => {
    const text = accuracyText(table([...ROWS]), 'garden');
    expect(text).not.toContain('Filtered');
    expect(text).toMatch(/fast +5,800,000 +38\.4 +– /);
  });

  test('is JSON with null for images that are equal', () => {
    const parsed = JSON.parse(accuracyJson(table(), { scenes: ['garden'], distance: 4 }, null));
    expect(parsed).toMatchObject({ scenes: ['garden'], distance: 4, detail: 'full' });
    expect(parsed.points.at(-1)).toMatchObject({
      detail: { maxSplats: 2_900_000 },
      splats: 2_900_000,
      filteredPsnrDb: 34.4,
    });
    expect(parsed.points[1].error.psnrDb).toBeNull();
    expect(parsed.points[0].timeMs.total.median).toBe(6.2);
  });
});
