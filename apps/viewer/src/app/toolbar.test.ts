import { describe, expect, it } from 'vitest';
import { COMMANDS } from '../state/command-list.ts';
import { hasWords, inlineCommands } from './toolbar.tsx';

const buttons = COMMANDS.filter(({ bar }) => bar !== undefined);
const wordsAt = (widthPx: number, isTouch = false) =>
  inlineCommands(buttons, widthPx, isTouch).map(({ bar }) => bar?.word);

describe('the buttons in the toolbar', () => {
  it('are those of the lowest rank on phones, beside the menu', () => {
    expect(wordsAt(320, true)).toEqual(['Open', 'View', 'Save', 'Help']);
    expect(wordsAt(360, true)).toEqual(['Open', 'View', 'Accuracy', 'Save', 'Help']);
  });

  it('are as many as fit, in the order of the groups', () => {
    const some = wordsAt(900);
    expect(some).toHaveLength(10);
    expect(some).toEqual(buttons.map(({ bar }) => bar?.word).filter((word) => some.includes(word)));
    // Fingers need wider buttons than pointers.
    expect(wordsAt(900, true).length).toBeLessThan(some.length);
  });

  it('are all on wide windows, where there is no menu', () => {
    expect(inlineCommands(buttons, 1440, false)).toBe(buttons);
  });

  it('have ranks of their own', () => {
    expect(buttons.map(({ bar }) => bar?.rank).sort((a = 0, b = 0) => a - b)).toEqual([...buttons.keys()]);
  });
});

it('has words where there is room or no tooltip', () => {
  expect([360, 640, 641, 1099, 1100].map((widthPx) => hasWords(widthPx, false))).toEqual([
    true,
    true,
    false,
    false,
    true,
  ]);
  expect(hasWords(900, true)).toBe(true);
});
