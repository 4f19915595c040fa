import { expect, test, vi } from 'vitest';
import { makeRayTree } from './clouds/rays/rays.ts';
import { CodeUnavailableError } from './data/errors.ts';
import { packCloud } from './data/packing/packed-cloud.ts';
import { openBrickWriter, openFrameWriter, runBrickTask, sogImageAddresses } from './io/formats/writers.ts';
import { readSplatPieces, readSplats } from './io/loading/read-splats.ts';
import { randomSplats } from './testing/random-splats.ts';

function offline(): never {
  throw new TypeError('offline');
}

vi.mock('./clouds/rays/make-ray-tree.ts', offline);
vi.mock('./io/formats/bricks/brick-tasks.ts', offline);
vi.mock('./io/formats/bricks/brick-writer.ts', offline);
vi.mock('./io/formats/frames/frame-writer.ts', offline);
vi.mock('./io/formats/sog/image-addresses.ts', offline);
vi.mock('./io/loading/read-source.ts', offline);

/**
 * @fault Pages and packages: code that a function needs cannot be fetched
 * @consequence the function rejects with `CodeUnavailableError`
 */
test.each([
  ['makeRayTree', () => makeRayTree(packCloud(randomSplats({ count: 1 }), { geometryPrecision: 'packed' }))],
  ['openBrickWriter', () => openBrickWriter()],
  ['openFrameWriter', () => openFrameWriter({ framesPerS: 24 })],
  ['runBrickTask', () => runBrickTask({} as never)],
  ['sogImageAddresses', () => sogImageAddresses(new Uint8Array(2), 'https://a.test/meta.json')],
  ['readSplats', () => readSplats(new Blob([]))],
  ['readSplatPieces', () => readSplatPieces(new Blob([]), {}, async () => {})],
])('%s says that its code is lost', async (_, call) => {
  await expect(call()).rejects.toThrow(CodeUnavailableError);
});
