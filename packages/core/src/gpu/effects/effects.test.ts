// Proves: stages without effects are those of a build without any.

import { describe, expect, test } from 'vitest';
import documentation from '../../../../../docs/effects.md?raw';
import { InvalidArgumentError } from '../../data/errors.ts';
import { identity4 } from '../../data/math/mat4.ts';
import { referencesOf } from '../../reference/effects/references.ts';
import { cullSplats } from '../../stages/cull/cull.ts';
import { project } from '../../stages/project/project.ts';
import { EFFECT_EXAMPLES } from '../../testing/effect-examples.ts';
import { CULL, PROJECT } from '../../testing/effect-stages.ts';
import { allStageVariants, spreadByStage } from '../../testing/stage-variants.ts';
import { reflectWgsl } from '../../testing/wgsl-reflect.ts';
import type { StageDefinition } from '../pipelines.ts';
import { shaderBindings } from '../pipelines.ts';
import { linkInput, linkShader } from '../shaders/link-shader.ts';
import { linkModules } from '../shaders/shader-linker.ts';
import { reachOf, usesOf } from './cloud-effects.ts';
import { defineEffect } from './define-effect.ts';
import type { SplatEffect } from './effect.ts';
import { EFFECT_LIST, placeInList } from './effect-list.ts';
import { changesOrder, type EffectSet, effectSetOf } from './effect-set.ts';
import { EFFECTS } from './effects.ts';
import { opacity } from './opacity/opacity.ts';
import { tint } from './tint/tint.ts';
import { volumes } from './volumes/volumes.ts';

const stagesWith = (effects: EffectSet) => [
  cullSplats({ ...CULL, effects }),
  cullSplats({ ...CULL, culling: 'frustum', effects }),
  project({ ...PROJECT, effects }),
];

/**
 * Checks that the stage's text is the same without the effects' own modules, and contains none of
 * their code.
 */
function expectNothingOf(effects: readonly SplatEffect[], stage: StageDefinition): void {
  const input = linkInput(stage);
  const unknown = effects.map(({ name }) => `package::effects::${name.replaceAll('-', '_')}`);
  const modules = Object.fromEntries(
    Object.entries(input.modules).filter(([name]) => !unknown.includes(name)),
  );
  const text = linkModules(input);
  expect(text).toBe(linkModules({ ...input, modules }));
  for (const { hooks, parameters } of effects) {
    for (const hook of Object.values(hooks)) expect(text).not.toContain(hook);
    if (parameters) expect(text).not.toContain(`struct ${parameters.name}`);
  }
}

const sway = defineEffect<{ by: number }, { by: 'f32' }>({
  name: 'test-sway',
  label: 'Sway',
  about: 'Moves everything.',
  hooks: { splat: 'swaySplat' },
  // Braces begin lines, because the reflection of WGSL in this test looks for them there.
  wgsl: `import package::lib::packing::Splat;
import parameters::TestSway;
fn swaySplat(splat: Splat, splatIndex: u32, parameters: TestSway) -> Splat {
  var moved = splat;
  moved.position.x += parameters.by;
  return moved;
}`,
  fields: { by: 'f32' },
  calledFor: ({ by }) => (by === 0 ? null : 'there is wind'),
  valuesAt: ({ by }) => ({ by }),
  reach: ({ by }) => ({ displacement: Math.abs(by), growth: 1 }),
});

describe('effects', () => {
  test('have a folder and a reference each', () => {
    const names = Object.values(EFFECT_LIST).map(({ name }) => name);
    expect(Object.keys(EFFECT_LIST)).toEqual(
      names.map((name) => name.replace(/-(.)/g, (_, first) => first.toUpperCase())),
    );
    expect(Object.values(EFFECTS).map(({ effect }) => placeInList(effect))).toEqual([...names.keys()]);
    // Relighting and shadows take a host's lights, and have tests of their own.
    const shaders = Object.keys(import.meta.glob(['./*/*.wgsl', '!./relight/*', '!./shadows/*']));
    expect(shaders).toEqual(names.map((name) => `./${name}/${name}.wgsl`).toSorted());
    const place = {
      modelMatrix: [],
      origin: [0, 0, 0],
      viewMatrix: [],
      projection: { isOrthographic: false, focalPx: [1, 1] },
    } as const;
    expect(referencesOf(EFFECT_EXAMPLES, place)).toHaveLength(names.length);
  });

  test('have a row each in docs/effects.md, in their order, which names their options', () => {
    const [, table] = documentation.split('## Use the built-in effects');
    const rows = [...table.split('## ')[0].matchAll(/^\| `(.*?)` \| (.*?) \| .*\w.* \|$/gm)];
    expect(rows.map(([, name]) => name)).toEqual(Object.keys(EFFECT_LIST));
    for (const [i, { options }] of EFFECT_EXAMPLES.entries())
      if (typeof options === 'object' && !Array.isArray(options))
        for (const option of Object.keys(options!)) expect(rows[i][2]).toContain(option);
  });

  for (const use of EFFECT_EXAMPLES) {
    const { effect } = use;
    test(`${effect.name}: gives a reason, and is on if it gives one`, () => {
      expect(use.reason).toMatch(/^[a-z0-9].*[^.]$/);
      const set = effectSetOf([use]);
      const texts = stagesWith(set).map((stage) => linkModules(linkInput(stage)));
      for (const hook of Object.values(effect.hooks))
        expect(texts.some((text) => text.includes(hook))).toBe(true);
    });

    test(`${effect.name}: with all the others used, stages are as in a build without it`, () => {
      const others = effectSetOf(usesOf({ effects: EFFECT_EXAMPLES.filter((other) => other !== use) }));
      for (const stage of stagesWith(others)) expectNothingOf([effect], stage);
    });
  }

  test('that are given fractions without an end say them in three digits', () => {
    expect(tint([1 / 3, 1, 2 / 3]).reason).toBe('colours are multiplied by 0.333, 1, 0.667');
  });

  // Hundreds of variants, each linked twice: in the short run, some of each stage stand for all.
  const linkedEach = process.env.WEBSPLATTER_FULL === '1' ? Number.POSITIVE_INFINITY : 12;
  test('that are not used leave all stages as in a build without effects', { tags: 'deeper' }, async () => {
    for (const stage of spreadByStage(await allStageVariants(), linkedEach))
      expectNothingOf(
        Object.values(EFFECTS).map(({ effect }) => effect),
        stage,
      );
  });

  test('all together link, and their parameters lie where the host writes them', () => {
    const uses = usesOf({ effects: [sway({ by: 1 }), ...EFFECT_EXAMPLES] });
    const listed = Object.values(EFFECT_LIST).map(({ name }) => name);
    expect(uses.map(({ effect }) => effect.name)).toEqual(['test-sway', ...listed]);
    const set = effectSetOf(uses);
    for (const stage of stagesWith(set)) {
      const { structs } = reflectWgsl(linkModules(linkInput(stage)));
      const effects = structs.find(({ name }) => name === 'Effects')!;
      expect(effects.size).toBe(set.parameterBytes);
      let end = 0;
      for (const { parameters } of set.linked) {
        if (!parameters) continue;
        const member = effects.members.find(({ type }) => type.name === parameters.name)!;
        expect(member.offset).toBe(Math.ceil(end / 16) * 16);
        end = member.offset + parameters.bytes;
      }
    }
  });

  // link-shader.test.ts: stages without effects bind nothing for them.
  test('stages are those without effects if no effect acts in them', () => {
    const colorsOnly = effectSetOf(EFFECT_EXAMPLES.filter(({ effect }) => effect.name === 'tint'));
    expect(cullSplats({ ...CULL, effects: colorsOnly })).toEqual(cullSplats(CULL));
  });

  test('all together leave stages within the eight storage buffers that every device has', () => {
    const effects = effectSetOf(usesOf({ effects: EFFECT_EXAMPLES }));
    for (const stage of [cullSplats({ ...CULL, effects }), project({ ...PROJECT, effects })]) {
      const buffers = shaderBindings(linkShader(stage)).map(({ entry }) => entry.buffer?.type);
      expect(buffers.filter((type) => type?.endsWith('storage')).length).toBeLessThanOrEqual(8);
    }
  });

  test('need another order of splats for other values of any hook but the one of colours', () => {
    const changed = ['splat', 'opacity', 'screen', 'bounds', 'color'].map((hook) =>
      changesOrder({ [hook]: 'f' }),
    );
    expect(changed).toEqual([true, true, true, true, false]);
    expect(changesOrder({ color: 'f', screen: 'g' })).toBe(true);
    expect(changesOrder({ color: 'f', splat: undefined })).toBe(false);
  });

  test('that change nothing are not applied', () => {
    expect(usesOf({ opacity: 1, effects: [sway({ by: 0 })] })).toEqual([]);
    expect(effectSetOf(usesOf({}))).toBe(effectSetOf(usesOf({ opacity: 1 })));
    const half = opacity(0.5);
    expect(usesOf({ opacity: 1, effects: [half] })).toEqual([half]);
    expect(() => usesOf({ opacity: 0.5, effects: [half] })).toThrow(/opacity is used twice/);
  });

  test('that are lists of volumes act one after another', () => {
    const [hole, lamp] = [
      { shape: 'sphere', mode: 'hide' },
      { shape: 'sphere', mode: 'tint', tint: [2, 2, 2] },
    ] as const;
    const uses = usesOf({ effects: [volumes([lamp]), sway({ by: 1 }), volumes([hole])] });
    expect(uses.map(({ effect, options }) => [effect.name, options])).toEqual([
      ['test-sway', { by: 1 }],
      ['volumes', [lamp, hole]],
    ]);
    const many = volumes(Array(200).fill(hole));
    expect(() => usesOf({ effects: [many, many] })).toThrow('There are 400 volumes');
  });

  test('reach as far as their displacements and growths together', () => {
    const sways = usesOf({ effects: [sway({ by: -2 })] });
    expect(reachOf(sways, [identity4()])).toEqual({ displacement: 2, growth: 1 });
    expect(reachOf([], [identity4()])).toEqual({ displacement: 0, growth: 1 });
  });

  test('that move splats in the world reach as far in the smallest place of the cloud', () => {
    const volume = { shape: 'sphere', mode: 'displace', offset: [0, 3, 4] } as const;
    const uses = [volumes([volume]), sway({ by: 1 })];
    const scaledBy = (scale: number) => [scale, 0, 0, 0, 0, 0, scale, 0, 0, -scale, 0, 0, 7, 8, 9, 1];
    const reach = (...scales: number[]) => reachOf(uses, scales.map(scaledBy)).displacement;
    expect(reach(1)).toBeGreaterThanOrEqual(6);
    expect(reach(2, 0.5)).toBe(reach(0.5));
    expect(reach(0.5)).toBeGreaterThanOrEqual(11);
    expect(reach(0)).toBe(1);
  });

  test('that contradict each other, or do nothing, are rejected', () => {
    expect(() => usesOf({ effects: [sway({ by: 1 }), sway({ by: 2 })] })).toThrow(/test-sway is used twice/);
    expect(() => usesOf({ opacity: 2 })).toThrow(InvalidArgumentError);
    const none = { label: '', about: '', wgsl: '', calledFor: () => null };
    expect(() => defineEffect({ ...none, name: 'Wind', hooks: { splat: 'a' } })).toThrow(/"Wind"/);
    expect(() => defineEffect({ ...none, name: 'wind', hooks: {} })).toThrow(/no hooks/);
    for (const condition of ['@if(SH_4)', '@if (!SH_1)', '@unroll(COUNT)'])
      expect(() =>
        defineEffect({ ...none, name: 'wind', hooks: { splat: 'a' }, wgsl: `${condition} fn a() {}` }),
      ).toThrow(condition);
  });
});
