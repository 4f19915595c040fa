import { describe, expect, test } from 'vitest';
import { InvalidArgumentError } from '../../../data/errors.ts';
import { SplatSelection } from '../../../data/splats/splat-selection.ts';
import { usesOf } from '../cloud-effects.ts';
import { defineEffect } from '../define-effect.ts';
import { highlight } from './highlight.ts';

const selection = new SplatSelection();
selection.add([4]);
const HIGHLIGHT = { selection, color: [1, 1, 0], strength: 0.5 } as const;

describe('highlight', () => {
  test('is on while anything is selected', () => {
    const changing = new SplatSelection();
    const use = highlight({ ...HIGHLIGHT, selection: changing });
    expect(use.reason).toBeNull();
    changing.add([1]);
    expect(use.reason).toBe('1 splat is selected');
    changing.add([1, 2]);
    expect(use.reason).toBe('2 splats are selected');
    changing.clear();
    expect(use.reason).toBeNull();
    expect(highlight({ ...HIGHLIGHT, strength: 0 }).reason).toBeNull();
  });

  test('rejects colours and strengths out of range', () => {
    expect(() => highlight({ ...HIGHLIGHT, color: [1, 1.2, 0] })).toThrow(InvalidArgumentError);
    expect(() => highlight({ ...HIGHLIGHT, color: [1, Number.NaN, 0] })).toThrow(/1, NaN, 0/);
    expect(() => highlight({ ...HIGHLIGHT, strength: -0.1 })).toThrow(/strength is -0.1/);
  });

  test('acts together with an effect of another selection', () => {
    const hide = defineEffect<SplatSelection>({
      name: 'test-hide',
      label: 'Hide',
      about: 'Hides selected splats.',
      hooks: { splat: 'hideSplat' },
      wgsl: '',
      calledFor: () => 'it is to be hidden',
      selection: (options) => options,
    });
    expect(usesOf({ effects: [highlight(HIGHLIGHT), hide(selection)] })).toHaveLength(2);
    expect(usesOf({ effects: [highlight(HIGHLIGHT), hide(new SplatSelection())] })).toHaveLength(2);
  });
});
