import { gpuTest, shareTestDevice } from '@websplatter/node/gpu-test';
import { afterAll, beforeAll, describe, expect } from 'vitest';
import type { RecordPrecision } from '../accuracy/accuracy.ts';
import { Pipelines } from '../gpu/pipelines.ts';
import { readWords } from '../gpu/read-buffer.ts';
import { CHUNK_SPLATS, SHADER_CONSTANTS } from '../layout/constants.ts';
import { fromHalfBits, toHalfBits } from '../layout/half.ts';
import { Page, PagePlan, SPLAT_RECORDS, View } from '../layout/structs.ts';
import type { Vec3 } from '../math/mat4.ts';
import { type DrawnColor, keepColors as keepTwin } from '../reference/keep-colors.ts';
import { runStage, storageBuffer, uniformBuffer } from '../testing/gpu-buffers.ts';
import { seededRandom } from '../testing/seeded-random.ts';
import { dispatchSize } from './dispatch.ts';
import { keepColors } from './keep-colors.ts';

let device: GPUDevice;
beforeAll(async () => {
  device = await shareTestDevice();
});
afterAll(() => device.destroy());

/** Number of splats of each page; every page begins with a new chunk. */
const PAGES = [3 * CHUNK_SPLATS, 5, 5 * CHUNK_SPLATS - 1];
const DISPATCH_ROW = 2;
const OLD = 0xabcd0123;

/** A colour as a record holds it, and the record's words for that colour, opacity last. */
function recordColor(
  precision: RecordPrecision,
  random: () => number,
): { readonly color: Vec3; readonly words: readonly number[] } {
  if (precision === 'paper') {
    const bytes = [0, 1, 2, 3].map(() => Math.floor(256 * random()));
    const [r, g, b] = bytes.map((byte) => byte / 255);
    return { color: [r, g, b], words: [new Uint32Array(Uint8Array.from(bytes).buffer)[0]] };
  }
  const values = Float32Array.from(
    [0, 0, 0, 0],
    () => [0, 1, 60000, random(), 3 * random()][Math.floor(5 * random())],
  );
  if (precision === 'f32') {
    const [r, g, b] = values;
    return { color: [r, g, b], words: [...new Uint32Array(values.buffer)] };
  }
  const halves = Uint16Array.from(values, toHalfBits);
  const [r, g, b] = Array.from(halves, fromHalfBits);
  return { color: [r, g, b], words: [...new Uint32Array(halves.buffer)] };
}

/** Keeps the colours of every page and compares all entries with the twin's. */
async function check(
  precision: RecordPrecision,
  visiblePart: number,
  viewpoint: number,
  pipelines = new Pipelines(device),
): Promise<void> {
  const random = seededRandom(visiblePart + viewpoint);
  const record = SPLAT_RECORDS[precision];
  const recordWords = record.bytes / 4;
  const entryWords = precision === 'f32' ? 4 : 2;
  const chunkStarts = PAGES.map((_, page) =>
    PAGES.slice(0, page).reduce((sum, splats) => sum + Math.ceil(splats / CHUNK_SPLATS), 0),
  );
  const drawn: (DrawnColor & { readonly words: readonly number[] })[] = [];
  const plans = new ArrayBuffer(PAGES.length * PagePlan.bytes);
  const visibleCounts = PAGES.map((splatCount, page) => {
    const start = drawn.length;
    for (let index = 0; index < splatCount; index++)
      if (random() < visiblePart)
        drawn.push({ splat: chunkStarts[page] * CHUNK_SPLATS + index, ...recordColor(precision, random) });
    const count = drawn.length - start;
    const unread = { chunkStart: OLD, chunkEnd: OLD, slotStart: OLD, slotCount: OLD };
    const visible = { visibleStart: start, visibleCount: count };
    PagePlan.write(plans, { ...unread, ...visible }, page * PagePlan.bytes);
    return count;
  });
  const records = Uint32Array.from(
    { length: Math.max(1, drawn.length) * recordWords },
    () => 2 ** 32 * random(),
  );
  for (const [i, { words }] of drawn.entries())
    records.set(words, i * recordWords + record.offsets.color / 4);
  const view = new ArrayBuffer(View.bytes);
  new Uint32Array(view)[View.offsets.dispatchRow / 4] = DISPATCH_ROW;
  const shared = {
    view: uniformBuffer(device, view),
    pagePlans: storageBuffer(device, new Uint32Array(plans)),
    visibleSplats: storageBuffer(
      device,
      drawn.map(({ splat }) => splat),
    ),
    records: storageBuffer(device, records),
  };

  for (const [page, splatCount] of PAGES.entries()) {
    const contents = new ArrayBuffer(Page.bytes);
    new Uint32Array(contents)[Page.offsets.index / 4] = page;
    new Uint32Array(contents)[Page.offsets.chunkStart / 4] = chunkStarts[page];
    const entries = new Uint32Array(entryWords * (splatCount + 1)).fill(OLD);
    entries[0] = viewpoint;
    const keptColors = storageBuffer(device, entries);
    const workgroups = Math.ceil(visibleCounts[page] / SHADER_CONSTANTS.PROJECT_WORKGROUP);
    await runStage(
      device,
      pipelines,
      keepColors(precision),
      { ...shared, page: uniformBuffer(device, contents), keptColors },
      // An extra workgroup must do nothing.
      dispatchSize(workgroups + 1, DISPATCH_ROW),
    );
    const kept = await readWords(device, keptColors);
    expect(kept.subarray(0, entryWords)).toEqual(entries.subarray(0, entryWords));
    const expected = keepTwin(drawn, chunkStarts[page] * CHUNK_SPLATS, splatCount);
    for (const [index, color] of expected.entries()) {
      const words = kept.subarray(entryWords * (index + 1), entryWords * (index + 2));
      if (!isAsExpected(words, color, viewpoint, precision))
        expect.fail(`The entry of splat ${index} of page ${page} is ${words}; its colour is ${color}.`);
    }
  }
}

/** @param color null if the entry must not change. */
function isAsExpected(
  words: Uint32Array,
  color: Vec3 | null,
  viewpoint: number,
  precision: RecordPrecision,
): boolean {
  if (!color) return words.every((word) => word === OLD);
  const entry = decode(words);
  // Bytes become float16: WGSL allows rounding up or down.
  const tolerance = precision === 'paper' ? 2 ** -10 : 0;
  const isNear = (value: number, channel: number) =>
    Math.abs(entry.color[channel] - value) <= tolerance * value;
  return entry.viewpoint === viewpoint && color.every(isNear);
}

function decode(words: Uint32Array): { readonly color: readonly number[]; readonly viewpoint: number } {
  if (words.length === 4)
    return { color: [...new Float32Array(words.slice().buffer, 0, 3)], viewpoint: words[3] };
  const [r, g, b, viewpoint] = new Uint16Array(words.slice().buffer);
  return { color: [r, g, b].map(fromHalfBits), viewpoint };
}

describe('keep-colors', () => {
  for (const precision of ['f32', 'f16', 'paper'] as const) {
    for (const visiblePart of [0, 0.001, 0.4, 1]) {
      gpuTest(`${precision} records, ${100 * visiblePart} % of the splats drawn`, async () => {
        await check(precision, visiblePart, 1);
        await check(precision, visiblePart, 0xffff);
      });
    }
  }

  gpuTest('a colour in its neighbour’s entry is noticed', async () => {
    const mutation = { file: 'stages/keep-colors', find: 'splatIndex + 1u', replace: 'splatIndex + 2u' };
    await expect(check('f16', 0.4, 1, new Pipelines(device, mutation))).rejects.toThrow('of page 0');
  });
});
