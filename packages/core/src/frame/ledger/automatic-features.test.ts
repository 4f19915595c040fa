// Proves: automatic features take part in the stages that they name, and in no others.
import { describe, expect, test } from 'vitest';
import { EFFECT_LIST } from '../../gpu/effects/effect-list.ts';
import type { StageDefinition } from '../../gpu/pipelines.ts';
import { shaderBindings } from '../../gpu/pipelines.ts';
import { linkInput } from '../../gpu/shaders/link-shader.ts';
import { type LinkInput, linkModules } from '../../gpu/shaders/shader-linker.ts';
import { FEATURE_SHADERS } from '../../testing/feature-shaders.ts';
import { allStageVariants, spreadByStage } from '../../testing/stage-variants.ts';
import { withoutConditions } from '../../testing/without-conditions.ts';
import { AUTOMATIC_FEATURES } from './automatic-features.ts';

/** Stages that exist for one effect, and never run without it. */
const OWN_STAGES: Readonly<Record<string, readonly string[]>> = {
  'depth-test': ['resolve-depth'],
  'lower-resolution': ['upscale'],
  levels: ['cut-cells', 'cut-count', 'plan-cut', 'cut-splats', 'touch-links'],
};
/** They pack or merge splats or answer what is asked of a frame, and are no stages of one. */
const BESIDE_FRAMES: readonly string[] = [
  'ingest-rows',
  'repack-sh',
  'morph-sh',
  'merge-chunks',
  'merge-harmonics',
  'pick',
  'cover-points',
  'tile-costs',
];
/** Conditions of code that is linked only together with an effect. */
const IMPLYING: Readonly<Record<string, readonly string[]>> = { 'depth-test': ['DEPTH_LAYER'] };

const variants = await allStageVariants();

/** Hundreds are linked twice for each effect: the short run takes some of each stage. */
const LINKED_EACH = process.env.WEBSPLATTER_FULL === '1' ? Number.POSITIVE_INFINITY : 12;

function variantsWithout(conditions: readonly string[], own: readonly string[] = []): StageDefinition[] {
  const without = variants.filter(
    ({ stage, conditions: met = {} }) => !own.includes(stage) && !conditions.some((name) => met[name]),
  );
  return spreadByStage(without, LINKED_EACH);
}

const linked = new Map<StageDefinition, string>();

/** The text of a variant, linked once for all effects. */
function linkedText(stage: StageDefinition): string {
  const text = linked.get(stage) ?? linkModules(linkInput(stage));
  linked.set(stage, text);
  return text;
}

const namesWithin = new Map<string, readonly string[]>();

/** The root's module and all whose names are in the text of another, among them all that it imports. */
function textsReached({ modules, root }: LinkInput): string[] {
  const reached = new Set([root]);
  for (const name of reached) {
    const text = modules[name];
    const within = namesWithin.get(text) ?? Object.keys(modules).filter((other) => text.includes(other));
    namesWithin.set(text, within);
    for (const other of within) reached.add(other);
  }
  return Array.from(reached, (name) => modules[name]);
}

describe('automatic features', () => {
  test('have names of their own', () => {
    const names = [...AUTOMATIC_FEATURES, ...Object.values(EFFECT_LIST)].map(({ name }) => name);
    expect(new Set(names).size).toBe(names.length);
    for (const name of names) expect(name).toMatch(/^[a-z]+(-[a-z]+)*$/);
  });

  test('are all known to these tests', () => {
    expect(Object.keys(FEATURE_SHADERS)).toEqual(AUTOMATIC_FEATURES.map(({ name }) => name));
  });

  for (const { name, stages } of AUTOMATIC_FEATURES) {
    const { conditions, bindings } = FEATURE_SHADERS[name];
    if (conditions.length === 0) continue;
    test(`${name}: while off, all stages are as in a build without it`, { tags: 'deeper' }, () => {
      const without = variantsWithout([...conditions, ...(IMPLYING[name] ?? [])], OWN_STAGES[name]);
      expect(without.length).toBeGreaterThan(10);
      const stripped = new Map<string, string>();
      for (const stage of without) {
        const input = linkInput(stage);
        const modules = Object.fromEntries(
          Object.entries(input.modules).map(([module, text]) => {
            const known = stripped.get(text) ?? withoutConditions(text, conditions);
            stripped.set(text, known);
            return [module, known];
          }),
        );
        const text = linkedText(stage);
        // Without a word of its conditions, there is nothing to leave out.
        const isAware = textsReached(input).some((each) => conditions.some((name) => each.includes(name)));
        if (isAware) expect(linkModules({ ...input, modules })).toBe(text);
        expect(shaderBindings(text).filter((binding) => bindings.includes(binding.name))).toEqual([]);
      }
      for (const condition of conditions)
        expect([...stripped.values()].join('\n')).not.toMatch(new RegExp(`\\b${condition}\\b`));
    });

    test(`${name}: takes part in the stages that it names, and in no others`, () => {
      const asking = variants.filter(
        ({ stage, conditions: met = {} }) =>
          conditions.some((each) => met[each]) && !BESIDE_FRAMES.includes(stage),
      );
      const own = OWN_STAGES[name] ?? [];
      expect(new Set([...asking.map(({ stage }) => stage), ...own])).toEqual(new Set(stages));
    });
  }
});

test('the sources of a build without a condition have none of its lines', () => {
  const source = `import a::b;
@if(OLD && NEW) import c::{d, e};
struct S {
  @if(NEW) @size(16) x: array<vec4f, 2>,
  y: f32,
}
// @if(NEW) is nothing here { ;
@if(NEW)
fn f(x: f32) -> f32 { if (x > 0.0) { return x; } return 0.0; }
fn g(s: S) {
  @if(!NEW && OLD) let z = h(s.y, 1.0);
  @if(!NEW) let w = 2.0;
  @if(NEW || OLD) let v = 3.0;
  @if(NEW) { let u = vec2f(1.0, 2.0); u.x; }
  @if(NEW) for (var i = 0u; i < 3u; i++) { f(1.0); }
}`;
  const lines = withoutConditions(source, ['NEW']).split('\n');
  expect(lines.map((line) => line.trim()).filter((line) => line !== '')).toEqual([
    'import a::b;',
    'struct S {',
    'y: f32,',
    '}',
    'fn g(s: S) {',
    '@if(OLD) let z = h(s.y, 1.0);',
    'let w = 2.0;',
    '@if(OLD) let v = 3.0;',
    '}',
  ]);
});
