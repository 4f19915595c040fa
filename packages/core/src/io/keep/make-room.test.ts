import { expect, test } from 'vitest';
import type { KeptScene } from './kept-scenes.ts';
import { makeRoom } from './serve-keep.ts';

/** Storage of 160 bytes with scenes of these bytes, the one asked for last first. */
function storageWith(...sizes: readonly number[]) {
  let scenes = sizes.map(
    (bytes, i): KeptScene => ({ key: `${i}`, fileName: `${i}.ply`, bytes, isWhole: true, usedMs: -i }),
  );
  return {
    scenes: () => scenes.map(({ key }) => key),
    make: (neededBytes: number) =>
      makeRoom(
        neededBytes,
        scenes,
        {
          hasRoom: async (bytes) => scenes.reduce((sum, scene) => sum + scene.bytes, bytes) <= 160,
          remove: async (scene) => {
            scenes = scenes.filter((each) => each !== scene);
          },
        },
        'big.ply',
      ),
  };
}

test('scenes stay where there is room', async () => {
  const { make, scenes } = storageWith(50, 50);
  await make(60);
  expect(scenes()).toEqual(['0', '1']);
});

test('those go that have waited longest, and no more than must', async () => {
  const { make, scenes } = storageWith(50, 40, 30, 20);
  await make(65);
  expect(scenes()).toEqual(['0', '1']);
});

test('none goes where that would not help, and the error says how much is needed and found', async () => {
  const { make, scenes } = storageWith(50, 50);
  await expect(make(320)).rejects.toMatchObject({
    code: 'no-room',
    neededBytes: 320,
    availableBytes: 160,
    message: expect.stringMatching(/^big\.ply: .* needs 1 MB .* has 1 MB left/),
  });
  expect(scenes()).toEqual(['0', '1']);
});
