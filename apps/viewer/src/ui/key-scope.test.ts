import { expect, it } from 'vitest';
import { historyKey } from './key-scope.ts';

it('reads the direction of key presses', () => {
  const press = (key: string, modifiers: string) =>
    historyKey({
      key,
      ctrlKey: modifiers.includes('c'),
      metaKey: modifiers.includes('m'),
      shiftKey: modifiers.includes('s'),
      altKey: modifiers.includes('a'),
    });
  const z = ['c', 'm', 'cs', 'ca', ''].map((each) => press('z', each));
  expect(z).toEqual(['undo', 'undo', 'redo', null, null]);
  const others = [press('Z', 'cs'), press('y', 'c'), press('y', 'cs'), press('x', 'c')];
  expect(others).toEqual(['redo', 'redo', null, null]);
});
