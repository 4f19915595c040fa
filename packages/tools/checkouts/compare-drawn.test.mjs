import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { expect, test } from 'vitest';
import { compareDrawn } from './compare-drawn.mjs';
import { DrawnFolder, readDrawnFolder } from './drawn-folder.mjs';

const WIDTH_PX = 6;
const HEIGHT_PX = 5;

function image() {
  const values = Float32Array.from({ length: 4 * WIDTH_PX * HEIGHT_PX }, (_, i) => Math.abs(Math.sin(i)));
  return { widthPx: WIDTH_PX, heightPx: HEIGHT_PX, values };
}

/** The same image with bits of one value flipped. */
function flipped(at, bits) {
  const changed = image();
  new Uint32Array(changed.values.buffer)[at] ^= bits;
  return changed;
}

/** What is said of output `one` in A against the same in B. */
function comparisonOf(a, b) {
  const [row] = compareDrawn(new Map(a && [['one', a]]), new Map(b && [['one', b]]));
  return row;
}

test('equal images, values and skipped cases are the same', () => {
  expect(comparisonOf(image(), image())).toMatchObject({ isSame: true, size: '6×5', finding: 'identical' });
  expect(comparisonOf({ value: [1, null] }, { value: [1, null] }).isSame).toBe(true);
  const skipped = { skipped: 'there is no file' };
  expect(comparisonOf(skipped, skipped)).toMatchObject({
    isSame: true,
    finding: 'skipped: there is no file',
  });
});

test('a single flipped bit is found wherever it is', () => {
  for (let at = 0; at < image().values.length; at++) {
    const row = comparisonOf(image(), flipped(at, 1));
    expect(row).toMatchObject({ isSame: false, finding: '1 of 120 values differ' });
    expect(row.largest).toBeLessThan(1e-7);
    expect(row.psnrDb).toBeGreaterThan(150);
  }
});

test('the sign of a zero is a difference, of no size', () => {
  const row = comparisonOf(image(), flipped(0, 0x8000_0000));
  expect(row).toMatchObject({ isSame: false, largest: 0, psnrDb: Number.POSITIVE_INFINITY });
});

test('a NaN is as far from a number as can be', () => {
  const broken = image();
  broken.values[7] = Number.NaN;
  expect(comparisonOf(image(), broken)).toMatchObject({ isSame: false, largest: Number.POSITIVE_INFINITY });
  expect(comparisonOf(broken, broken).isSame).toBe(true);
});

test('largest difference and PSNR are those of the values', () => {
  const changed = image();
  changed.values[3] += 0.5;
  const { largest, psnrDb } = comparisonOf(image(), changed);
  expect(largest).toBeCloseTo(0.5, 6);
  expect(psnrDb).toBeCloseTo(-10 * Math.log10(0.25 / 120), 4);
});

test('an output that one side lacks, skips or fails at is a difference', () => {
  expect(comparisonOf(image(), null)).toMatchObject({ isSame: false, finding: 'missing in B' });
  expect(comparisonOf(null, image())).toMatchObject({ isSame: false, finding: 'missing in A' });
  expect(comparisonOf(image(), { skipped: 'why' })).toMatchObject({ isSame: false });
  expect(comparisonOf(image(), { failed: 'Error: no' }).finding).toBe('failed in B: Error: no');
});

test('what fails on both sides is not the same', () => {
  const failed = { failed: 'Error: no' };
  expect(comparisonOf(failed, failed).isSame).toBe(false);
});

test('other sizes are a difference, even where there are as many values', () => {
  const turned = { ...image(), widthPx: HEIGHT_PX, heightPx: WIDTH_PX };
  expect(comparisonOf(image(), turned)).toMatchObject({
    isSame: false,
    finding: 'sizes differ: 6×5 and 5×6',
  });
});

test('blank images prove nothing', () => {
  const blank = { ...image(), values: new Float32Array(120) };
  expect(comparisonOf(blank, blank)).toMatchObject({ isSame: false, finding: 'blank in A and B' });
  expect(comparisonOf(blank, image()).isSame).toBe(false);
});

test('values that differ, and an image in place of a value, are differences', () => {
  expect(comparisonOf({ value: { on: true } }, { value: { on: false } }).finding).toMatch(/^differs: /);
  expect(comparisonOf(image(), { value: 1 }).isSame).toBe(false);
});

test('a folder gives back the bits that it took, and takes each name once', () => {
  const folder = mkdtempSync(join(tmpdir(), 'websplatter-drawn-'));
  const drawn = new DrawnFolder(folder);
  const odd = flipped(0, 0x8000_0000);
  odd.values[5] = Number.NaN;
  drawn.image('group/case/image', odd);
  drawn.value('group/case/picks', [null, { splatIndex: 3 }]);
  drawn.skipped('group/other', 'there is no file');
  expect(() => drawn.value('group/case/image', 1)).toThrow(/two outputs/);
  drawn.note('group/memory', 12);
  drawn.close({ adapter: 'some adapter' });
  const { adapter, outputs, notes } = readDrawnFolder(folder);
  rmSync(folder, { recursive: true });
  expect(adapter).toBe('some adapter');
  expect(notes).toEqual([{ name: 'group/memory', value: 12 }]);
  const same = new Map([
    ['group/case/image', odd],
    ['group/case/picks', { value: [null, { splatIndex: 3 }] }],
    ['group/other', { skipped: 'there is no file' }],
  ]);
  expect(compareDrawn(outputs, same).map(({ isSame }) => isSame)).toEqual([true, true, true]);
});
