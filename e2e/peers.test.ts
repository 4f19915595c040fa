// Proves: this project beside peers whose pictures are checked, from a pack and from the clone.
import { execFile } from 'node:child_process';
import { mkdtemp, readdir, readFile, rm, writeFile } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { encodePly, type SplatSet } from '@websplatter/core';
import { writeSplats } from '@websplatter/core/write';
import { afterAll, beforeAll, expect, test } from 'vitest';
import { MIN_PSNR_DB } from './reference.ts';
import { testScene } from './test-scene.ts';

const repositoryRoot = fileURLToPath(new URL('..', import.meta.url));
const runner = join(repositoryRoot, 'packages/tools/bench.mjs');
const faintAdapter = join(repositoryRoot, 'e2e/peers/faint.js');
const SH_C0 = 0.28209479177387814;
const camera = {
  name: 'front',
  position: [1, 1.5, 6],
  target: [1, 1, 0],
  up: [0, 1, 0],
  fovYDegrees: 45,
  near: 0.1,
  far: 100,
};

/** A scene in the JSON. */
interface SceneReport {
  readonly scene: string;
  readonly format: { readonly name: string };
  readonly rows: readonly {
    readonly peer: string;
    readonly isReader: boolean;
    readonly rounds: readonly { readonly loaded: { readonly loadMs: number }; readonly measured: unknown }[];
    readonly pictures: readonly { readonly psnrDb: number }[];
  }[];
}

const own = ['floor-webgl2', 'floor-three', 'websplatter', 'websplatter-three'];
/** Frames tell times apart. These tests compare none. */
const few = '--size 64x48 --picture-size 64x48 --frames 3 --warm-up 1 --jumps 2'.split(' ');

let folder = '';
/** The bench of frames in the pack that the clone wrote. */
let packed = '';
beforeAll(async () => {
  folder = await mkdtemp(join(tmpdir(), 'websplatter-e2e-peers-'));
  await writeFile(join(folder, 'tiny.ply'), encodePly(testScene()));
  await writeFile(join(folder, 'tiny.cameras.json'), JSON.stringify([camera]));
  const peers = [...own, `faint=${faintAdapter}`].join();
  const packing = await run(runner, 'frames', '--pack', 'pack', '--peers', peers);
  expect(packing.status, packing.complaints).toBe(0);
  packed = join(folder, 'pack/bench-peers.mjs');
});
afterAll(() => rm(folder, { recursive: true, force: true }));

/** Splats as rows of a .splat: position, scale, colour and opacity, rotation. */
function splatFile({ count, positions, logScales, rotations, opacityLogits, colorDc }: SplatSet): Uint8Array {
  const bytes = new Uint8ClampedArray(32 * count);
  const view = new DataView(bytes.buffer);
  for (let i = 0; i < count; i++) {
    for (let axis = 0; axis < 3; axis++) {
      view.setFloat32(32 * i + 4 * axis, positions[3 * i + axis], true);
      view.setFloat32(32 * i + 12 + 4 * axis, Math.exp(logScales[3 * i + axis]), true);
      bytes[32 * i + 24 + axis] = 255 * (0.5 + SH_C0 * colorDc[3 * i + axis]);
    }
    bytes[32 * i + 27] = 255 / (1 + Math.exp(-opacityLogits[i]));
    const rotation = rotations.subarray(4 * i, 4 * i + 4);
    for (let part = 0; part < 4; part++)
      bytes[32 * i + 28 + part] = 128 + (128 * rotation[part]) / Math.hypot(...rotation);
  }
  return new Uint8Array(bytes.buffer);
}

/** Runs a script from `folder`, in a process with none of Vitest's settings. */
function run(
  script: string,
  ...args: string[]
): Promise<{ status: number; output: string; complaints: string }> {
  const { NODE_ENV: _, NODE_OPTIONS: __, INIT_CWD: ___, ...env } = process.env;
  return new Promise((resolve) => {
    const child = execFile(
      process.execPath,
      [script, ...args],
      { cwd: folder, env },
      (_error, output, complaints) => resolve({ status: child.exitCode ?? -1, output, complaints }),
    );
  });
}

test('a pack measures this project beside a peer that draws less, whose pictures show it', async () => {
  const files = ['--scenes', 'tiny.ply', '--json', 'report.json', '--out', 'pictures'];
  const { status, output, complaints } = await run(
    packed,
    ...['--software', '--passes', '--rounds', '1', ...files, ...few],
  );
  expect(status, complaints).toBe(0);

  const report = JSON.parse(await readFile(join(folder, 'report.json'), 'utf8'));
  const [{ scene, splats, rows }] = report.scenes;
  expect({ scene, splats }).toEqual({ scene: 'tiny', splats: testScene().count });
  for (const { peer, rounds } of rows) {
    const [{ loaded, measured, heap }] = rounds;
    expect(loaded.loadMs, peer).toBeGreaterThan(0);
    expect(measured.turnMs, peer).toHaveLength(3);
    expect(measured.gpuMs, peer).toHaveLength(loaded.api === 'webgpu' ? 3 : 0);
    if (peer === 'websplatter') expect(Math.min(...measured.gpuMs)).toBeGreaterThan(0);
    if (loaded.api === 'webgpu') {
      const { frameMs, passes } = measured.byPass;
      expect(frameMs, peer).toHaveLength(3);
      expect(Math.min(...frameMs), peer).toBeGreaterThan(0);
      expect(passes, peer).toHaveLength(3);
    } else expect(measured.byPass).toBeNull();
    expect(measured.correctMs, peer).toHaveLength(2);
    expect(heap.jsBytes, peer).toBeGreaterThan(0);
  }
  for (const { peer, pictures, rounds } of rows) {
    const [{ state }] = rounds;
    if (peer.startsWith('floor')) expect(pictures).toEqual([]);
    else if (peer === 'faint') expect(pictures[0].psnrDb).toBeLessThan(MIN_PSNR_DB - 10);
    else {
      expect(pictures[0].psnrDb, peer).toBeGreaterThan(MIN_PSNR_DB);
      expect(state.gpuBytes, peer).toBeGreaterThan(0);
    }
    // The calls of the API add up to the engine's own figure, or more.
    if (peer === 'websplatter')
      expect(state.gpuBytes).toBeGreaterThanOrEqual(state.figures.memory.totalBytes);
  }

  for (const { peer } of rows) expect(output).toContain(`| ${peer} `);
  expect(output).toMatch(
    /websplatter-three: its median GPU frame is .* above those of websplatter and floor-three/,
  );
  for (const pass of ['compose: compute', 'copyTextureToTexture: .* 64×48'])
    expect(output).toMatch(new RegExp(`^\\| websplatter-three +\\| ${pass}`, 'm'));
  const drawn = [...own.filter((peer) => !peer.startsWith('floor')), 'faint'];
  const pictures = drawn.map((peer) => `tiny.${peer}.front.png`).sort();
  expect(await readdir(join(folder, 'pictures'))).toEqual(pictures);
});

test('loads alone are measured of each format, by the peers that read it', async () => {
  await writeFile(join(folder, 'tiny.splat'), splatFile(testScene()));
  const peers = 'floor-webgl2,websplatter,faint';
  const files = ['--scenes', 'tiny.ply,tiny.splat', '--json', 'loads.json'];
  const { status, output, complaints } = await run(
    packed,
    ...['--software', '--loads', '--rounds', '2', '--peers', peers, ...files, ...few],
  );
  expect(status, complaints).toBe(0);

  const { scenes } = JSON.parse(await readFile(join(folder, 'loads.json'), 'utf8'));
  const found = scenes.map(({ scene, format, rows }: SceneReport) => [
    scene,
    format.name,
    ...rows.map(({ isReader, rounds }) => (isReader ? rounds.length : 'unread')),
  ]);
  expect(found).toEqual([
    ['tiny', 'ply', 2, 2, 2],
    ['tiny.splat', 'splat', 2, 2, 'unread'],
  ]);
  for (const { rows } of scenes as SceneReport[]) {
    const ours = rows.find(({ peer }) => peer === 'websplatter')!;
    for (const { loaded, measured } of ours.rounds) {
      expect(loaded.loadMs).toBeGreaterThan(0);
      expect(measured).toBeNull();
    }
    expect(ours.pictures[0].psnrDb).toBeGreaterThan(MIN_PSNR_DB);
  }
  expect(output).toContain('- faint does not read splat');
  expect(output).toMatch(/^\| tiny\.splat +\| splat /m);
});

test('a file that is no scene ends the bench with one line and the usage', async () => {
  await writeFile(join(folder, 'broken.ply'), 'no splats');
  const { status, complaints } = await run(
    runner,
    'frames',
    '--software',
    '--peers',
    'floor-webgl2',
    '--scenes',
    'broken.ply',
  );
  expect(status).toBe(2);
  expect(complaints).toMatch(/broken\.ply: .*\nnpm run bench:peers/);
});

test('a scene that streams is measured until it is complete, and to the last byte', async () => {
  const scene = testScene(6000);
  await writeFile(join(folder, 'city.bricks'), await writeSplats(scene, 'bricks'));
  await writeFile(join(folder, 'city.ply'), encodePly(scene));
  const files = '--bricks city.bricks --scene city.ply --cameras tiny.cameras.json --json streams.json';
  const few = '--size 64x48 --picture-size 64x48 --rounds 1 --frames 2 --warm-up 1 --max-splats 1000';
  const { status, output, complaints } = await run(
    runner,
    ...['streams', '--software', '--latency', '5', ...`${files} ${few}`.split(' ')],
  );
  expect(status, complaints).toBe(0);
  expect(output).toContain('| websplatter ');

  const { rows } = JSON.parse(await readFile(join(folder, 'streams.json'), 'utf8'));
  const [{ rounds, pictures }] = rows;
  const [{ watched, streamed, bytes, requests, measured }] = rounds;
  // In browsers of their own, of which either may be the slower one.
  expect(watched.firstPictureMs).toBeGreaterThan(2 * 5);
  expect(streamed.completeMs).toBeGreaterThan(2 * 5);
  expect(bytes.firstPicture).toBeGreaterThan(0);
  expect(bytes.complete).toBeGreaterThanOrEqual(bytes.firstPicture);
  expect(requests).toBeGreaterThan(1);
  expect(measured.turnMs).toHaveLength(2);
  const [{ ownPsnrDb, finestPsnrDb }] = pictures;
  expect(finestPsnrDb).toBeGreaterThan(MIN_PSNR_DB);
  expect(ownPsnrDb).toBeLessThan(finestPsnrDb);
});
