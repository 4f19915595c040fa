import { describe, expect, test } from 'vitest';
import { InvalidArgumentError } from '../../data/errors.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { readSplats } from '../loading/read-splats.ts';
import { SPLAT_FORMATS } from './formats.ts';
import { WRITABLE_FORMATS, writableByName } from './writable-formats.ts';
import { writeSplats } from './writers.ts';

const NAMES = WRITABLE_FORMATS.map(({ name }) => name);

describe.each(WRITABLE_FORMATS)('$name', ({ name, extension }) => {
  test('is read again under its own name', async () => {
    const set = randomSplats({ count: 5, shDegree: 1 });
    const bytes = await writeSplats(set, name);
    const again = await readSplats(bytes, { name: `scene${extension}` });
    expect(again).toMatchObject({ count: 5, fileFacts: { format: name } });
  });

  /** @fault Files: log scales of −∞ in a PLY, or in the bounds of a compressed one */
  test('keeps splats that are flat, and others beside them', async () => {
    const set = randomSplats({ count: 300, shDegree: 0 });
    for (let i = 0; i < 100; i++) set.logScales[3 * i] = Number.NEGATIVE_INFINITY;
    const again = await readSplats(await writeSplats(set, name), { name: `scene${extension}` });
    const flatCount = (values: Float32Array) => values.filter((value) => value < -9.9).length;
    expect(again).toMatchObject({ count: 300, dropped: {} });
    expect(flatCount(again.logScales)).toBe(100);
    const finite = again.logScales.filter((value) => value > -9.9);
    expect(Math.min(...finite)).toBeGreaterThan(-5.1);
  });

  test('is chosen by the end of a file’s name', () => {
    expect(writableByName(`a/B${extension.toUpperCase()}`)?.name).toBe(name);
  });

  test('tells how far it is, up to the end', async () => {
    const told: number[] = [];
    const onProgress = (fraction: number) => told.push(fraction);
    await writeSplats(randomSplats({ count: 3 }), name, { onProgress });
    expect(told.at(-1)).toBe(1);
    expect(told).toEqual([...told].sort((a, b) => a - b));
  });

  test('ends when it is aborted, before and in between', async () => {
    const set = randomSplats({ count: 2000 });
    const signal = AbortSignal.abort('no longer wanted');
    await expect(writeSplats(set, name, { signal })).rejects.toBe('no longer wanted');
    const controller = new AbortController();
    const writing = writeSplats(set, name, {
      signal: controller.signal,
      onProgress: () => controller.abort('enough'),
    });
    await expect(writing).rejects.toBe('enough');
  });
});

test('other formats are refused, with the choices', async () => {
  const writing = writeSplats(randomSplats({ count: 1 }), 'ksplat');
  await expect(writing).rejects.toThrow(InvalidArgumentError);
  await expect(writing).rejects.toThrow(`one of ${NAMES.join(', ')}`);
  expect(writableByName('scene.ksplat')).toBeUndefined();
});

test('no splats make no file', async () => {
  await expect(writeSplats(randomSplats({ count: 0 }), 'ply')).rejects.toMatchObject({ argument: 'set' });
});

test('every written format is read', () => {
  const read = SPLAT_FORMATS.map(({ name }) => name);
  expect(NAMES.filter((name) => !read.includes(name))).toEqual([]);
});
