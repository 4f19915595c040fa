import { existsSync, readdirSync, readFileSync } from 'node:fs';
import { decode } from 'fast-png';
import jpeg from 'jpeg-js';
import { expect, test } from 'vitest';
import { runMain, TestFolder, threeSplats } from './testing/test-folder.ts';

const SIZE = ['--size', '48x32'];
const REFERENCE = ['--renderer', 'reference'];

function readRaw(path: string): Float32Array {
  return new Float32Array(readFileSync(path).buffer.slice(0));
}

/** Index of a pixel's red in an RGBA image 48 pixels wide. */
const at = (x: number, y: number) => 4 * (48 * y + x);

test('the reference renderer writes an image, raw pixels and timings that agree', async () => {
  const folder = new TestFolder();
  const [png, raw, timings] = ['a.png', 'a.f32', 't.json'].map((name) => folder.file(name));
  const outputs = [
    '--out',
    png,
    '--raw',
    raw,
    '--timings',
    timings,
    '--frames',
    '2',
    '--background',
    '0,0,1',
  ];
  const { status, out, err } = await runMain(
    ...['render', folder.scene(), '--camera', folder.camera(), ...SIZE, ...REFERENCE, ...outputs],
  );
  expect([status, err]).toEqual([0, '']);
  expect(out).toContain('48×32, 3 of 3 splats');

  const pixels = readRaw(raw);
  expect(pixels.length).toBe(48 * 32 * 4);
  const image = decode(readFileSync(png));
  expect([image.width, image.height]).toEqual([48, 32]);
  for (let i = 0; i < 48 * 32; i++) {
    const blue = pixels[4 * i + 2] + (1 - pixels[4 * i + 3]);
    expect(Math.abs(image.data[3 * i + 2] - 255 * Math.min(1, blue))).toBeLessThanOrEqual(0.5001);
  }
  // x = −1 (red) is left of the centre (green).
  const red = pixels.subarray(at(17, 16), at(18, 16));
  expect(red[0]).toBeGreaterThan(red[1]);
  expect(pixels[at(24, 16) + 1]).toBeGreaterThan(pixels[at(24, 16)]);

  expect(JSON.parse(readFileSync(timings, 'utf8'))).toMatchObject({
    source: 'wall-clock',
    stages: { preprocessMs: null, totalMs: { median: expect.any(Number), p99: expect.any(Number) } },
    rasterizer: null,
    frames: 2,
    framesIdentical: true,
    scenes: [{ splats: 3 }],
    widthPx: 48,
    renderer: 'reference',
    machine: { node: process.versions.node },
  });
});

test('a poster is the same picture as JPEG or PNG, and the JSX that begins with its view is printed', async () => {
  const folder = new TestFolder();
  const [png, poster, posterPng] = ['a.png', 'my poster.JPG', 'b.png'].map((name) => folder.file(name));
  const inputs = ['render', folder.scene(), '--camera', folder.camera(), ...SIZE, ...REFERENCE];
  const background = ['--background', '1,0.5,0'];
  const { status, out } = await runMain(...inputs, ...background, '--out', png, '--poster', poster);
  expect(status).toBe(0);
  expect(out.split('\n')[1]).toBe(
    `<SplatCanvas poster="/my%20poster.JPG" camera={{ position: [0, 0, 4], rotation: [0, 0, 0], fov: 60, near: 0.01, far: 1000 }} style={{ background: 'rgb(255 128 0)' }} flat>`,
  );
  const exact = decode(readFileSync(png));
  const image = jpeg.decode(readFileSync(poster), { useTArray: true });
  expect([image.width, image.height]).toEqual([48, 32]);
  const errors = Array.from(exact.data, (value, i) =>
    Math.abs(value - image.data[4 * Math.floor(i / 3) + (i % 3)]),
  );
  expect(errors.reduce((sum, error) => sum + error, 0) / errors.length).toBeLessThan(4);
  expect(await runMain(...inputs, ...background, '--poster', posterPng)).toMatchObject({ status: 0 });
  expect(readFileSync(posterPng)).toEqual(readFileSync(png));
});

test('model matrices move scenes, in order', async () => {
  const folder = new TestFolder();
  const moved = (x: number, y: number) => [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, x, y, 0, 1];
  const models = [folder.write('m0.json', moved(0, 1)), folder.write('m1.json', { matrix: moved(0, -1) })];
  const raw = folder.file('a.f32');
  const scene = folder.scene();
  const { status } = await runMain(
    ...['render', scene, scene, '--model', models[0], '--model', models[1]],
    ...['--camera', folder.camera(), ...SIZE, ...REFERENCE, '--raw', raw],
  );
  expect(status).toBe(0);
  const pixels = readRaw(raw);
  const alphas = [9, 16, 23].map((y) => pixels[at(24, y) + 3]);
  expect(alphas[0]).toBeGreaterThan(0.5);
  expect(alphas[1]).toBeLessThan(0.1);
  expect(alphas[2]).toBeGreaterThan(0.5);
});

test('bad input gives one line, status 2 and no file', async () => {
  const folder = new TestFolder();
  const out = folder.file('a.png');
  const scene = folder.scene();
  const camera = folder.camera();
  const flat = folder.camera('flat.json', { projection: 'orthographic', height: 3 });
  const cases = [
    [scene, '--camera', folder.write('broken.json', '{'), ...SIZE, '--out', out],
    [scene, '--camera', folder.camera('wide.json', { fovYDegrees: 180 }), ...SIZE, '--out', out],
    [scene, '--camera', camera, '--model', folder.write('m.json', [1]), ...SIZE, '--out', out],
    [folder.write('text.ply', 'hello'), '--camera', camera, ...SIZE, ...REFERENCE, '--out', out],
    [folder.file('none.ply'), '--camera', camera, ...SIZE, '--out', out],
    [scene, '--camera', camera, ...SIZE, ...REFERENCE, '--out', out, '--raw', folder.file('no/a.f32')],
    [scene, '--camera', camera, ...SIZE, ...REFERENCE, '--out', out, '--poster', folder.file('no/a.jpg')],
    [scene, '--camera', flat, ...SIZE, ...REFERENCE, '--out', out, '--poster', folder.file('a.jpg')],
  ];
  for (const args of cases) {
    const { status, out: printed, err } = await runMain('render', ...args);
    expect([status, printed]).toEqual([2, '']);
    expect(err).toMatch(/^websplatter: [^\n]+: [^\n]+\n$/);
    expect(existsSync(out)).toBe(false);
  }
  expect(readdirSync(folder.path).filter((name) => name.startsWith('.'))).toEqual([]);
});

test('splats are sorted as asked for', async () => {
  const folder = new TestFolder();
  const set = { ...threeSplats(), logScales: new Float32Array(9).fill(0) };
  // Red, on the left, is less deep than the others, and farther.
  set.positions.set([-2.5, 0, 1, 0, 0, 0.8, 0, 0, 0.8]);
  const scene = folder.scene('crossing.ply', set);
  const redOf = async (sortBy: string) => {
    const raw = folder.file(`${sortBy}.f32`);
    const command = ['render', scene, '--camera', folder.camera(), ...SIZE, ...REFERENCE];
    expect((await runMain(...command, '--raw', raw, '--sort-by', sortBy)).status).toBe(0);
    return readRaw(raw)[at(16, 16)];
  };
  expect(await redOf('depth')).toBeGreaterThan(2 * (await redOf('distance')));
  expect(await redOf('auto')).toBe(await redOf('depth'));
});

test.each(['--out', '--raw', '--timings'])('%s does not overwrite an input', async (argument) => {
  const folder = new TestFolder();
  const [scene, camera] = [folder.scene(), folder.camera()];
  const model = folder.write('model.json', [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]);
  const inputs = [scene, '--camera', camera, '--model', model, ...SIZE, ...REFERENCE];
  const before = [scene, camera, model].map((path) => readFileSync(path));
  const others = argument === '--timings' ? ['--out', folder.file('a.png')] : [];
  for (const path of [scene, camera, model]) {
    const { status, out, err } = await runMain('render', ...inputs, ...others, argument, path);
    expect([status, out]).toEqual([2, '']);
    expect(err).toBe(
      `websplatter: ${argument} is ${path}, which is read too; give it another name (see websplatter --help)\n`,
    );
  }
  expect([scene, camera, model].map((path) => readFileSync(path))).toEqual(before);
  expect(readdirSync(folder.path).sort()).toEqual(['camera.json', 'model.json', 'scene.ply']);
});

test('two outputs need files of their own', async () => {
  const folder = new TestFolder();
  const inputs = [folder.scene(), '--camera', folder.camera(), ...SIZE, ...REFERENCE];
  const outputs = ['--out', folder.file('a'), '--raw', `${folder.path}/./a`];
  const { status, err } = await runMain('render', ...inputs, ...outputs);
  expect([status, err]).toEqual([2, expect.stringContaining('which --out writes too')]);
});
