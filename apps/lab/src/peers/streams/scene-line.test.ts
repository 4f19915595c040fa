import { mkdtemp, rm, writeFile } from 'node:fs/promises';
import { createServer, type Server } from 'node:http';
import type { AddressInfo } from 'node:net';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { afterEach, beforeEach, expect, test } from 'vitest';
import { SceneLine } from './scene-line.ts';

let folder: string;
let server: Server;
beforeEach(async () => {
  folder = await mkdtemp(join(tmpdir(), 'websplatter-line-'));
  await writeFile(join(folder, 'scene.rad'), Buffer.alloc(200_000, 'abcd'));
});
afterEach(async () => {
  server.close();
  await rm(folder, { recursive: true });
});

async function serve(line: SceneLine): Promise<string> {
  server = createServer((request, response) => line.answer(join(folder, request.url!), request, response));
  await new Promise<void>((resolve) => server.listen(0, '127.0.0.1', resolve));
  return `http://127.0.0.1:${(server.address() as AddressInfo).port}/`;
}

test('files are sent as a whole and by ranges, and their bytes counted', async () => {
  const line = new SceneLine({ bitsPerSecond: Number.POSITIVE_INFINITY, latencyMs: 0 });
  const url = `${await serve(line)}scene.rad`;
  const ask = async (range?: string) => {
    const response = await fetch(url, { headers: range ? { range } : {} });
    return [response.status, response.headers.get('content-range'), (await response.text()).length];
  };
  expect(await ask()).toEqual([200, null, 200_000]);
  expect(await ask('bytes=4-6')).toEqual([206, 'bytes 4-6/200000', 3]);
  expect(await ask('bytes=199999-')).toEqual([206, 'bytes 199999-199999/200000', 1]);
  expect(await ask('bytes=-5')).toEqual([206, 'bytes 199995-199999/200000', 5]);
  expect(await ask('bytes=100000-900000')).toEqual([206, 'bytes 100000-199999/200000', 100_000]);
  expect(await ask('bytes=200000-')).toEqual([416, 'bytes */200000', 0]);
  expect(line.bytesUntil()).toBe(300_009);
  expect(line.bytesUntil(0)).toBe(0);
  expect(line.requests).toBe(6);
  line.restart();
  expect([line.bytesUntil(), line.requests]).toEqual([0, 0]);
  expect((await fetch(`${url}x`)).status).toBe(404);
});

test('all answers share the rate of the line', async () => {
  const line = new SceneLine({ bitsPerSecond: 64e6, latencyMs: 20 });
  const url = `${await serve(line)}scene.rad`;
  const startedMs = performance.now();
  await Promise.all([fetch(url), fetch(url)].map(async (answer) => (await answer).arrayBuffer()));
  // 3.2 Mbit at 64 Mbit/s.
  expect(performance.now() - startedMs).toBeGreaterThan(50 + 20 - 5);
});
