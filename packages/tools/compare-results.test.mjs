import { expect, test } from 'vitest';
import { compareImages, ratioLines, ratioTable, timeRatios } from './compare-results.mjs';

const image = () => Float32Array.from({ length: 120 }, (_, i) => Math.abs(Math.sin(i)));

/** The same image with bits of one value flipped. */
function flipped(at, bits) {
  const changed = image();
  new Uint32Array(changed.buffer)[at] ^= bits;
  return changed;
}

test('equal images are the same', () => {
  expect(compareImages(image(), image())).toEqual({ isSame: true, finding: 'identical' });
});

test('a single flipped bit is found wherever it is', () => {
  for (let at = 0; at < image().length; at++) {
    const { isSame, finding } = compareImages(image(), flipped(at, 1));
    expect(isSame).toBe(false);
    const [, largest, psnrDb] = /^1 of 120 values differ, by at most (.+), PSNR (.+) dB$/.exec(finding) ?? [];
    expect(Number(largest)).toBeLessThan(1e-7);
    expect(Number(psnrDb)).toBeGreaterThan(150);
  }
});

test('the sign of a zero is a difference, of no size', () => {
  const { isSame, finding } = compareImages(image(), flipped(0, 0x8000_0000));
  expect(isSame).toBe(false);
  expect(finding).toContain('by at most 0.00, PSNR Infinity dB');
});

test('a NaN is as far from a number as can be', () => {
  const broken = image();
  broken[7] = Number.NaN;
  expect(compareImages(image(), broken).finding).toContain('by at most Infinity');
  expect(compareImages(broken, broken).isSame).toBe(true);
});

test('largest difference and PSNR are those of the values', () => {
  const changed = image();
  changed[3] += 0.5;
  expect(compareImages(image(), changed).finding).toContain('by at most 0.500, PSNR 26.8 dB');
});

test('images of other sizes, missing images and blank images are differences', () => {
  expect(compareImages(image(), image().slice(4)).finding).toBe('120 and 116 values');
  expect(compareImages(image(), null)).toEqual({ isSame: false, finding: 'missing in B' });
  expect(compareImages(null, image()).finding).toBe('missing in A');
  const blank = new Float32Array(120);
  expect(compareImages(blank, blank)).toEqual({ isSame: false, finding: 'blank in A and B' });
  expect(compareImages(blank, image()).isSame).toBe(false);
});

test('times are compared round by round, as ratios of medians and of P99', () => {
  const spread = (median) => ({ median, p99: 2 * median });
  const measurement = (sort, isTimed = true) => ({
    stageMs: isTimed ? { sort: spread(sort) } : null,
    gpuMs: isTimed ? spread(4 * sort) : null,
    wallClockMs: spread(5 * sort),
    passes: isTimed ? [{ part: 'sort', stage: 'sort-scatter', timeMs: spread(sort / 2) }] : null,
  });
  const found = timeRatios(
    [1, 2, 4].map((ms) => measurement(ms)),
    [2, 3, 4].map((ms) => measurement(ms)),
  );
  const lines = ratioLines(found);
  expect(lines).toHaveLength(4);
  expect(lines[0]).toMatch(
    /^sort +median 2\.000 → 3\.000 ×1\.500 \(1\.000–2\.000\) {2}p99 4\.000 → 6\.000 ×1\.500/,
  );
  expect(lines[3]).toMatch(/^sort: sort-scatter/);
  const { columns, rows } = ratioTable(found, 'a caption');
  expect(rows[0]).toEqual(['sort', 2, 3, 1.5, 1, 2, 4, 6, 1.5, 1, 2]);
  expect(columns).toHaveLength(rows[0].length);
  const untimed = ratioLines(timeRatios([measurement(1, false)], [measurement(1, false)]));
  expect(untimed).toEqual([expect.stringMatching(/^frame, wall clock {2}median 5\.000/)]);
});
