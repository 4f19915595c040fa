import { readFileSync } from 'node:fs';
import type { SceneFraming } from '@websplatter/core';
import { expect, test } from 'vitest';
import { cameraLine, prepareCamera } from './choose-camera.ts';
import { runMain, TestFolder, threeSplats } from './testing/test-folder.ts';

const SMALL = ['--size', '48x32', '--renderer', 'reference'];
/** Confidence of what is a guess. */
const UNSURE = 0.3;

const FRAMING: SceneFraming = {
  kind: 'object',
  position: [1000.123456789, 2, 3],
  target: [1000.1, 2, 1],
  up: [0, -1, 0],
  fovYDegrees: 50,
  center: [1000, 2, 1],
  radius: 3,
  groundHeight: null,
  confidence: { up: 1, kind: 1 },
};

const chosenFor = async (framing: SceneFraming, up?: SceneFraming['up']) =>
  (await prepareCamera({ camera: 'auto', up }, 1.5)).choose(() => framing);

test('a scene without a camera is rendered upright, and its camera, printed and saved, draws the same', async () => {
  const folder = new TestFolder();
  const [found, again] = [folder.file('found.f32'), folder.file('again.f32')];
  const first = await runMain('render', 'builtin:still-life-small', ...SMALL, '--raw', found);
  expect(first.status, first.err).toBe(0);
  const json = /^camera: (\{.*\})$/m.exec(first.out)![1];
  expect(JSON.parse(json)).toMatchObject({ up: [0, 1, 0], fovYDegrees: 50 });
  const camera = folder.write('camera.json', json);
  const second = await runMain(
    ...['render', 'builtin:still-life-small', '--camera', camera, ...SMALL, '--raw', again],
  );
  expect(second.status).toBe(0);
  expect(second.out).not.toContain('camera: ');
  expect(readFileSync(again)).toEqual(readFileSync(found));
});

test('up is as it is asked for, and a poster begins with the same view', async () => {
  const folder = new TestFolder();
  const { status, out, err } = await runMain(
    ...['render', folder.scene(), ...SMALL, '--up', '-z', '--poster', folder.file('a.png')],
  );
  expect(status, err).toBe(0);
  const { up, far } = JSON.parse(/^camera: (\{.*\})$/m.exec(out)![1]);
  expect(up).toEqual([0, 0, -1]);
  expect(out).toMatch(new RegExp(`^<SplatCanvas .*camera={{ up: \\[0, 0, -1\\], .*far: ${far} }}`, 'm'));
  expect(err).not.toContain('which way is up');
});

test('what is a guess is said, with what decides it', async () => {
  const tilted = await chosenFor({ ...FRAMING, confidence: { up: UNSURE, kind: 1 } });
  expect(tilted.notes).toEqual([
    'it is uncertain which way is up: -y was taken; --up with x, y, z, -x, -y or -z decides it',
  ]);
  const { notes } = await chosenFor({ ...FRAMING, kind: 'enclosed', confidence: { up: 1, kind: UNSURE } });
  expect(notes).toEqual([
    'it is uncertain how the scene is best looked at: it is seen from within; save the printed camera, change it and pass it with --camera',
  ]);
  expect((await chosenFor(FRAMING)).notes).toEqual([]);
});

test('a camera is as long as it must be, with planes that spare what is seen', async () => {
  const { found, camera } = await chosenFor(FRAMING);
  expect(cameraLine(found)).toBe(
    'camera: {"position":[1000.123457,2,3],"target":[1000.1,2,1],"up":[0,-1,0],"fovYDegrees":50,"near":0.002,"far":30000}\n',
  );
  expect(camera).toMatchObject({ near: 0.002, far: 30_000 });
  const huge = await chosenFor({ ...FRAMING, position: [1.23456789e9, 0, 0], target: [0, 0, 0] });
  expect(huge.found?.position).toEqual([1_234_567_890, 0, 0]);
  expect(huge.found?.near).toBe(1_200_000);
});

test('a scene of which nothing is seen needs a camera file', async () => {
  const folder = new TestFolder();
  const hidden = { ...threeSplats(), opacityLogits: new Float32Array(3).fill(Number.NEGATIVE_INFINITY) };
  const scene = folder.scene('hidden.ply', hidden);
  const { status, err } = await runMain('render', scene, ...SMALL, '--out', folder.file('a.png'));
  expect([status, err]).toEqual([2, expect.stringContaining('no splat can be seen')]);
});
