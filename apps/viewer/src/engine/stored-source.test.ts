import { builtinScenes } from '@websplatter/scenes';
import { expect, it } from 'vitest';
import { lastingScene } from './lasting-scene.ts';
import { readAgain } from './read-again.ts';
import { cloudSources } from './stored-source.ts';

const [scene] = builtinScenes;
const file = { kind: 'file', name: 'a.ply', source: new File([], 'a.ply') } as const;
const url = new URL('https://example.org/a.ply');

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
    expect(lastingScene(source)).toEqual(stored);
    expect(await cloudSources(source)).toEqual([stored]);
  }
});

it('a hard case is made again, from its file or its splats', async () => {
  const [made] = await cloudSources({ kind: 'hard-case', name: 'camera-inside-a-splat' });
  expect(made.kind).toBe('set');
  expect((await readAgain(made, () => {})).count).toBeGreaterThan(0);
  const [refused] = await cloudSources({ kind: 'hard-case', name: 'input-truncated' });
  expect(refused.kind).toBe('bytes');
  await expect(readAgain(refused, () => {})).rejects.toThrow();
});
