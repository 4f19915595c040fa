import { describe, expect, it } from 'vitest';
import type { ChosenEffect, EffectChoice } from '../state/effect-choices.ts';
import { type EffectSlider, formatSlider, slidersOf } from './effect-sliders.ts';
import { firstChoice } from './first-choice.ts';

const place = { center: [10, -2, 0.5], radius: 3, viewDepth: 7 } as const;

function sliders<Name extends ChosenEffect>(name: Name, changes: Partial<EffectChoice<Name>> = {}) {
  const choice = { ...firstChoice(name, place), ...changes };
  const all = slidersOf(name, choice, place);
  const find = (wanted: string) =>
    all.find((each) => each.name === wanted) as EffectSlider<EffectChoice<Name>>;
  return { choice, all, find };
}

describe('the sliders of effects', () => {
  it.each([
    ['clip', { shape: 'plane' }, ['point', 'turn', 'tilt', 'softEdge']],
    ['clip', { shape: 'sphere' }, ['radius', 'center.x', 'center.y', 'center.z', 'softEdge']],
    [
      'clip',
      { shape: 'box' },
      ['size.x', 'size.y', 'size.z', 'center.x', 'center.y', 'center.z', 'softEdge'],
    ],
    ['reveal', {}, ['radius', 'softEdge']],
    ['brightness', {}, ['factor']],
    ['fog', {}, ['near', 'far']],
    ['fog', { kind: 'density' }, ['density']],
    ['tint', {}, []],
    ['antialias', {}, []],
  ] as const)('of %s with %o read what they write, between their ends', (name, changes, names) => {
    const { choice, all } = sliders(name, changes);
    expect(all.map((each) => each.name)).toEqual(names);
    for (const { min, max, step, read, write } of all) {
      expect(read(choice)).toBeGreaterThanOrEqual(min - step);
      expect(read(choice)).toBeLessThanOrEqual(max + step);
      const middle = min + Math.round((max - min) / 2 / step) * step;
      expect(read(write(choice, middle))).toBeCloseTo(middle, 9);
    }
  });

  it('move a plane along its normal only', () => {
    const { choice, find } = sliders('clip', { turnDegrees: 90, tiltDegrees: 0 });
    const moved = find('point').write(choice, 1);
    expect(moved.center[0]).toBeCloseTo(11, 9);
    expect(moved.center.slice(1)).toEqual(choice.center.slice(1).map((value) => expect.closeTo(value, 9)));
  });

  it('keep the end of fog beyond its beginning', () => {
    const { choice, find } = sliders('fog');
    const late = find('near').write(choice, 15);
    expect(late.far).toBeGreaterThan(15);
    const early = find('far').write(choice, 1);
    expect(early.near).toBeLessThan(1);
  });

  it('show everything at the right end of a reveal', () => {
    const { choice, find } = sliders('reveal', { from: 'camera' });
    const radius = find('radius');
    expect(radius.max).toBe(18);
    expect(radius.write(choice, radius.max).radius).toBe(Infinity);
    expect(radius.write(choice, 17).radius).toBe(17);
  });

  it.each([
    ['units', 0.01, 1.25, '1.25'],
    ['units', 0.01, Infinity, 'all'],
    ['degrees', 1, -90, '−90°'],
    ['stops', 0.1, 0.5, '+0.5'],
    ['stops', 0.1, 0, '0.0'],
  ] as const)('write numbers in %s at steps of %d: %d', (unit, step, value, text) => {
    expect(formatSlider({ unit, step }, value)).toBe(text);
  });
});
