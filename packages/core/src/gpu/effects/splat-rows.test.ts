// Proves: rows are in shaders and in memory only for effects that take them.

import { describe, expect, test } from 'vitest';
import { SplatSelection } from '../../data/splats/splat-selection.ts';
import { motion } from '../../features/motion/motion.gpu.ts';
import { cullSplats } from '../../stages/cull/cull.ts';
import { project } from '../../stages/project/project.ts';
import { EFFECT_EXAMPLES } from '../../testing/effect-examples.ts';
import { CULL, PROJECT } from '../../testing/effect-stages.ts';
import { shaderBindings } from '../pipelines.ts';
import { linkShader } from '../shaders/link-shader.ts';
import { usesOf } from './cloud-effects.ts';
import { defineEffect } from './define-effect.ts';
import type { EffectRows } from './effect.ts';
import { effectResources } from './effect-resources.ts';
import { effectSetOf } from './effect-set.ts';
import { splatRows } from './splat-rows.ts';

const colored = (rows?: EffectRows) =>
  defineEffect<undefined>({
    name: 'row-colored',
    label: 'Rows',
    about: 'Colours by a value per row.',
    hooks: { color: 'rowColor' },
    rows,
    resources: effectResources({ values: 'array<f32>' }, () => ({}) as never),
    wgsl: `import package::lib::packing::Splat;
import parameters::rowColoredValues;
fn rowColor(color: vec3f, splat: Splat, splatIndex: u32, centerView: vec3f${rows ? ', row: u32' : ''}) -> vec3f {
  return color * rowColoredValues[${rows ? 'row' : 'splatIndex'}];
}`,
    calledFor: () => 'rows have values',
  })();

const namesOf = (stage: Parameters<typeof linkShader>[0]) =>
  shaderBindings(linkShader(stage)).map(({ name }) => name);

describe('rows', () => {
  test('are bound as a texture of integers, and only in stages whose hooks take them', () => {
    const effects = effectSetOf([colored(splatRows)]);
    const bound = shaderBindings(linkShader(project({ ...PROJECT, effects })));
    expect(bound.find(({ name }) => name === 'splatRows')!.entry).toEqual({
      binding: 21,
      texture: { sampleType: 'uint', multisampled: false },
    });
    // With a buffer of values, within what every device has.
    const buffers = bound.filter(({ entry }) => entry.buffer?.type?.endsWith('storage'));
    expect(buffers.length).toBeLessThanOrEqual(8);
    expect(linkShader(cullSplats({ ...CULL, effects }))).toBe(linkShader(cullSplats(CULL)));
  });

  // link-shader.test.ts: stages without effects bind no rows.
  test('are not in shaders of other effects', () => {
    const effects = effectSetOf([colored()]);
    const shader = linkShader(project({ ...PROJECT, effects }));
    expect(shader).not.toMatch(/splatRows|rowOf/);
  });

  test('that are no rows are refused by name', () => {
    for (const rows of [true, {}, 'rows'] as never[]) expect(() => colored(rows)).toThrow(/^rows/);
  });

  test('come before level, selection and parameters', () => {
    const selection = new SplatSelection();
    const all = defineEffect<undefined, { by: 'f32' }>({
      name: 'takes-all',
      label: 'All',
      about: 'Takes all.',
      hooks: { splat: 'allSplat', color: 'allColor', opacity: 'allOpacity' },
      rows: splatRows,
      takesLevel: true,
      selection: () => selection,
      fields: { by: 'f32' },
      wgsl: `import package::lib::packing::Splat;
import package::lib::visible_ellipse::ScreenSplat;
import parameters::TakesAll;
fn allSplat(splat: Splat, splatIndex: u32, row: u32, selected: bool, parameters: TakesAll) -> Splat { return splat; }
fn allOpacity(opacity: f32, onScreen: ScreenSplat, dilationPx2: f32, parameters: TakesAll) -> f32 { return opacity; }
fn allColor(color: vec3f, splat: Splat, splatIndex: u32, centerView: vec3f, row: u32, level: u32, selected: bool, parameters: TakesAll) -> vec3f { return color; }`,
      calledFor: () => 'it takes all',
      valuesAt: () => ({ by: 1 }),
    });
    const shader = linkShader(project({ ...PROJECT, effects: effectSetOf([all()]) }));
    const calls = [...shader.matchAll(/changed = (all\w+)\((.*)\);/g)].map(([, name, given]) => [
      name,
      given,
    ]);
    expect(Object.fromEntries(calls)).toEqual({
      allSplat: 'changed, splatIndex, rowOf(splatIndex), isSelected(splatIndex, 0u), effects.takesAllValues',
      allOpacity: 'changed, onScreen, dilationPx2, effects.takesAllValues',
      allColor:
        'changed, splat, splatIndex, centerView, rowOf(splatIndex), levelOf(splatIndex), isSelected(splatIndex, 0u), effects.takesAllValues',
    });
    // Beside motion and all other effects, nothing is bound where something else is.
    const uses = usesOf({ effects: [...EFFECT_EXAMPLES, all(), colored(splatRows)] });
    const effects = effectSetOf([motion({ time: 0, range: [0, 1] }), ...uses]);
    for (const stage of [cullSplats({ ...CULL, effects }), project({ ...PROJECT, effects })]) {
      const bindings = shaderBindings(linkShader(stage)).map(({ entry }) => entry.binding);
      expect(bindings).toEqual([...new Set(bindings)]);
      expect(namesOf(stage)).toEqual(expect.arrayContaining(['splatRows', 'motion', 'selectedBits']));
    }
  });
});
