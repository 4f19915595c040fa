import { expect, it } from 'vitest';
import { controlKey } from './key-scope.ts';

it('names key presses with Ctrl or the command key', () => {
  const press = (key: string, modifiers: string) =>
    controlKey({
      key,
      ctrlKey: modifiers.includes('c'),
      metaKey: modifiers.includes('m'),
      shiftKey: modifiers.includes('s'),
      altKey: modifiers.includes('a'),
    });
  const z = ['c', 'm', 'cs', 'ca', ''].map((each) => press('z', each));
  expect(z).toEqual(['ctrl+z', 'ctrl+z', 'ctrl+y', null, null]);
  const others = [press('Z', 'cs'), press('y', 'c'), press('y', 'cs'), press('S', 'c')];
  expect(others).toEqual(['ctrl+y', 'ctrl+y', null, 'ctrl+s']);
});
