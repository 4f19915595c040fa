import { describe, expect, test } from 'vitest';
import { InvalidArgumentError } from '../../data/errors.ts';
import { identity4 } from '../../data/math/mat4.ts';
import { defineEffect } from './define-effect.ts';
import type { EffectDefinition } from './effect.ts';
import { effectSetOf, packParameters } from './effect-set.ts';
import { shadows } from './shadows/shadows.ts';

const GOOD = {
  name: 'wind-sway',
  label: 'Sway',
  about: 'Sways.',
  hooks: { color: 'sway' },
  wgsl: 'fn sway(color: vec3f, splat: Splat, i: u32, c: vec3f) -> vec3f { return color; }',
  calledFor: () => 'it sways',
};
const PLACE = {
  modelMatrix: identity4(),
  origin: [0, 0, 0] as const,
  viewMatrix: identity4(),
  projection: { isOrthographic: false, focalPx: [1, 1] as const },
};
const define = (changes: object) =>
  defineEffect({ ...GOOD, ...changes } as unknown as EffectDefinition<unknown, { by: 'f32' }>);

describe('a definition of an effect', () => {
  /**
   * @fault Effects: what becomes code of a shader is none: text, hooks, fields, types
   * @consequence `InvalidArgumentError` names it when the effect is defined
   */
  test.each([
    ['definition', null],
    ['wgsl', { wgsl: null }],
    ['wgsl', { wgsl: undefined }],
    ['wgsl', { wgsl: 5 }],
    ['wgsl', { wgsl: '@if(YES) fn sway() { }' }],
    ['name', { name: 'Wind' }],
    ['name', { name: '' }],
    ['name', { name: null }],
    ['hooks', { hooks: null }],
    ['hooks', { hooks: {} }],
    ['hooks', { hooks: { colour: 'sway' } }],
    ['hooks.color', { hooks: { color: '' } }],
    ['hooks.color', { hooks: { color: 'a b' } }],
    ['hooks.color', { hooks: { color: null } }],
    ['fields', { fields: null }],
    ['fields', { fields: { 'a b': 'f32' } }],
    ['fields', { fields: { '': 'f32' } }],
    ['fields', { fields: { ['__proto__']: 'f32' } }],
    ['fields', { fields: { a: 'f16' } }],
    ['fields', { fields: { a: 'bool' } }],
    ['fields', { fields: { a: 'x' } }],
    ['fields', { fields: { a: null } }],
    ['calledFor', { calledFor: undefined }],
    ['check', { check: 'no' }],
    ['valuesAt', { valuesAt: {} }],
    ['reach', { reach: { displacement: 1, growth: 1 } }],
    ['rows', { rows: true }],
    ['resources.on', { resources: {} }],
  ])('%s is refused by name: %o', (argument, changes) => {
    const act = () => (changes === null ? defineEffect(null as never) : define(changes));
    expect(act).toThrow(InvalidArgumentError);
    expect(act).toThrow(expect.objectContaining({ argument }));
  });

  /**
   * @fault Effects: a caller's function returns what does not fit its fields, list or reach
   * @consequence `InvalidArgumentError` names effect and field; the frame before stays
   */
  test.each([
    ['valuesAt', { fields: { by: 'f32' }, valuesAt: () => undefined }],
    ['valuesAt', { fields: { by: 'f32' }, valuesAt: () => null }],
    ['valuesAt', { fields: { by: 'f32' } }],
    ['valuesAt.by', { fields: { by: 'f32' }, valuesAt: () => ({}) }],
    ['valuesAt.by', { fields: { by: 'f32' }, valuesAt: () => ({ by: [1, 2] }) }],
    ['valuesAt.by', { fields: { by: 'f32' }, valuesAt: () => ({ by: '1' }) }],
    ['valuesAt.by', { fields: { by: 'vec3f' }, valuesAt: () => ({ by: [1, 2] }) }],
    ['valuesAt.by', { fields: { by: 'vec3f' }, valuesAt: () => ({ by: 1 }) }],
    ['list.at', { list: { length: () => 1, at: () => undefined } }],
    ['list.at', { list: { length: () => 1, at: () => [1, 2, 3, 4, 5] } }],
    ['list.length', { list: { length: () => Number.NaN, at: () => [] } }],
    ['list.length', { list: { length: () => -1, at: () => [] } }],
    ['reach', { reach: () => 5 }],
    ['reach.displacement', { reach: () => ({ displacement: Number.NaN, growth: 1 }) }],
    ['reach.displacement', { reach: () => ({ displacement: '1', growth: 1 }) }],
    ['reach.growth', { reach: () => ({ displacement: 0, growth: -1 }) }],
  ])('%s of a use is refused by name: %o', (argument, changes) => {
    const act = () => {
      const use = define(changes)({});
      packParameters(effectSetOf([use]), [[{ values: use.valuesAt(PLACE) }]]);
    };
    expect(act).toThrow(InvalidArgumentError);
    expect(act).toThrow(expect.objectContaining({ argument }));
  });

  test('options of shadows that are none are refused by name', () => {
    expect(() => shadows(null as never)).toThrow(expect.objectContaining({ argument: 'shadows' }));
    expect(() => shadows({} as never)).toThrow(expect.objectContaining({ argument: 'lights' }));
  });

  test('a reach of nothing is none', () => {
    expect(define({ reach: () => undefined })({}).reach).toEqual({ displacement: 0, growth: 1 });
  });
});
