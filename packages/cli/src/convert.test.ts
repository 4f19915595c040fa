import { existsSync, linkSync, mkdirSync, readdirSync, readFileSync } from 'node:fs';
import { type Harmonics, readCoefficients, readSplats, type SplatSet } from '@websplatter/core';
import { gradeSplats, WRITABLE_FORMATS } from '@websplatter/core/write';
import { expect, test } from 'vitest';
import { gltfOfOneSplat, runMain, TestFolder, threeSplats } from './testing/test-folder.ts';

const read = (path: string) => readSplats(readFileSync(path), { name: path, shPrecision: 'f32' });

/** Centres in the scene's space, sorted by x: formats may have an order of their own. */
function centersOf({ positions, origin, count }: SplatSet<Harmonics>): number[][] {
  const centers = Array.from({ length: count }, (_, i) =>
    origin.map((value, axis) => value + positions[3 * i + axis] + 0),
  );
  return centers.sort((a, b) => a[0] - b[0]);
}

test.each(WRITABLE_FORMATS)('a PLY becomes $name and comes back', async ({ name, extension }) => {
  const folder = new TestFolder();
  const [out, back] = [folder.file(`a${extension}`), folder.file('back.ply')];
  const first = await runMain('convert', folder.scene(), out);
  expect(first.status, first.err).toBe(0);
  expect(first.out).toMatch(/a\.\S+: 3 splats, [\d,]+ bytes \(\d+\.\d % of what was read\), \d+\.\d s\n$/);
  expect((await read(out)).fileFacts?.format).toBe(name);
  expect((await runMain('convert', out, back)).status).toBe(0);
  const [set, original] = [await read(back), threeSplats()];
  for (const [i, center] of centersOf(original).entries())
    for (const axis of [0, 1, 2]) expect(centersOf(set)[i][axis]).toBeCloseTo(center[axis], 3);
  expect(set.harmonics.degree).toBe(1);
  for (const [i, value] of original.logScales.entries())
    expect(Math.abs(set.logScales[i] - value)).toBeLessThanOrEqual(1 / 32);
  // All coefficients of all splats are alike; SPZ has the coarsest steps.
  const row = new Float32Array(9);
  readCoefficients(set.harmonics, 2, row);
  for (const value of row) expect(Math.abs(value - 0.5)).toBeLessThanOrEqual(4 / 128);
});

test('--json reports the work; progress goes to standard error', async () => {
  const folder = new TestFolder();
  const [scene, out] = [folder.scene(), folder.file('b.bin')];
  const { status, out: printed, err } = await runMain('convert', scene, out, '--format', 'spz', '--json');
  expect(status).toBe(0);
  const bytes = readFileSync(out).length;
  expect(JSON.parse(printed)).toEqual({
    ...{ scenes: [scene], out, format: 'spz', splats: 3, shDegree: 1, bytes, notes: [] },
    inputBytes: readFileSync(scene).length,
    elapsedMs: expect.any(Number),
  });
  expect(err).toMatch(
    /^(\d+ %: reading \S+scene\.ply\n)+(\d+ %: writing \S+b\.bin\n)*100 %: writing \S+b\.bin\n$/,
  );
});

/**
 * @fault Files: parts of a scene, of a glTF or of scenes that `convert --merge` joins lie too far apart
 *   for float32 about any one origin
 */
test('scenes that lie too far apart to be one are told of', async () => {
  const folder = new TestFolder();
  const sceneAt = (name: string, origin: SplatSet['origin']) =>
    folder.scene(name, { ...threeSplats(), origin });
  const [one, near, far] = [
    sceneAt('one.ply', [500_000.123, 5_300_000.456, 700]),
    sceneAt('near.ply', [500_020.789, 5_300_000.456, 700]),
    sceneAt('far.ply', [-4_000_000.321, 100, 7_700_000.654]),
  ];
  const notesOf = async (second: string) => {
    const { out } = await runMain('convert', one, second, folder.file('both.ply'), '--merge', '--json');
    return JSON.parse(out).notes;
  };
  expect(await notesOf(near)).toEqual([]);
  expect(await notesOf(far)).toEqual([
    expect.stringMatching(/^the scenes lie too far apart for float32: together, .* in steps of 0\.5, /),
  ]);
});

test('several scenes are merged, moved, cropped and simplified, in this order', async () => {
  const folder = new TestFolder();
  const out = folder.file('out.ply');
  const second = folder.scene('second.ply', { ...threeSplats(), origin: [10, 0, 0] });
  const { status, err } = await runMain(
    ...[
      'convert',
      folder.scene(),
      second,
      out,
      '--merge',
      '--up',
      '-y',
      '--scale',
      '2',
      '--rotate',
      '0,0,-90',
    ],
    // As they are: x of -1, 0, 1, 9, 10, 11, of which 0 and 10 have z = 0.5.
    ...['--translate', '-5,-1,0', '--crop', '-9,-23,-2,0,-1,1', '--sh', '0'],
  );
  expect(status, err).toBe(0);
  const set = await read(out);
  expect(set.harmonics.degree).toBe(0);
  // Half a turn about x; twice as large; x becomes -y; shifted; y = 1, of x = -1, is cropped away.
  const expected = [0, 1, 9, 10, 11].map((x) => [-5, -2 * x - 1, x % 10 === 0 ? -1 : 0]);
  const found = centersOf(set).sort((a, b) => b[1] - a[1]);
  expect(found).toEqual(expected);
});

/**
 * @fault Files: a format rounds positions, sizes, colours or harmonics visibly: a stray in the same chunk,
 *   a tiny scene, bright colours
 */
test('what the format does not keep is told, with a figure and what to do', async () => {
  const folder = new TestFolder();
  const set = threeSplats();
  const positions = set.positions.map((value) => value + 0.1);
  const scene = folder.scene('far.ply', { ...set, positions, origin: [500_000, 5_300_000, 700] });
  const sog = await runMain('convert', scene, folder.file('far.sog'));
  expect(sog.status).toBe(0);
  expect(sog.err).toMatch(
    /^note: other readers of SOG place \d of 3 splats in steps of 0\.5, .* Move the scene to 0, or write PLY or glTF$/m,
  );
  const { err } = await runMain('convert', scene, folder.file('far.bricks'));
  expect(err).not.toContain('steps');
  const tiny = await runMain('convert', folder.scene(), folder.file('tiny.spz'), '--scale', '1e-5', '--json');
  expect(JSON.parse(tiny.out).notes).toEqual([
    expect.stringMatching(
      /^SPZ places 3 of 3 splats in steps of up to 0\.00024; the splats' median size is 0\.000002\. /,
    ),
    expect.stringMatching(/^SPZ changes the sizes of 3 of 3 splats, by a factor of up to 23\. /),
  ]);
});

test('a grade is written into the colours', async () => {
  const folder = new TestFolder();
  const out = folder.file('graded.ply');
  const grade = { exposure: 1, saturation: 0.5, temperature: -0.2, tint: 0.1 };
  const options = Object.entries(grade).map(([name, value]) => `--${name}=${value}`);
  const { status, err } = await runMain('convert', folder.scene(), out, ...options);
  expect(status, err).toBe(0);
  const expected = gradeSplats(threeSplats(), grade);
  const found = await read(out);
  expect(found.colorDc).toEqual(expected.colorDc);
  const [row, expectedRow] = [new Float32Array(9), new Float32Array(9)];
  readCoefficients(found.harmonics, 1, row);
  readCoefficients(expected.harmonics, 1, expectedRow);
  expect(row).toEqual(expectedRow);
});

test('notes tell surprises', async () => {
  const folder = new TestFolder();
  const set = { ...threeSplats(), isAntialiased: true };
  set.positions[0] = Number.NaN;
  const scene = folder.scene('trained.ply', set);
  const notesOf = async (...args: string[]) => {
    const { out } = await runMain('convert', ...args, '--json');
    return JSON.parse(out).notes;
  };
  const glb = folder.file('a.glb');
  expect(await notesOf(scene, glb)).toEqual([
    expect.stringMatching(/^1 rows of \S+trained\.ply are no splats/),
    expect.stringContaining('antialias filter'),
    expect.stringContaining('--up=-y'),
  ]);
  // Of two scenes, one says that it was trained so.
  const both = [scene, folder.scene('other.ply'), folder.file('both.ply'), '--merge'];
  expect(await notesOf(...both)).toContainEqual(expect.stringContaining('antialias filter'));
  const far = folder.write('far.gltf', gltfOfOneSplat({}));
  const order = expect.stringContaining('sorted by their distances');
  const axes = expect.stringContaining('--up=-y');
  expect(await notesOf(far, folder.file('back.spz'))).toEqual([order, axes]);
  expect(await notesOf(far, folder.file('turned.spz'), '--up=-y')).toEqual([order]);
  expect(await notesOf(far, folder.file('same.glb'))).toEqual([]);
  expect(await notesOf(far, far, folder.file('merged.glb'), '--merge')).toEqual([order]);
  // A PLY is sorted by depths, and so is the .glb made of it.
  expect(await notesOf(glb, folder.file('back.ply'), '--up=-y')).toEqual([]);
  // Notes of the reader are repeated.
  const more = folder.write('more.gltf', gltfOfOneSplat({ sortingMethod: 'zDepth' }, [{ attributes: {} }]));
  const about = expect.stringContaining('more.gltf: 1 other primitive');
  expect(await notesOf(more, folder.file('more.ply'), '--up=-y')).toEqual([about]);
  expect(await notesOf('builtin:still-life-small', folder.file('made.glb'), '--sh', '0')).toEqual([]);
});

/**
 * @fault Command line: an output is a part of the input scene
 * @consequence one line that names it, exit status 2; nothing is written
 */
test('an input is not overwritten by any of its names, nor is a part of a scene', async () => {
  const folder = new TestFolder();
  const scene = folder.scene();
  linkSync(scene, folder.file('linked.ply'));
  mkdirSync(folder.file('parts'));
  const gltf = folder.write('parts/scene.gltf', {
    ...gltfOfOneSplat(),
    buffers: [{ byteLength: 16, uri: 'ones.bin' }],
  });
  const pairs = [
    [scene, folder.file('linked.ply')],
    [gltf, folder.write('parts/ones.bin', new Uint8Array(new Float32Array(4).fill(1).buffer))],
    [folder.file('parts'), gltf],
  ];
  for (const [from, to] of pairs) {
    const before = readFileSync(to);
    const { status, err } = await runMain('convert', from, to, '--format', 'ply');
    expect([status, err]).toEqual([2, expect.stringContaining(`OUT is ${to}, which is read too`)]);
    expect(readFileSync(to)).toEqual(before);
  }
  // A file in a scene's folder that is no part of the scene is replaced.
  const beside = folder.write('parts/beside.ply', 'old');
  expect((await runMain('convert', folder.file('parts'), beside)).status).toBe(0);
  expect((await read(beside)).count).toBe(1);
});

/**
 * @fault Command line: an option with a negative number, or an axis with a minus
 * @consequence taken as its value, as after =; one that may not be negative is named with what it must be
 */
test('negative values follow their options, with and without =', async () => {
  const folder = new TestFolder();
  const scene = folder.scene();
  const written = async (...args: string[]) => {
    const { status, err } = await runMain('convert', scene, folder.file('out.ply'), ...args);
    return status === 0 ? [...readFileSync(folder.file('out.ply'))] : err;
  };
  for (const [option, value] of [
    ['--exposure', '-2'],
    ['--temperature', '-0.5'],
    ['--tint', '-.4'],
    ['--up', '-z'],
    ['--translate', '-1,0,-2'],
    ['--rotate', '-90,0,0'],
    ['--crop', '-9,-9,-9,9,9,9'],
    ['--time', '-1'],
  ]) {
    const apart = await written(option, value);
    expect(apart, option).toBeInstanceOf(Array);
    expect(apart, option).toEqual(await written(`${option}=${value}`));
  }
  for (const [option, value, expected] of [
    ['--saturation', '-1', '--saturation is -1; it must be a number, 0 to 4'],
    ['--sh', '-1', '--sh is -1; it must be 0, 1, 2 or 3'],
    ['--fps', '-1', '--fps is -1; it must be 0.001 to 1000'],
    ['--exposure', '-11', '--exposure is -11; it must be a number, -10 to 10'],
    ['--format', '-y', '--format is -y; it must be one of'],
  ])
    expect(await written(option, value), option).toContain(expected);
  expect(await written('--temp', '--json')).toMatch(
    /'--temp' argument is ambiguous\. .* '--temp=-XYZ' \(see/,
  );
  expect(await written('-1.ply')).toMatch(/Unknown option '-1'\. .* after '--'/);
});

test('a note says by which places moving splats were cropped', async () => {
  const folder = new TestFolder();
  const set = threeSplats();
  // At time 0.5 each splat is at its place; a unit of time later it is one unit farther along x.
  const moving = {
    ...set,
    motion: Float32Array.from({ length: 15 * set.count }, (_, i) => [0.5, 3, 1][i % 15] ?? 0),
  };
  const scene = folder.scene('moving.ply', moving);
  const out = folder.file('out.ply');
  const crop = async (...more: string[]) => {
    const { out: printed } = await runMain(
      ...['convert', scene, out, '--crop', '-1.5,-9,-9,-0.5,9,9', '--json'],
      ...more,
    );
    const { splats, notes } = JSON.parse(printed);
    return { splats, isTold: String(notes).includes('places at their own times') };
  };
  expect(await crop()).toEqual({ splats: 1, isTold: true });
  // At that time, the first splat is where the second was.
  expect(await crop('--time', '-0.5')).toEqual({ splats: 1, isTold: false });
});

/**
 * @fault Command line: a conversion that fails: options, a file, splats that the format cannot hold
 * @consequence one line, exit status 2, no file
 */
test('bad input gives one line, status 2 and no file', async () => {
  const folder = new TestFolder();
  const scene = folder.scene();
  const out = folder.file('out.ply');
  const cases: [string[], string][] = [
    [[], 'convert needs an IN and an OUT, found 0'],
    [[scene], 'convert needs an IN and an OUT, found 1'],
    [[scene, scene, out], '2 scenes become one OUT only with --merge'],
    [[scene, folder.file('out.ksplat')], 'it must end with one of .ply, .compressed.ply'],
    [[scene, out, '--format', 'ksplat'], '--format is ksplat; it must be one of ply,'],
    [[scene, scene], 'which is read too'],
    [[scene, out, '--sh', '4'], '--sh is 4; it must be 0, 1, 2 or 3'],
    [[scene, out, '--saturation', '5'], '--saturation is 5; it must be a number, 0 to 4'],
    [[scene, out, '--up', 'w'], '--up is w; it must be auto or one of x, -x, y'],
    [[scene, out, '--scale', '-1'], '--scale is -1; it must be a number above 0'],
    [[scene, out, '--rotate', '1,2'], '--rotate is 1,2; it must be x,y,z'],
    [[scene, out, '--translate', '-1,,2'], '--translate is -1,,2; it must be x,y,z'],
    [[scene, out, '--crop', '0,0,0,1,1'], '--crop is 0,0,0,1,1; it must be minX'],
    [[scene, out, '--crop', '5,5,5,6,6,6'], 'None of 3 splats is between 5, 5, 5 and 6, 6, 6'],
    [[scene, out, '--crop', '5,5,5,4,6,6'], 'The least x of the box, 5, is above the greatest, 4'],
    [[folder.write('text.ply', 'hello'), out], 'text.ply: '],
    [[scene, folder.file('no/out.ply')], 'cannot be written'],
    [[scene, folder.file('far.spz'), '--translate', '5000,0,0'], 'Splat 0 has x = 4999'],
  ];
  for (const [args, message] of cases) {
    const { status, out: printed, err } = await runMain('convert', ...args);
    expect([status, printed], message).toEqual([2, '']);
    expect(err).toContain(message);
    expect(err).toMatch(/^(\d+ %: [^\n]+\n)*websplatter: [^\n]+\n$/);
  }
  expect(readdirSync(folder.path).sort()).toEqual(['scene.ply', 'text.ply']);
  expect(existsSync(out)).toBe(false);
});
