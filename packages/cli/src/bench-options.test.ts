import { ACCURACY_PRESETS } from '@websplatter/core';
import { expect, test } from 'vitest';
import { parseBenchArguments } from './bench-options.ts';

test('the shortest commands have the defaults', () => {
  const common = {
    widthPx: 1920,
    heightPx: 1080,
    frames: 100,
    orbitDegrees: 15,
    accuracy: ACCURACY_PRESETS.balanced,
    accuracyLabel: 'balanced',
    detail: 'full',
    isJson: false,
  };
  expect(parseBenchArguments(['scene.ply', '--camera', 'cam.json'])).toEqual({
    ...common,
    scene: { kind: 'named', name: 'scene.ply' },
    cameraOptions: { camera: 'cam.json', up: undefined },
  });
  expect(parseBenchArguments(['--synthetic', '1000000'])).toEqual({
    ...common,
    scene: { kind: 'synthetic', splats: 1_000_000, shDegree: 3, seed: 1 },
    cameraOptions: undefined,
  });
});

test('a camera is found unless one is given; synthetic scenes have one', () => {
  const of = (...args: string[]) => parseBenchArguments(args).cameraOptions;
  expect(of('scene.ply')).toEqual({ camera: 'auto', up: undefined });
  expect(of('scene.ply', '--up', '-y')).toEqual({ camera: 'auto', up: [0, -1, 0] });
  expect(of('--synthetic', '10k', '--camera', 'auto')).toEqual({ camera: 'auto', up: undefined });
  expect(of('--synthetic', '10k', '--up', 'z')).toEqual({ camera: 'auto', up: [0, 0, 1] });
});

test('numbers of splats have units, and settings change a preset', () => {
  const of = (text: string) => parseBenchArguments(['--synthetic', text]).scene;
  expect(of('250k')).toMatchObject({ splats: 250_000 });
  expect(of('1.5M')).toMatchObject({ splats: 1_500_000 });
  expect(of('16m')).toMatchObject({ splats: 16_000_000 });
  const options = [
    '--accuracy',
    'fast',
    '--set',
    'rasterizer=tiles',
    '--degree',
    '0',
    '--seed',
    '7',
    '--detail',
    'maxErrorPx=1',
    '--json',
  ];
  expect(parseBenchArguments(['--synthetic', '10k', ...options])).toMatchObject({
    scene: { shDegree: 0, seed: 7 },
    accuracy: { ...ACCURACY_PRESETS.fast, rasterizer: 'tiles' },
    accuracyLabel: 'fast rasterizer=tiles',
    detail: { maxErrorPx: 1 },
    isJson: true,
  });
});

test.each([
  [[], 'bench needs one SCENE, or --synthetic N'],
  [['a.ply', 'b.ply'], 'bench needs one SCENE'],
  [['a.ply', '--synthetic', '10k'], 'bench needs one SCENE'],
  [['a.ply', '--camera', 'c', '--up', 'y'], '--up is for --camera auto; c has an up of its own'],
  [['a.ply', '--camera', 'c', '--seed', '2'], '--seed needs --synthetic N'],
  [['--synthetic', '9999'], '--synthetic is 9999; it must be a number of splats, 10k to 16M'],
  [['--synthetic', '17M'], '--synthetic is 17M'],
  [['--synthetic', 'many'], '--synthetic is many'],
  [['--synthetic', '1e6'], '--synthetic is 1e6'],
  [['--synthetic', '10k', '--degree', '4'], '--degree is 4; it must be 0, 1, 2 or 3'],
  [['--synthetic', '10k', '--seed', '-1'], '--seed is -1; it must be a whole number from 0 to 999999999'],
  [['--synthetic', '10k', '--seed=x'], '--seed is x'],
  [['--synthetic', '10k', '--orbit', '0'], '--orbit is 0; it must be degrees above 0 and up to 360'],
  [['--synthetic', '10k', '--orbit', '400'], '--orbit is 400'],
  [['--synthetic', '10k', '--frames', '0'], '--frames is 0'],
  [['--synthetic', '10k', '--detail', 'low'], '--detail low: takes full'],
  [['--synthetic', '10k', '--size', 'big'], '--size is big'],
  [['--synthetic', '10k', '--accuracy', 'best'], 'There is no accuracy preset "best"'],
])('%j is refused', (args, message) => {
  expect(() => parseBenchArguments(args)).toThrow(message);
});
