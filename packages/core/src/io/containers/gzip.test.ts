import { randomBytes } from 'node:crypto';
import { gzipSync } from 'node:zlib';
import { expect, test } from 'vitest';
import { gunzip } from './gzip.ts';

test('what is packed is read only as far as its contents are wanted', async () => {
  const contents = randomBytes(1 << 22);
  const packed = gzipSync(contents);
  let taken = 0;
  const stream = new ReadableStream<Uint8Array<ArrayBuffer>>(
    {
      pull(controller) {
        const part = packed.subarray(taken, taken + (1 << 12));
        taken += part.length;
        if (part.length > 0) controller.enqueue(new Uint8Array(part));
        else controller.close();
      },
    },
    { highWaterMark: 0 },
  );
  const reader = gunzip(stream, 'a.gz', () => taken).getReader();
  const parts: Uint8Array[] = [];
  let given = 0;
  for (;;) {
    const { done, value } = await reader.read();
    if (done) break;
    parts.push(value);
    given += value.length;
    // zlib, and the streams around it, hold some tens of kilobytes.
    expect(taken - given).toBeLessThan(1 << 18);
  }
  expect(Buffer.compare(Buffer.concat(parts), contents)).toBe(0);
});
