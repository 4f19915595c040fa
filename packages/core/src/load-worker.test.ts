import { afterEach, beforeEach, expect, test, vi } from 'vitest';
import { encodePly } from './io/formats/ply/write-ply.ts';
import type { LoadRequest } from './io/loading/serve-load.ts';
import type { RemoteRequest } from './io/remote.ts';
import { knownSource } from './io/sources/known-source.ts';
import { randomSplats } from './testing/random-splats.ts';

interface Port {
  onmessage: ((event: { data: LoadRequest | RemoteRequest }) => void) | null;
  readonly postMessage: (reply: { kind: string }) => void;
}

let replies: string[];
let port: Port;

beforeEach(async () => {
  replies = [];
  port = { onmessage: null, postMessage: ({ kind }) => replies.push(kind) };
  vi.stubGlobal('self', port);
  vi.resetModules();
  await import('./load-worker.ts');
});

afterEach(() => {
  vi.unstubAllGlobals();
});

test('the worker that pages host says that it runs, and reads file after file', async () => {
  expect(replies).toEqual(['ready']);
  const settings = {
    name: undefined,
    shPrecision: 'u8',
    geometryPrecision: 'packed',
  } as const;
  const source = knownSource(encodePly(randomSplats({ count: 20 })));
  for (let loads = 1; loads <= 2; loads++) {
    port.onmessage?.({ data: { kind: 'load', source, settings, rows: null } });
    await expect.poll(() => replies.filter((kind) => kind === 'cloud')).toHaveLength(loads);
  }
  expect(replies).not.toContain('error');
});

test('the worker that pages host makes a collider', async () => {
  const grid = { start: [0, 0, 0], size: [5, 5, 5], cellSize: 1 } as const;
  const plan = { grid, origin: [0, 0, 0], solidAt: 0.5, fewestTriangles: 0 };
  port.onmessage?.({ data: { task: 'begin', id: 1, input: { what: 'collider', plan } } });
  port.onmessage?.({ data: { task: 'finish', id: 2, input: undefined } });
  await expect.poll(() => replies).toEqual(['ready', 'ready', 'done', 'done']);
});

test('the worker that pages host frames a scene', async () => {
  const wishes = { aspect: 1, fovYDegrees: 50, up: null, usualUp: [0, -1, 0], kind: null };
  port.onmessage?.({
    data: { task: 'begin', id: 1, input: { what: 'framing', plan: { wishes, weight: 1 } } },
  });
  port.onmessage?.({ data: { task: 'finish', id: 2, input: undefined } });
  await expect.poll(() => replies).toEqual(['ready', 'ready', 'done', 'done']);
});

test('the worker that pages host does the tasks of a scene', async () => {
  const request = {
    task: 'decodeBrick',
    id: 1,
    input: {
      file: { name: 'a.bricks', splatCount: 300, shDegree: 0 },
      address: { number: 0, offset: 0, bytes: 300 },
      bytes: new Uint8Array(300),
    },
  } as const;
  port.onmessage?.({ data: request });
  await expect.poll(() => replies).toEqual(['ready', 'ready', 'error']);
});
