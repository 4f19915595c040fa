import { resolveAccuracy } from '@websplatter/core';
import { antialias } from '@websplatter/core/effects';
import { describe, expect, it } from 'vitest';
import { isMapMode, VIEW_MODE_NAMES, type ViewModeName, viewModeAfter } from '../state/view-mode.ts';
import { cautionsOf, overdrawPart, type PictureFacts, VIEW_MODES, viewModeOf } from './view-modes.ts';

const bounds = { center: [0, 0, -10], radius: 5 } as const;
const FACTS: PictureFacts = {
  viewMatrix: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1],
  background: [0, 0.2, 1],
  subject: { bounds, focusDistance: 10 },
  accuracy: resolveAccuracy(),
  shDegree: 3,
};
const accuracyWith = (changes: Partial<PictureFacts['accuracy']>): PictureFacts => ({
  ...FACTS,
  accuracy: { ...FACTS.accuracy, ...changes },
});
const ticksOf = (name: ViewModeName, facts = FACTS) =>
  viewModeOf(name)
    .scale?.(facts)
    .ticks.map(({ text }) => text);
const cautionOf = (name: ViewModeName, facts = FACTS) => viewModeOf(name).caution?.(facts) ?? null;

describe('the view modes', () => {
  it('are all there, in one order, which begins again behind its end', () => {
    expect(VIEW_MODES.map(({ name }) => name)).toEqual(VIEW_MODE_NAMES);
    expect(viewModeAfter('colours', 1)).toBe('ellipsoids');
    expect(viewModeAfter('colours', -1)).toBe('contribution');
    expect(viewModeAfter('contribution', 1)).toBe('colours');
  });

  it('ask for effects, but for the trained colours and those with maps', () => {
    for (const { name, uses, map } of VIEW_MODES) {
      expect(map !== undefined, name).toBe(isMapMode(name));
      const asked = uses({ bounds, focusDistance: () => 10 });
      expect(asked.length > 0, name).toBe(name !== 'colours' && !map);
      // Compensating for dilation would falsify opacities that are not the scene's.
      const setsOpacity = asked.some(({ effect }) => effect.hooks.opacity && effect !== antialias.effect);
      expect(
        asked.some(({ effect, reason }) => effect === antialias.effect && reason === null),
        name,
      ).toBe(setsOpacity);
    }
  });

  it('have scales with numbers from end to end', () => {
    expect(ticksOf('depth')).toEqual(['5', '6', '7.5', '10', '15']);
    expect(ticksOf('opacity')).toEqual(['0', '0.25', '0.5', '0.75', '1']);
    expect(ticksOf('harmonics')).toEqual(['0', '16', '32', '48', '≥ 64']);
    expect(ticksOf('detail')).toEqual(['0', '1', '2', '3', '4', '≥ 5']);
    expect(ticksOf('overdraw')).toEqual(['0', '10', '20', '40', '80']);
    expect(viewModeOf('overdraw').scale?.(FACTS).low.color).toEqual([0, 51, 255]);
    expect(viewModeOf('centres').scale).toBeUndefined();
  });

  it('name the degrees of harmonics that are drawn', () => {
    expect(cautionOf('harmonics')).toContain('degree 1 to 3 are');
    expect(cautionOf('harmonics', { ...FACTS, shDegree: 1 })).toContain('degree 1 are');
    expect(cautionOf('harmonics', { ...FACTS, shDegree: 0 })).toMatch(
      /^No harmonics.*no colour depends on the view/,
    );
  });

  it('count overdraw by what passes through as many splats', () => {
    expect(overdrawPart(0)).toBe(0);
    expect(overdrawPart(2)).toBeCloseTo(1 - (31 / 32) ** 2, 12);
    expect(cautionOf('overdraw', accuracyWith({ alphaCutoff: 1 / 256 }))).toContain('less than 0.13');
    expect(cautionOf('overdraw', accuracyWith({ alphaCutoff: 0.05 }))).toContain('nothing is counted');
  });

  it('say where records make edges soft', () => {
    for (const name of ['ellipsoids', 'centres'] as const) {
      expect(cautionOf(name)).toBeNull();
      expect(cautionOf(name, accuracyWith({ recordPrecision: 'paper' }))).toContain('soft');
    }
  });
});

describe('cautions about a picture', () => {
  const paper = accuracyWith({ recordPrecision: 'paper' });
  const cautions = (sides: readonly PictureFacts[]) => cautionsOf(viewModeOf('ellipsoids'), sides);

  it('is told once where both sides of a split image have it', () => {
    expect(cautions([])).toEqual([]);
    expect(cautions([FACTS, FACTS])).toEqual([]);
    expect(cautions([paper, paper])).toEqual([expect.stringMatching(/^The splat records/)]);
  });

  it('names the side where only one has it', () => {
    expect(cautions([FACTS, paper])).toEqual([expect.stringMatching(/^Side B: /)]);
    const counts = cautionsOf(viewModeOf('overdraw'), [FACTS, accuracyWith({ alphaCutoff: 1 / 64 })]);
    expect(counts).toEqual([
      expect.stringMatching(/^Side A: .* 0\.13/),
      expect.stringMatching(/^Side B: .* 0\.50/),
    ]);
  });
});
