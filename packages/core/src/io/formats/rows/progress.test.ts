import { afterEach, beforeEach, expect, test, vi } from 'vitest';
import { ksplatBytes, randomSections } from '../../../testing/ksplat-fixture.ts';
import { randomSplats } from '../../../testing/random-splats.ts';
import { slowFile } from '../../../testing/slow-file.ts';
import { readSplats } from '../../loading/read-splats.ts';
import { ByteReader } from '../../sources/byte-reader.ts';
import type { LoadProgress } from '../../sources/splat-source.ts';
import type { SplatInput } from '../read-format.ts';
import { writeSplats } from '../writers.ts';
import { ReadProgress } from './progress.ts';

beforeEach(() => {
  vi.useFakeTimers({ toFake: ['performance'] });
});
afterEach(() => {
  vi.useRealTimers();
});

/** A file of 100 bytes that has been read, whose size the server does not tell as it packs it. */
async function readInput(about: Partial<SplatInput> = {}): Promise<SplatInput> {
  const name = 'meta.json';
  const reader = new ByteReader({ name, stream: new Blob([new Uint8Array(100)]).stream() });
  await reader.fill(100);
  reader.advance(100);
  return { name, totalBytes: undefined, totalBytesCertain: false, isLocal: false, reader, ...about };
}

/** Time enough for another report passes before each call. */
function watch(input: SplatInput) {
  const reports: [loaded: number, total: number | undefined][] = [];
  const onProgress = ({ loadedBytes, totalBytes }: LoadProgress) => reports.push([loadedBytes, totalBytes]);
  const progress = new ReadProgress(input, onProgress);
  const later = (arrived: (bytes: number) => void, bytes: number) => {
    vi.advanceTimersByTime(1000);
    arrived(bytes);
  };
  return { progress, reports, later };
}

test('arrived bytes of several files count, and their size once all are known', async () => {
  const { progress, reports, later } = watch(await readInput());
  progress.expectParts(2);
  const first = progress.beginPart(1000);
  later(first, 10);
  later(first, 200);
  const second = progress.beginPart(500);
  later(second, 50);
  later(first, 1000);
  later(second, 500);
  expect(reports).toEqual([
    [110, undefined],
    [300, undefined],
    [350, 1600],
    [1150, 1600],
    [1600, 1600],
  ]);
});

test('the size stays unknown where that of one file does, or the number of files', async () => {
  const packed = watch(await readInput());
  packed.progress.expectParts(2);
  packed.progress.beginPart(undefined);
  packed.later(packed.progress.beginPart(500), 500);
  const streamed = watch(await readInput({ totalBytes: 100 }));
  streamed.later(streamed.progress.beginPart(500), 500);
  for (const { reports } of [packed, streamed]) expect(reports).toEqual([[600, undefined]]);
});

test('a file that has more bytes than was said makes the size unknown', async () => {
  const { progress, reports, later } = watch(await readInput());
  progress.expectParts(1);
  const arrived = progress.beginPart(50);
  later(arrived, 50);
  later(arrived, 60);
  expect(reports).toEqual([
    [150, 150],
    [160, undefined],
  ]);
});

test('files in an archive are counted as the archive arrives', async () => {
  const archive = await readInput({ name: 'scene.zip', totalBytes: 4000 });
  const { progress, reports, later } = watch(await readInput({ packed: archive }));
  progress.expectParts(1);
  later(progress.beginPart(500), 500);
  vi.advanceTimersByTime(1000);
  progress.report(3);
  expect(reports).toEqual([[100, 4000]]);
});

const WRITTEN = ['ply', 'compressed-ply', 'spz', 'sog', 'gltf'] as const;

async function bytesOf(
  format: (typeof WRITTEN)[number] | 'splat' | 'ksplat',
): Promise<Uint8Array<ArrayBuffer>> {
  if (format === 'ksplat') return ksplatBytes(randomSections(600, [1]), 1);
  // Up to 64 kB of packed bytes are read ahead of those that are unpacked.
  const count = format === 'spz' ? 30_000 : 600;
  if (format !== 'splat') return writeSplats(randomSplats({ count, shDegree: 1 }), format);
  const rows = new Float32Array(8 * 600);
  for (let at = 0; at < rows.length; at += 8) rows.fill(0.1, at, at + 6);
  return new Uint8Array(rows.buffer).fill(200, 24, 32);
}

/**
 * @fault Files: one arrives slowly
 * @consequence its bytes are counted while they arrive, whatever its format
 */
test.each([...WRITTEN, 'splat', 'ksplat'] as const)(
  'bytes of %s are counted while they arrive, at the rate since the first',
  async (format) => {
    const bytes = await bytesOf(format);
    const parts = Array.from({ length: 10 }, (_, i) =>
      bytes.slice((i * bytes.length) / 10, ((i + 1) * bytes.length) / 10),
    );
    const reports: LoadProgress[] = [];
    let before: LoadProgress | undefined;
    const file = slowFile(`scene.${format}`, bytes, parts, async () => {
      before = reports.at(-1);
    });
    const stream = file.stream;
    file.stream = () => {
      const source = stream().getReader();
      return new ReadableStream(
        {
          async pull(controller) {
            // A second per part.
            vi.advanceTimersByTime(1000);
            const { done, value } = await source.read();
            if (done) controller.close();
            else controller.enqueue(value);
          },
        },
        { highWaterMark: 0 },
      );
    };
    await readSplats(file, { onProgress: (progress) => reports.push(progress) });
    expect(before?.loadedBytes).toBeGreaterThan(0.5 * bytes.length);
    expect(before?.totalBytes).toBe(bytes.length);
    const { loadedBytes, bytesPerSecond } = reports.at(-1)!;
    expect(loadedBytes).toBe(bytes.length);
    expect(bytesPerSecond).toBeLessThan(0.2 * bytes.length);
  },
);
