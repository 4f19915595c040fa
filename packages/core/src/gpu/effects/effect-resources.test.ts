import { describe, expect, test } from 'vitest';
import { cullSplats } from '../../stages/cull/cull.ts';
import { project } from '../../stages/project/project.ts';
import { CULL, PROJECT } from '../../testing/effect-stages.ts';
import { allStageVariants } from '../../testing/stage-variants.ts';
import { shaderBindings } from '../pipelines.ts';
import { linkShader } from '../shaders/link-shader.ts';
import { defineEffect } from './define-effect.ts';
import { effectResources, STAGE_BUFFERS } from './effect-resources.ts';
import { effectSetOf, NO_EFFECTS } from './effect-set.ts';

const effect = (name: string, hook: string) =>
  defineEffect<undefined>({
    name,
    label: 'Test',
    about: 'Reads resources.',
    hooks: { color: hook },
    resources: effectResources({ map: 'texture', cells: 'array<vec4<f32>>' }, () => ({}) as never),
    wgsl: `import package::lib::packing::Splat;
import parameters::{${name}Map, ${name}MapSampler, ${name}Cells};
fn ${hook}(color: vec3f, splat: Splat, splatIndex: u32, centerView: vec3f) -> vec3f {
  return textureSampleLevel(${name}Map, ${name}MapSampler, splat.position.xy, 0.0).rgb + ${name}Cells[0].rgb;
}`,
    calledFor: () => 'it is there',
  });

describe('resources', () => {
  test('of several effects are bound side by side, and only in stages whose hooks read them', () => {
    const effects = effectSetOf([effect('first', 'firstColor')(), effect('second', 'secondColor')()]);
    const own = shaderBindings(linkShader(project({ ...PROJECT, effects }))).filter(
      ({ entry }) => entry.binding >= 32,
    );
    expect(own.map(({ name, entry: { binding, ...kind } }) => [binding, name, kind])).toEqual([
      [32, 'firstMap', { texture: { sampleType: 'float', multisampled: false } }],
      [33, 'firstMapSampler', { sampler: { type: 'filtering' } }],
      [34, 'firstCells', { buffer: { type: 'read-only-storage' } }],
      [35, 'secondMap', { texture: { sampleType: 'float', multisampled: false } }],
      [36, 'secondMapSampler', { sampler: { type: 'filtering' } }],
      [37, 'secondCells', { buffer: { type: 'read-only-storage' } }],
    ]);
    expect(linkShader(cullSplats({ ...CULL, effects }))).toBe(linkShader(cullSplats(CULL)));
  });

  test('find the room that stages leave: they bind seven storage buffers at most', async () => {
    const counts = (await allStageVariants())
      .filter(
        ({ stage, effects }) =>
          effects === NO_EFFECTS && ['cull-splats', 'project', 'wide-keys'].includes(stage),
      )
      .map((stage) => {
        const types = shaderBindings(linkShader(stage)).map(({ entry }) => entry.buffer?.type);
        return types.filter((type) => type?.endsWith('storage')).length;
      });
    expect(Math.max(...counts)).toBe(STAGE_BUFFERS);
  });

  test('of unknown kinds or names that are no words are refused', () => {
    const make = (types: Record<string, never>) => () => effectResources(types, () => ({}));
    expect(make({ map: 'texture_3d<f32>' as never })).toThrow(/resources.map is texture_3d<f32>; it must be/);
    expect(make({ map: 'array<Foo>' as never })).toThrow(/resources.map/);
    expect(make({ 'a-b': 'texture' as never })).toThrow(/resources is a-b/);
  });
});
