import type { SplatCloud } from '@websplatter/core';
import { splatsFromArrays } from '@websplatter/core/own-data';
import { openFrameWriter } from '@websplatter/core/write';
import { builtinScenes } from '@websplatter/scenes';
import { expect, it } from 'vitest';
import { lastingScene } from './lasting-scene.ts';
import { readAgain } from './read-again.ts';
import type { LoadedScene } from './shown-scene.ts';
import { cloudSources } from './stored-source.ts';

const [scene] = builtinScenes;
const file = { kind: 'file', name: 'a.ply', source: new File([], 'a.ply') } as const;
const url = new URL('https://example.org/a.ply');
const LOADED: LoadedScene = {
  clouds: [],
  firstView: null,
  ownCameras: null,
  about: null,
  isUpsideDown: false,
};
const hardCase = (name: string) => ({ source: { kind: 'hard-case', name } as const, loaded: LOADED });

it('a scene of one file can be read again where it is', async () => {
  for (const [source, stored] of [
    [
      { kind: 'builtin', scene },
      { kind: 'url', href: scene.url.href },
    ],
    [file, file],
    [
      { kind: 'url', url },
      { kind: 'url', href: url.href },
    ],
  ] as const) {
    const part = { source, loaded: LOADED };
    expect(lastingScene(part)).toEqual(stored);
    expect(await cloudSources(part)).toEqual([stored]);
  }
});

it('a file of frames is read again as the frame that is shown', async () => {
  const writer = await openFrameWriter();
  for (const x of [0, 1, 2])
    await writer.add(splatsFromArrays({ positions: [x, 0, 0], scales: [1, 1, 1], colors: [1, 1, 1] }));
  const parts: Uint8Array<ArrayBuffer>[] = [];
  await writer.finish(async (bytes) => void parts.push(bytes));
  const source = { kind: 'file', name: 'a.frames', source: new File(parts, 'a.frames') } as const;
  const facts = { fileFacts: { format: 'frames', frames: { count: 3, perS: 30, bytes: 0 } } };
  const clouds = [{ cloud: { facts } as unknown as SplatCloud }];
  const placesOf = async (frame?: number) => {
    const [stored] = await cloudSources({ source, loaded: { ...LOADED, clouds, frame } });
    const { origin, positions } = await readAgain(stored, () => {});
    return origin[0] + positions[0];
  };
  expect([await placesOf(), await placesOf(1), await placesOf(2)]).toEqual([0, 1, 2]);
});

it('a hard case is made again, from its file or its splats', async () => {
  const [made] = await cloudSources(hardCase('camera-inside-a-splat'));
  expect(made.kind).toBe('set');
  expect((await readAgain(made, () => {})).count).toBeGreaterThan(0);
  const [refused] = await cloudSources(hardCase('input-truncated'));
  expect(refused.kind).toBe('bytes');
  await expect(readAgain(refused, () => {})).rejects.toThrow();
});
