import { readFileSync } from 'node:fs';
import type { SplatSet } from '@websplatter/core';
import { writeSplats } from '@websplatter/core/write';
import { expect, test } from 'vitest';
import { gltfOfOneSplat, runMain, TestFolder, threeSplats } from './testing/test-folder.ts';

test('info describes a file', async () => {
  const scene = new TestFolder().scene();
  const { status, out, err } = await runMain('info', scene, '--json');
  expect([status, err]).toEqual([0, '']);
  expect(JSON.parse(out)).toMatchObject({
    scene,
    count: 3,
    bounds: { min: [-1, 0, 0], max: [1, 0, 0.5] },
    shDegree: 1,
    trueShDegree: 1,
    shBands: [{ band: 1, rms: 0.5, reach: expect.closeTo(0.75 / Math.sqrt(Math.PI), 9) }],
    droppedCount: 0,
    dropped: {},
    file: { format: 'ply', variant: 'binary_little_endian' },
    isAntialiased: null,
    gpuBytes: { reference: 3 * (64 + 36), high: 3 * (64 + 20), balanced: 3 * (32 + 12) },
  });
});

test('info tells the facts in the header of a file', async () => {
  const folder = new TestFolder();
  const scene = folder.scene('trained.ply', { ...threeSplats(), isAntialiased: true });
  const { out } = await runMain('info', scene);
  expect(out).toMatch(/^antialiased +yes, it was trained so$/m);
});

test('info tells the sort key of a glTF', async () => {
  const folder = new TestFolder();
  const infoOf = async (sortingMethod?: string) =>
    (await runMain('info', folder.write('splat.gltf', gltfOfOneSplat({ sortingMethod })))).out;
  expect(await infoOf()).toMatch(/^sorted by +distance from the camera$/m);
  expect(await infoOf('zDepth')).not.toMatch(/^sorted by/m);
});

/** @fault Files: neither first bytes nor URL give the format, as for a `.splat` from an API */
test('--from says what nothing in a scene tells, to every command', async () => {
  const folder = new TestFolder();
  const row = new Uint8Array(32).fill(128);
  new Float32Array(row.buffer, 0, 6).set([1, 2, 3, 0.1, 0.1, 0.1]);
  const scene = folder.write('scene.bin', row);
  const { out } = await runMain('info', scene, '--from', 'splat', '--json');
  expect(JSON.parse(out)).toMatchObject({ count: 1, file: { format: 'splat' } });
  expect((await runMain('convert', scene, folder.file('out.ply'), '--from', 'splat')).status).toBe(0);
  for (const args of [
    ['info', scene],
    ['convert', scene, folder.file('other.ply')],
  ]) {
    const { status, err } = await runMain(...args);
    expect([status, err]).toEqual([2, expect.stringContaining("format 'splat'")]);
  }
  const image = ['--camera', folder.camera(), '--size', '8x8', '--renderer', 'reference'];
  const drawn = await runMain('render', scene, ...image, '--out', folder.file('a.png'), '--from', 'splat');
  expect(drawn.status).toBe(0);
  const wrong = await runMain('info', scene, '--from', 'obj');
  expect([wrong.status, wrong.err]).toEqual([2, expect.stringContaining('--from is obj; it must be one of')]);
});

test('info counts rows that were left out, by reason', async () => {
  const set = threeSplats();
  set.positions[3] = Number.NaN;
  const { out } = await runMain('info', new TestFolder().scene('nan.ply', set), '--json');
  expect(JSON.parse(out)).toMatchObject({ count: 2, droppedCount: 1, dropped: { 'non-finite-position': 1 } });
});

test('without --json it is a table', async () => {
  const { status, out } = await runMain('info', new TestFolder().scene());
  expect(status).toBe(0);
  expect(out).toMatch(/^format +ply, binary_little_endian$/m);
  expect(out).not.toMatch(/^(?:note|antialiased)/m);
  expect(out).toMatch(/^splats +3$/m);
  expect(out).toMatch(/^SH degree +1$/m);
  expect(out).toMatch(/^SH band 1 +0\.500 rms, changes a colour by at most 0\.423$/m);
});

test('a palette of harmonics is told', async () => {
  const folder = new TestFolder();
  const sog = folder.write('three.sog', await writeSplats(threeSplats(), 'sog'));
  const { paletteEntries, gpuBytes } = JSON.parse((await runMain('info', sog, '--json')).out);
  expect(paletteEntries).toBeGreaterThan(0);
  // It is not drawn as one unless it is asked for.
  expect(gpuBytes).toMatchObject({ reference: 3 * (64 + 36), balanced: 3 * (32 + 12) });
  expect((await runMain('info', sog)).out).toMatch(
    new RegExp(`^SH palette +${paletteEntries} entries$`, 'm'),
  );
  expect((await runMain('info', folder.scene())).out).not.toContain('palette');
});

test('invisible bands are reported and take no memory', async () => {
  const set = threeSplats();
  const coefficients = new Float32Array(27).fill(1e-4, 0, 9);
  const scene = new TestFolder().scene('faint.ply', { ...set, harmonics: { degree: 1, coefficients } });
  const { out } = await runMain('info', scene, '--json');
  expect(JSON.parse(out)).toMatchObject({
    shDegree: 1,
    trueShDegree: 0,
    shBands: [{ band: 1, reach: expect.closeTo((0.75e-4 * 2) / Math.sqrt(Math.PI), 9) }],
    gpuBytes: { reference: 3 * 64, high: 3 * 64, balanced: 3 * 32 },
  });
  expect((await runMain('info', scene)).out).toMatch(/^SH degree +1, seen up to 0$/m);
});

/**
 * @fault Files: control characters in a file's name
 * @consequence shown as `·`
 */
test('codes that a terminal would obey in the name of a file are not repeated to it', async () => {
  const { out } = await runMain('info', new TestFolder().scene('a\u001b[31m.ply'));
  expect(out).toMatch(/^scene .*a·\[31m\.ply$/m);
});

test('built-in scenes have names', async () => {
  const { out } = await runMain('info', 'builtin:still-life-small', '--json');
  expect(JSON.parse(out).count).toBeGreaterThan(1000);
  const { status, err } = await runMain('info', 'builtin:garden');
  expect(status).toBe(2);
  expect(err).toMatch(/^websplatter: there is no scene builtin:garden; there are builtin:still-life/);
});

test.each([
  [['info', 'no-such.ply'], 'websplatter: no-such.ply: cannot be read: there is no such file or folder'],
  [['info', '.'], 'websplatter: .: it is a folder, not a file'],
  [['info', 'https://'], 'websplatter: https://: it is no valid address'],
  [['info', 'package.json'], 'websplatter: package.json: '],
  [['info'], 'websplatter: info needs one SCENE, found 0 (see websplatter --help)'],
  [['info', 'a', '--yaml'], "websplatter: Unknown option '--yaml' (see websplatter --help)"],
  [
    ['accuracy'],
    'websplatter: accuracy needs a SCENE: a file, a URL or builtin:still-life (see websplatter --help)',
  ],
  [['paint', 'a'], 'websplatter: there is no command paint (see websplatter --help)'],
  [['\u001b[31m\npaint'], 'websplatter: there is no command ·[31m paint (see websplatter --help)'],
  [[], 'websplatter: no command (see websplatter --help)'],
])('%j fails in one line with status 2', async (args, line) => {
  const { status, out, err } = await runMain(...args);
  expect([status, out]).toEqual([2, '']);
  expect(err).toMatch(/^[^\n]+\n$/);
  expect(err.startsWith(line), err).toBe(true);
});

test('a file that ends too early is named with the place', async () => {
  const folder = new TestFolder();
  const whole = readFileSync(folder.scene());
  const cut = folder.write('cut.ply', whole.subarray(0, whole.length - 10));
  const { status, err } = await runMain('info', cut);
  expect(status).toBe(2);
  expect(err).toMatch(/cut\.ply: .*\(.*(row|byte) \d+.*\)\n$/);
});

test('the step of positions is told, beside the size of splats', async () => {
  const folder = new TestFolder();
  const { out } = await runMain('info', folder.scene());
  expect(out).toMatch(/^position step +1\.2e-7, 6e-7 of the median size of splats, 0\.2$/m);
  const infoOf = async (set: SplatSet) =>
    JSON.parse((await runMain('info', folder.scene('far.ply', set), '--json')).out);
  const far = farSplats([5e5, 5.3e6, 700]);
  // With one failed point, which counts for nothing.
  far.positions.set([-5e5, -5.3e6, -700], 15);
  const wide = await infoOf(far);
  for (const [axis, value] of [5e5, 5.3e6, 700].entries())
    expect(Math.abs(wide.origin[axis] - value)).toBeLessThan(2);
  expect(wide.positionStep).toBeLessThan(2.4e-7);
  expect(wide.medianSize).toBeCloseTo(Math.exp(-3), 6);
  // Positions in float32 have no finer steps than the file, wherever their origin is.
  const rounded = farSplats([0, 0, 0]);
  for (let i = 0; i < rounded.positions.length; i++) rounded.positions[i] += [5e5, 5.3e6, 700][i % 3];
  const narrow = await infoOf(rounded);
  expect(narrow.origin[1]).toBeGreaterThan(5.2e6);
  expect(narrow.positionStep).toBe(0.5);
});

/** Forty flat splats within 2 m around a point. */
function farSplats(origin: SplatSet['origin']): SplatSet {
  const count = 40;
  return {
    ...{ count, origin, dropped: {} },
    positions: Float32Array.from({ length: 3 * count }, (_, i) => ((i * 7) % 11) / 6),
    logScales: Float32Array.from({ length: 3 * count }, (_, i) => (i % 3 === 2 ? -9 : -3)),
    rotations: Float32Array.from({ length: 4 * count }, (_, i) => Number(i % 4 === 0)),
    opacityLogits: new Float32Array(count),
    colorDc: new Float32Array(3 * count),
    harmonics: { degree: 0, coefficients: new Float32Array() },
    fileIndices: Uint32Array.from({ length: count }, (_, i) => i),
  };
}
