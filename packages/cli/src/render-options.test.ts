import { ACCURACY_PRESETS } from '@websplatter/core';
import { expect, test } from 'vitest';
import { parseRenderArguments } from './render-options.ts';

const MINIMUM = ['scene.ply', '--camera', 'cam.json', '--size', '320x200', '--out', 'a.png'];

test('the shortest command has the defaults', () => {
  expect(parseRenderArguments(MINIMUM)).toEqual({
    scenes: ['scene.ply'],
    camera: 'cam.json',
    up: undefined,
    models: [],
    widthPx: 320,
    heightPx: 200,
    out: 'a.png',
    raw: undefined,
    poster: undefined,
    renderer: 'gpu',
    accuracy: ACCURACY_PRESETS.balanced,
    accuracyLabel: 'balanced',
    sortBy: 'auto',
    detail: 'full',
    background: [0, 0, 0],
    frames: 1,
    timings: undefined,
  });
});

test('a scene and an output are enough: the camera is found, with an axis for up if one is given', () => {
  const of = (...args: string[]) => parseRenderArguments(['scene.ply', '--out', 'a.png', ...args]);
  expect(of()).toMatchObject({ camera: 'auto', up: undefined, widthPx: 1280, heightPx: 720 });
  expect(of('--camera', 'auto', '--up', 'auto')).toMatchObject({ camera: 'auto', up: undefined });
  expect(of('--up', '-y').up).toEqual([0, -1, 0]);
  expect(of('--up', 'z').up).toEqual([0, 0, 1]);
});

test('settings change a preset, and a number may be a fraction', () => {
  const settings = [
    '--accuracy',
    'high',
    '--set',
    'alphaCutoff=1/512',
    '--set',
    'sortKeyBits=16',
    '--set',
    'sort=x',
  ];
  expect(() => parseRenderArguments([...MINIMUM, ...settings])).toThrow(
    'There is no accuracy setting "sort"',
  );
  expect(parseRenderArguments([...MINIMUM, ...settings.slice(0, -2)]).accuracy).toEqual({
    ...ACCURACY_PRESETS.high,
    alphaCutoff: 1 / 512,
    sortKeyBits: 16,
  });
});

test('detail has limits, or an outcome to find them by', () => {
  const of = (...args: string[]) => parseRenderArguments([...MINIMUM, ...args]).detail;
  expect(of('--detail', 'full')).toBe('full');
  expect(of('--detail', 'maxErrorPx=0.5')).toEqual({ maxErrorPx: 0.5 });
  expect(of('--detail', 'maxSplats=1000')).toEqual({ maxSplats: 1000 });
  const both = { maxErrorPx: 2, maxSplats: 1e6 };
  expect(of('--detail', 'maxErrorPx=2,maxSplats=1e6')).toEqual(both);
  expect(of('--detail', 'maxShare=0.5')).toEqual({ maxShare: 0.5 });
  expect(of('--detail', 'minPsnrDb=40')).toEqual({ minPsnrDb: 40 });
  expect(of('--detail', 'auto')).toBe('auto');
  expect(of('--detail', 'full', '--renderer', 'reference')).toBe('full');
});

/**
 * @fault Command line: a bad option
 * @consequence one line that names it, exit status 2, nothing is drawn
 */
test.each([
  [['--camera', 'c', '--size', '1x1', '--out', 'o'], 'render needs a SCENE'],
  [['--up', '-y'], '--up is for --camera auto; cam.json has an up of its own'],
  [['s', '--out', 'o', '--up', 'up'], '--up is up; it must be auto or one of x, -x, y, -y, z, -z'],
  [
    ['s', '--camera', 'c', '--size', '1x1'],
    'render needs --out image.png, --raw image.f32 or --poster image.jpg',
  ],
  [['--poster', 'a.webp'], '--poster is a.webp; it must be a file whose name ends in .jpg or .jpeg or .png'],
  [['--poster', 'jpg'], '--poster is jpg; it must be'],
  [['--poster', '-'], '--poster is -; it must be'],
  [['--size', '256'], '--size is 256; it must be WIDTHxHEIGHT'],
  [['--size', '0x5'], '--size is 0x5'],
  [['--size', '20000x5'], 'each 1 to 16384'],
  [['--background', '255,0,0'], '--background is 255,0,0; it must be r,g,b, each 0 to 1'],
  [['--background', '1,,0'], '--background is 1,,0'],
  [['--sort-by', 'z'], '--sort-by is z; it must be auto or depth or distance'],
  [['--detail', 'low'], '--detail low: takes full, auto, minPsnrDb=40'],
  [['--detail', '0.5'], '--detail 0.5: takes full'],
  [['--detail', 'maxSplats=0'], '--detail maxSplats=0: takes full'],
  [['--detail', 'maxSplats=9.5'], '--detail maxSplats=9.5: takes full'],
  [['--detail', 'maxErrorPx=1,low=2'], '--detail maxErrorPx=1,low=2: takes full'],
  [['--detail', 'maxErrorPx='], '--detail maxErrorPx=: takes full'],
  [['--detail', 'maxErrorPx=-1'], '--detail maxErrorPx=-1: takes full'],
  [['--detail', 'maxErrorPx=1', '--renderer', 'reference'], '--renderer reference draws every splat'],
  [['--frames', '0'], '--frames is 0'],
  [['--frames', '1.5'], '--frames is 1.5'],
  [['--renderer', 'cpu'], '--renderer is cpu; it must be gpu or reference'],
  [['--accuracy', 'best'], 'There is no accuracy preset "best"; there are reference, high, balanced'],
  [['--set', 'alphaCutoff'], '--set is alphaCutoff; it must be name=value'],
  [['--set', 'alphaCutoff=small'], 'alphaCutoff is small; it must lie in'],
  [['--model', 'a.json', '--model', 'b.json'], '2 --model for 1 scene; give one for each'],
  [['--raw', ''], '--raw is empty'],
  [['', '--camera', 'c', '--size', '1x1', '--out', 'o'], 'an argument is empty (see websplatter --help)'],
  [['--colour', 'red'], "Unknown option '--colour' (see websplatter --help)"],
])('%j is refused', (args, message) => {
  const complete = args[0].startsWith('--') && args[0] !== '--camera' ? [...MINIMUM, ...args] : args;
  expect(() => parseRenderArguments(complete)).toThrow(message);
});
