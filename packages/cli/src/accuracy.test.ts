import { existsSync } from 'node:fs';
import { expect, test } from 'vitest';
import { runMain, TestFolder } from './testing/test-folder.ts';

test('accuracy refuses bad input with one line, and writes nothing', async () => {
  const folder = new TestFolder();
  const [scene, camera] = [folder.scene(), folder.camera()];
  const svg = folder.file('chart.svg');
  const common = ['accuracy', scene, '--camera', camera, '--svg', svg];
  for (const [args, message] of [
    [['accuracy'], 'needs a SCENE'],
    [['accuracy', scene], 'needs --camera'],
    [common, 'needs --size'],
    [[...common, '--size', '8x8', '--base', 'best'], '--base is best'],
    [[...common, '--size', '8x8', '--settings', 'sharpness'], '“sharpness”'],
    [[...common, '--size', '8x8', '--frames', '0'], '--frames is 0'],
    [[...common, '--size', '8x8', '--sort-by', 'z'], '--sort-by is z'],
    [[...common, '--size', '8x8', '--svg', camera], `--svg is ${camera}, which is read too`],
  ] as const) {
    const { status, out, err } = await runMain(...args);
    expect(err).toContain(message);
    expect(err.trimEnd()).not.toContain('\n');
    expect([status, out]).toEqual([2, '']);
  }
  expect(existsSync(svg)).toBe(false);
});
