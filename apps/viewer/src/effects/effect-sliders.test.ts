import { EFFECT_OPTIONS, type OptionValues } from '@websplatter/core/effect-options';
import { describe, expect, it } from 'vitest';
import { firstValues } from '../state/effect-values.ts';
import type { Vec3 } from '../state/vec3.ts';
import { type EffectSlider, formatSlider, slidersOf } from './effect-sliders.ts';

const place = { center: [10, -2, 0.5], radius: 3, viewDepth: 7 } as const;

function sliders(name: string, changes: OptionValues = {}) {
  const values = { ...firstValues(name, place), ...changes };
  const all = slidersOf(name, values, place);
  const find = (wanted: string) => all.find((each) => each.name === wanted) as EffectSlider;
  return { values, all, find };
}

/** Every effect that has sliders, with each of the words that can be chosen for it. */
const WORDED = Object.entries(EFFECT_OPTIONS)
  .flatMap(([name, { options }]) =>
    Object.entries(options).flatMap(([key, option]) => {
      if (option.kind !== 'choice') return [[name, {}]] as const;
      return Object.keys(option.choices(firstValues(name, place))).map(
        (word) => [name, { [key]: word }] as const,
      );
    }),
  )
  .filter(([name, changes]) => sliders(name, changes).all.length > 0);

describe('the sliders of effects', () => {
  it.each(WORDED)('of %s with %o read what they write, between their ends', (name, changes) => {
    const { values, all } = sliders(name, changes);
    for (const { min, max, step, read, write } of all) {
      expect(read(values)).toBeGreaterThanOrEqual(min - step);
      expect(read(values)).toBeLessThanOrEqual(max + step);
      const middle = min + Math.round((max - min) / 2 / step) * step;
      expect(read(write(values, middle))).toBeCloseTo(middle, 9);
    }
  });

  it('read what was chosen by other words, too', () => {
    const { values } = sliders('volumes', { shape: 'sphere' });
    for (const shape of ['plane', 'box', 'sphere'])
      for (const { read } of sliders('volumes', { shape }).all) expect(read(values)).not.toBeNaN();
  });

  it.each([
    ['volumes', { shape: 'plane' }, ['center', 'turnDegrees', 'tiltDegrees', 'softEdge']],
    ['volumes', { shape: 'sphere' }, ['center.x', 'center.y', 'center.z', 'radius', 'softEdge']],
    [
      'volumes',
      { shape: 'box' },
      ['center.x', 'center.y', 'center.z', 'size.x', 'size.y', 'size.z', 'softEdge'],
    ],
    ['fog', { kind: 'depths' }, ['near', 'far']],
    ['fog', { kind: 'density' }, ['density']],
    ['tint', {}, []],
  ])('of %s with %o are those that have a meaning', (name, changes, names) => {
    expect(sliders(name, changes).all.map((each) => each.name)).toEqual(names);
  });

  it('move a plane along its normal only', () => {
    const { values, find } = sliders('volumes', { turnDegrees: 90, tiltDegrees: 0 });
    const moved = find('center').write(values, 1);
    expect((moved.center as Vec3)[0]).toBeCloseTo(11, 9);
    expect((moved.center as Vec3).slice(1)).toEqual(
      (values.center as Vec3).slice(1).map((value) => expect.closeTo(value, 9)),
    );
  });

  it('keep the end of fog beyond its beginning', () => {
    const { values, find } = sliders('fog');
    const late = find('near').write(values, 15);
    expect(late.far).toBeGreaterThan(15);
    const early = find('far').write(values, 1);
    expect(early.near).toBeLessThan(1);
  });

  it('show everything at the right end of a reveal', () => {
    const { values, find } = sliders('reveal', { from: 'camera' });
    const radius = find('radius');
    expect(radius.max).toBe(18);
    expect(radius.write(values, radius.max).radius).toBe(Infinity);
    expect(radius.write(values, 17).radius).toBe(17);
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
