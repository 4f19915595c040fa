import { existsSync } from 'node:fs';
import { expect, test } from 'vitest';
import { parseAccuracyArguments } from './accuracy-options.ts';
import { runMain, TestFolder } from './testing/test-folder.ts';

test('accuracy refuses bad input with one line, and writes nothing', async () => {
  const folder = new TestFolder();
  const [scene, camera] = [folder.scene(), folder.camera()];
  const svg = folder.file('chart.svg');
  const common = ['accuracy', scene, '--camera', camera, '--svg', svg];
  for (const [args, message] of [
    [['accuracy'], 'needs a SCENE'],
    [[...common, '--up', 'y'], `--up is for --camera auto; ${camera} has an up of its own`],
    [['accuracy', scene, '--up', 'north'], '--up is north; it must be auto or one of x, -x, y'],
    [[...common, '--size', '8x8', '--base', 'best'], '--base is best'],
    [[...common, '--size', '8x8', '--settings', 'sharpness'], '“sharpness”'],
    [[...common, '--size', '8x8', '--frames', '0'], '--frames is 0'],
    [[...common, '--size', '8x8', '--sort-by', 'z'], '--sort-by is z'],
    [[...common, '--size', '8x8', '--details', '50,100'], '--details is 50,100'],
    [[...common, '--size', '8x8', '--details', ',50'], '--details is ,50'],
    [[...common, '--size', '8x8', '--detail', 'maxErrorPx=1', '--details', '50'], 'leave out --detail'],
    [[...common, '--size', '8x8', '--distance', '0'], '--distance is 0'],
    [[...common, '--size', '8x8', '--distance', 'far'], '--distance is far'],
    [[...common, '--size', '8x8', '--svg', camera], `--svg is ${camera}, which is read too`],
  ] as const) {
    const { status, out, err } = await runMain(...args);
    expect(err).toContain(message);
    expect(err.trimEnd()).not.toContain('\n');
    expect([status, out]).toEqual([2, '']);
  }
  expect(existsSync(svg)).toBe(false);
});

test('accuracy measures less detail unless settings are compared at one', () => {
  const sharesOf = (...args: string[]) =>
    parseAccuracyArguments(['a.ply', '--camera', 'c.json', '--size', '8x8', ...args]).detailShares;
  expect(sharesOf()).toEqual([0.7, 0.5, 0.25, 0.12, 0.06]);
  expect(sharesOf('--details', '50,12.5')).toEqual([0.5, 0.125]);
  expect(sharesOf('--details', 'none')).toEqual([]);
  expect(sharesOf('--detail', 'maxSplats=9')).toEqual([]);
});
