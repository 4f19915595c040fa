import { getEventListeners } from 'node:events';
import { describe, expect, test } from 'vitest';
import { chunked } from '../../testing/ply-fixture.ts';
import { ByteReader } from './byte-reader.ts';

const numbers = (count: number) => Uint8Array.from({ length: count }, (_, i) => i * 7);

/** Gives `bytes` in chunks of these sizes, in turn, to memory that the reader brings. */
function writing(bytes: Uint8Array, sizes: readonly number[]): ReadableStream<Uint8Array<ArrayBuffer>> {
  let offset = 0;
  let turn = 0;
  return new ReadableStream({
    type: 'bytes',
    autoAllocateChunkSize: 1,
    pull(controller) {
      const request = controller.byobRequest!;
      const target = request.view as Uint8Array;
      const part = bytes.subarray(offset, offset + Math.min(sizes[turn++ % sizes.length], target.length));
      target.set(part);
      offset += part.length;
      if (part.length === 0) controller.close();
      request.respond(part.length);
    },
  });
}

const STREAMS = [
  { kind: 'gives chunks', streamOf: chunked },
  { kind: 'writes into memory', streamOf: writing },
] as const;

type StreamOf = (typeof STREAMS)[number]['streamOf'];

const readerOf = (streamOf: StreamOf, bytes: Uint8Array, sizes: number[], signal?: AbortSignal) =>
  new ByteReader({ name: 'test', stream: streamOf(bytes, sizes) }, signal);

describe.each(STREAMS)('a stream that $kind', ({ kind, streamOf }) => {
  test('fill, advance, skip and byteOffset agree with the bytes, whatever the chunks', async () => {
    const bytes = numbers(3_000_000);
    for (const sizes of [[1_000_000], [70_001, 3], [5_000_000]]) {
      const reader = readerOf(streamOf, bytes, sizes);
      let offset = 0;
      for (const [take, skip] of [
        [1, 0],
        [1000, 999_999],
        [1_500_000, 17],
        [200_000, 1],
      ]) {
        expect(await reader.fill(take)).toBe(true);
        expect(reader.byteOffset).toBe(offset);
        expect(reader.bytes[reader.start]).toBe(bytes[offset]);
        expect(reader.view.getUint8(reader.start + take - 1)).toBe(bytes[offset + take - 1]);
        reader.advance(take);
        expect(await reader.skip(skip)).toBe(true);
        offset += take + skip;
      }
      expect(await reader.fill(bytes.length)).toBe(false);
      expect(reader.available).toBe(bytes.length - offset);
      expect(await reader.skip(bytes.length)).toBe(false);
    }
  });

  test('peek shows the next bytes, no more than asked for or there are, and leaves them to be read', async () => {
    const bytes = numbers(1_000_000);
    for (const sizes of [[1_000_000], [70_001, 3]]) {
      const reader = readerOf(streamOf, bytes, sizes);
      expect(await reader.peek(100)).toEqual(bytes.subarray(0, 100));
      expect(reader.byteOffset).toBe(0);
      await reader.skip(999_990);
      expect(await reader.peek(4)).toEqual(bytes.subarray(999_990, 999_994));
      expect(await reader.peek(100)).toEqual(bytes.subarray(999_990));
      expect(await reader.fill(10)).toBe(true);
      await reader.skip(10);
      expect(await reader.peek(1)).toEqual(new Uint8Array(0));
    }
  });

  test.each([{ mayDetach: true }, { mayDetach: false }])(
    'readInto gives the next bytes past the window ($mayDetach: memory may move), and tells of each part',
    async ({ mayDetach }) => {
      const bytes = numbers(2_500_000);
      for (const sizes of [[1_000_000], [70_001, 3], [5_000_000]]) {
        const reader = readerOf(streamOf, bytes, sizes);
        await reader.fill(10);
        reader.advance(4);
        const offsets: number[] = [];
        const given = new Uint8Array(2_000_100).subarray(50, 2_000_050);
        const target = await reader.readInto(given, mayDetach, () => offsets.push(reader.byteOffset));
        expect(Buffer.compare(target!, bytes.subarray(4, 2_000_004))).toBe(0);
        expect(target!.byteOffset).toBe(50);
        expect(target!.buffer.byteLength).toBe(2_000_100);
        expect(given.length === 0).toBe(mayDetach && kind === 'writes into memory');
        expect(offsets.at(-1)).toBe(2_000_004);
        expect(offsets).toEqual(offsets.toSorted((a, b) => a - b));
        expect(await reader.fill(6)).toBe(true);
        expect(reader.bytes[reader.start]).toBe(bytes[2_000_004]);
        expect(await reader.readInto(new Uint8Array(500_000), mayDetach, () => {})).toBeNull();
      }
    },
  );

  /** A stream of `bytes` from `start` on that breaks after `count` of them, if there are more. */
  function breaking(bytes: Uint8Array, start: number, count: number): ReadableStream<Uint8Array> {
    const part = bytes.subarray(start, start + count);
    const whole = streamOf(part, [70_001]);
    if (start + count >= bytes.length) return whole;
    let left = part.length;
    if (kind === 'gives chunks') {
      const breakOff = new TransformStream<Uint8Array, Uint8Array>({
        flush: () => Promise.reject(new Error('gone')),
      });
      return whole.pipeThrough(breakOff);
    }
    return new ReadableStream<Uint8Array>({
      type: 'bytes',
      autoAllocateChunkSize: 1,
      pull(controller) {
        const request = (controller as unknown as ReadableByteStreamController).byobRequest!;
        const target = request.view as Uint8Array;
        if (left === 0) return controller.error(new Error('gone'));
        const given = part.subarray(part.length - left).subarray(0, Math.min(70_001, target.length));
        target.set(given);
        left -= given.length;
        request.respond(given.length);
      },
    } as UnderlyingSource<Uint8Array>);
  }

  test.each([{ mayDetach: true }, { mayDetach: false }])(
    'a source that breaks off is resumed, from before where it was if need be ($mayDetach: memory may move)',
    async ({ mayDetach }) => {
      const bytes = numbers(2_500_000);
      for (const back of [0, 100_000, 1e9]) {
        const resumes: number[] = [];
        const resume = async (offset: number, failure: Error) => {
          expect(failure.message).toBe('test: reading stopped: gone');
          resumes.push(offset);
          const startsAt = Math.max(0, offset - back);
          return { startsAt, stream: breaking(bytes, startsAt, offset - startsAt + 900_000) };
        };
        const reader = new ByteReader({ name: 'test', stream: breaking(bytes, 0, 900_000), resume });
        expect(await reader.fill(10)).toBe(true);
        reader.advance(4);
        const target = await reader.readInto(new Uint8Array(2_000_000).subarray(7), mayDetach, () => {});
        expect(Buffer.compare(target!, bytes.subarray(4, 2_000_000 - 3))).toBe(0);
        expect(reader.byteOffset).toBe(2_000_000 - 3);
        expect(await reader.fill(500_003)).toBe(true);
        const rest = reader.bytes.subarray(reader.start, reader.start + 500_003);
        expect(Buffer.compare(rest, bytes.subarray(2_000_000 - 3))).toBe(0);
        expect(await reader.fill(500_004)).toBe(false);
        expect(resumes.length).toBeGreaterThan(0);
      }
    },
  );

  test('a source that cannot be resumed fails with the reason', async () => {
    const stream = breaking(numbers(300_000), 0, 200_000);
    const reader = new ByteReader({ name: 'test', stream });
    await expect(reader.skip(250_000)).rejects.toThrow('test: reading stopped: gone');
  });

  test('no more than the most bytes are read', async () => {
    const bytes = numbers(300_000);
    const reading = (maxBytes: number) =>
      new ByteReader({ name: 'test', stream: streamOf(bytes, [1000]) }, undefined, maxBytes).skip(300_000);
    expect(await reading(300_000)).toBe(true);
    await expect(reading(299_999)).rejects.toMatchObject({ code: 'too-large', place: { byte: 299_999 } });
  });

  test('a signal that outlives the read keeps no listener', async () => {
    const { signal } = new AbortController();
    const reader = readerOf(streamOf, numbers(10), [3], signal);
    expect(getEventListeners(signal, 'abort')).toHaveLength(1);
    expect(await reader.skip(11)).toBe(false);
    expect(getEventListeners(signal, 'abort')).toHaveLength(0);
  });

  test('a signal ends a read at once', async () => {
    const stop = new AbortController();
    const reader = readerOf(streamOf, numbers(10), [3], stop.signal);
    const reading = reader.readInto(new Uint8Array(20), true, () => stop.abort(new Error('enough')));
    await expect(reading).rejects.toThrow('enough');
  });
});

/**
 * @fault Time: a stream sends empty chunks without end
 * @consequence the page runs, and can abort
 */
test('a stream of empty chunks without end lets the event loop run, and can be aborted', async () => {
  const stop = new AbortController();
  const stream = new ReadableStream<Uint8Array<ArrayBuffer>>({
    pull: (controller) => controller.enqueue(new Uint8Array(0)),
  });
  const reader = new ByteReader({ name: 'test', stream }, stop.signal);
  setTimeout(() => stop.abort(new Error('enough')));
  await expect(reader.fill(1)).rejects.toThrow('enough');
});
