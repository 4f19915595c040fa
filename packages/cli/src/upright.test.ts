import { readFileSync } from 'node:fs';
import { readSplats, type SceneFraming } from '@websplatter/core';
import { SplatFramer } from '@websplatter/core/write';
import { expect, test, vi } from 'vitest';
import { runMain, TestFolder, threeSplats } from './testing/test-folder.ts';

const SCENE = 'builtin:still-life-small';

const UNSURE: SceneFraming = {
  kind: 'object',
  position: [0, 0, 5],
  target: [0, 0, 0],
  up: [0, -1, 0],
  fovYDegrees: 50,
  center: [0, 0, 0],
  radius: 1,
  groundHeight: null,
  confidence: { up: 0.3, kind: 1 },
};

/** Centres of the first splats of a file. */
async function centersOf(path: string): Promise<number[]> {
  const { positions, origin } = await readSplats(readFileSync(path));
  return Array.from(positions.subarray(0, 300), (value, i) => value + origin[i % 3]);
}

test.each([
  ['-y', [180, 0, 0]],
  ['z', [90, 0, 0]],
  ['y', [0, 0, 0]],
  ['x', [0, 0, -90]],
] as const)(
  'convert --up auto finds that %s is up, and turns it to +y as --up does',
  async (axis, angles) => {
    const folder = new TestFolder();
    const [turned, found, named] = ['turned.ply', 'found.ply', 'named.ply'].map((name) => folder.file(name));
    await runMain('convert', SCENE, turned, '--sh', '0', '--rotate', angles.join(','));
    const { status, out, err } = await runMain('convert', turned, found, '--up', 'auto', '--json');
    expect(status, err).toBe(0);
    const { foundUp, notes } = JSON.parse(out);
    expect(foundUp.confidence).toBeGreaterThan(0.5);
    expect(notes).toContainEqual(expect.stringMatching(`^${axis} was found to be up \\(confidence `));
    expect((await runMain('convert', turned, named, '--up', axis)).status).toBe(0);
    expect(readFileSync(found)).toEqual(readFileSync(named));
  },
);

test('what stands askew is turned the shortest way, before other turns', async () => {
  const folder = new TestFolder();
  const [still, askew, upright, level] = ['still.ply', 'askew.ply', 'upright.ply', 'level.ply'].map((name) =>
    folder.file(name),
  );
  await runMain('convert', SCENE, still, '--sh', '0');
  // About x alone, so that the shortest way leads back.
  await runMain('convert', SCENE, askew, '--sh', '0', '--rotate', '200,0,0');
  const { err } = await runMain('convert', askew, upright, '--up', 'auto', '--scale', '2');
  expect(err).toMatch(/note: 0,-0\.9\d+,-0\.3\d+ was found to be up/);
  const [expected, centers] = [await centersOf(still), await centersOf(upright)];
  for (const [i, value] of centers.entries())
    expect(Math.abs(value - 2 * expected[i])).toBeLessThan(
      0.02 * Math.hypot(...expected.slice(3 * Math.floor(i / 3), 3 * Math.floor(i / 3) + 3)) * 2 + 1e-3,
    );
  // Other turns come after that.
  expect((await runMain('convert', askew, level, '--up', 'auto', '--rotate', '0,90,0')).status).toBe(0);
  const [, y] = await centersOf(level);
  expect(y).toBeCloseTo(centers[1] / 2, 4);
});

test('what is uncertain is said, and what shows nothing is left as it is', async () => {
  const folder = new TestFolder();
  const out = folder.file('out.ply');
  const found = vi.spyOn(SplatFramer.prototype, 'frame');
  found.mockReturnValueOnce(UNSURE);
  const unsure = await runMain('convert', folder.scene(), out, '--up', 'auto');
  expect(unsure.err).toMatch(
    /^note: it is uncertain which way is up: -y was taken \(confidence 0\.30 of 1\); --up with x, y, z/m,
  );
  const hidden = { ...threeSplats(), opacityLogits: new Float32Array(3).fill(Number.NEGATIVE_INFINITY) };
  const nothing = await runMain('convert', folder.scene('hidden.ply', hidden), out, '--up', 'auto', '--json');
  const { foundUp, notes } = JSON.parse(nothing.out);
  expect(foundUp).toBeUndefined();
  expect(notes).toEqual([expect.stringContaining('nothing was turned upright')]);
  expect(await centersOf(out)).toEqual([-1, 0, 0, 0, 0, 0.5, 1, 0, 0]);
});

test('scenes of any size are read once more for it, which standard input does not allow', async () => {
  const out = new TestFolder().file('out.bricks');
  const { status, err } = await runMain('convert', '-', out, '--up', 'auto');
  expect([status, err]).toEqual([2, expect.stringContaining('name the axis: --up=-y')]);
});
