import { describe, expect, test } from 'vitest';
import type { TemplateInfo, VariableInfo } from 'wgsl_reflect';
import type { GpuFields, GpuStruct } from '../../data/layout/gpu-struct.ts';
import * as structs from '../../data/layout/structs.ts';
import { cullSplats } from '../../stages/cull/cull.ts';
import { project } from '../../stages/project/project.ts';
import { PROJECT } from '../../testing/effect-stages.ts';
import { allStageVariants } from '../../testing/stage-variants.ts';
import { ResourceType, reflectWgsl, type WgslReflection } from '../../testing/wgsl-reflect.ts';
import type { StageDefinition } from '../pipelines.ts';
import { type ShaderBinding, shaderBindings } from '../pipelines.ts';
import { linkShader } from './link-shader.ts';

const files = import.meta.glob<string>(
  [
    '../../{stages,features}/*/*.wgsl',
    '!../../features/motion/motion.wgsl',
    '../../../../../shaders/lib/*.wgsl',
  ],
  {
    query: '?raw',
    import: 'default',
    eager: true,
  },
);
const stageFiles = Object.keys(files).flatMap(
  (path) => /(?:stages|features)\/.*\/([^/]+)\.wgsl$/.exec(path)?.[1] ?? [],
);

interface Linked {
  readonly stage: StageDefinition;
  readonly wgsl: string;
  readonly reflection: WgslReflection;
}

const linked: readonly Linked[] = (await allStageVariants()).map((stage) => {
  const wgsl = linkShader(stage);
  return { stage, wgsl, reflection: reflectWgsl(wgsl) };
});

const bindingsIn = ({ reflection }: Linked) =>
  reflection
    .getBindGroups()
    .flat()
    .filter((resource) => resource !== undefined);

const TEXTURES: Partial<Record<string, GPUTextureBindingLayout>> = {
  texture_2d: { sampleType: 'unfilterable-float', multisampled: false },
  texture_depth_2d: { sampleType: 'depth', multisampled: false },
  texture_depth_multisampled_2d: { sampleType: 'depth', multisampled: true },
};

function expectedLayout({
  type,
  resourceType,
  access,
}: VariableInfo): Omit<ShaderBinding['entry'], 'binding'> {
  if (type.name === 'texture_storage_2d') {
    const { format, access: mode } = type as TemplateInfo;
    expect(mode).toBe('write');
    return { storageTexture: { access: 'write-only', format: format!.name as GPUTextureFormat } };
  }
  const texture = TEXTURES[type.name];
  if (texture) return { texture };
  if (resourceType === ResourceType.Uniform) return { buffer: { type: 'uniform' } };
  expect(resourceType).toBe(ResourceType.Storage);
  return { buffer: { type: access === 'read_write' ? 'storage' : 'read-only-storage' } };
}

const describeVariant = ({ stage, conditions }: StageDefinition) =>
  `${stage} ${Object.keys(conditions ?? {}).filter((name) => conditions![name])}`;

describe('linked shaders', () => {
  test('there are variants of every stage', () => {
    expect(new Set(linked.map(({ stage }) => stage.stage))).toEqual(new Set(stageFiles));
  });

  test('name only conditions that hosts set, and hosts set no others', () => {
    const named = Object.values(files).flatMap((text) =>
      [...text.matchAll(/@(?:if|unroll)\(([^)]*)\)/g)].flatMap(([, condition]) => condition.match(/\w+/g)!),
    );
    const effects = ['SPLAT_EFFECTS', 'OPACITY_EFFECTS', 'SCREEN_EFFECTS', 'COLOR_EFFECTS', 'BOUNDS_EFFECTS'];
    const met = linked.flatMap(({ stage: { conditions = {} } }) =>
      Object.keys(conditions).filter((name) => conditions[name]),
    );
    expect(new Set(named)).toEqual(new Set([...met, ...effects]));
  });

  test('have the entry points that their stages name', () => {
    for (const { stage, reflection } of linked) {
      const { compute, vertex, fragment } = reflection.entry;
      if (stage.entryPoint) expect(compute.map(({ name }) => name)).toContain(stage.entryPoint);
      else expect([vertex[0].name, fragment[0].name]).toEqual(['vertexMain', 'fragmentMain']);
    }
  });

  test('have the bindings that a parser of WGSL finds: names, numbers and layouts', () => {
    for (const each of linked) {
      const { stage, wgsl } = each;
      const expected = bindingsIn(each).map((resource): ShaderBinding => {
        expect(resource.group).toBe(0);
        const { name, binding } = resource;
        return { name, entry: { binding, ...expectedLayout(resource) } };
      });
      const found = shaderBindings(wgsl).sort((a, b) => a.entry.binding - b.entry.binding);
      expect(found, describeVariant(stage)).toEqual(expected);
    }
  });

  test('bind nothing for effects, motion and rows, of which these variants have none', () => {
    const bound = new Set(linked.flatMap((each) => bindingsIn(each).map(({ name }) => name)));
    for (const name of ['effects', 'motion', 'motionReaches', 'splatRows']) expect(bound).not.toContain(name);
  });

  test('lay out every struct as the host does: every offset and the size', () => {
    const unseen = new Set(Object.values(structs).flatMap((value) => ('wgsl' in value ? [value.name] : [])));
    for (const { stage, reflection } of linked) {
      const { RECORD_F32: isF32, RECORD_PAPER: isPaper } = stage.conditions ?? {};
      const record = structs.SPLAT_RECORDS[isF32 ? 'f32' : isPaper ? 'paper' : 'f16'];
      const known: Record<string, GpuStruct<GpuFields>> = {
        ...(structs as unknown as Record<string, GpuStruct<GpuFields>>),
        SplatRecord: record as never,
      };
      for (const { name, size, members } of reflection.structs) {
        // Structs used only by functions never reach a buffer.
        if (!(name in known)) continue;
        unseen.delete(name);
        const expected = known[name];
        expect(size, `size of ${name} in ${describeVariant(stage)}`).toBe(expected.bytes);
        const offsets = Object.fromEntries(members.map((member) => [member.name, member.offset]));
        expect(offsets, `${name} in ${describeVariant(stage)}`).toEqual(expected.offsets);
      }
    }
    expect([...unseen]).toEqual([]);
  });

  test('contain no code of unmet conditions', () => {
    const variant = (changes: Partial<Parameters<typeof project>[0]>) =>
      linkShader(project({ ...PROJECT, ...changes }));
    const full = variant({});
    for (const word of ['shRest', 'shBasis1', 'shBasis2', 'shBasis3', 'unpackRotation', 'view.clampX'])
      expect(full).toContain(word);
    const none = variant({ shDegree: 0 });
    for (const word of ['shRest', 'shBasis', 'viewDirection', 'shAboveBase', 'shValue'])
      expect(none).not.toContain(word);
    expect(variant({ shDegree: 1 })).not.toMatch(/shBasis[23]/);
    expect(variant({ shDegree: 2 })).not.toContain('shBasis3');
    expect(variant({ geometryPrecision: 'f32' })).not.toContain('unpackRotation');
    expect(variant({ recordPrecision: 'f32' })).not.toMatch(/\bpack(2x16float|4x8unorm)|packAxis/);
    expect(full).not.toMatch(/packAxis|pack4x8unorm/);
    expect(full).not.toContain('bitcast<f32>(shRest');
    // The orthographic Jacobian is constant: no tangents, nothing to clamp.
    expect(variant({ isOrthographic: true })).not.toMatch(/tangentX|view\.clampX/);
    expect(full).not.toContain('shortDepthKey');
    expect(variant({ shortKeyBits: 16 })).toContain('SORT_KEY_BITS = 16');
    const cull = { isOrthographic: false, geometryPrecision: 'packed', extent: 'opacity' } as const;
    expect(linkShader(cullSplats({ ...cull, culling: 'frustum' }))).not.toMatch(
      /screenCovariance|reachInAxes/,
    );
    expect(linkShader(cullSplats({ ...cull, culling: 'bounding-box' }))).not.toContain('FARTHEST_CENTER_PX');
    // At degree 0 no coefficients are read, so their precision makes no difference.
    expect(variant({ shDegree: 0, shPrecision: 'f32' })).toBe(none);
    for (const { stage, wgsl } of linked) {
      expect(wgsl).not.toMatch(/@(if|else|elif)\b|\bimport\b/);
      const isStacked = stage.conditions?.STACKED === true;
      expect(/stackedAlpha|cutoffGaussian/.test(wgsl), describeVariant(stage)).toBe(isStacked);
    }
  });

  test('end: every loop counts up to, or down from, a value that cannot change while it runs', () => {
    for (const { stage, wgsl } of linked) {
      expect(wgsl, `${describeVariant(stage)} has an open loop`).not.toMatch(/\b(while|loop)\b/);
      for (const flaw of openLoops(wgsl)) expect.fail(`${describeVariant(stage)}: ${flaw}`);
    }
  });

  test('guards: loops of tile-rasterize count by one, so that Dawn adds no counters of its own', () => {
    const blending = linked.filter(({ stage }) => stage.stage === 'tile-rasterize');
    expect(blending.length).toBeGreaterThan(0);
    for (const { wgsl } of blending)
      for (const [, header] of wgsl.matchAll(/\bfor\s*\(([^)]*)\)/g))
        expect(header).toMatch(/^var (\w+)\s*=\s*[^;]+;\s*\1\s*<\s*\w+;\s*\1\+\+$/);
  });

  test('the check of loops finds open loops', () => {
    const loop = (header: string) => openLoops(`fn f() { for (${header}) { } }`).length;
    expect(loop('var i = 0u; i < 4u; i++')).toBe(0);
    expect(loop('var i = lane; i < frame.pageCount; i += STEP')).toBe(0);
    expect(loop('var i = STEP / 2u; i > 0u; i >>= 1u')).toBe(0);
    expect(loop('var i = 0u; i < atomicLoad(&flag); i++')).toBe(1);
    expect(loop('var i = 0u; flags[i] == 0u; i++')).toBe(1);
    expect(loop('var i = 0u; i < counts[0]; i++')).toBe(1);
    expect(loop('; ; ')).toBe(1);
    expect(loop('var i = 0u; i < 4u; j++')).toBe(1);
  });
});

/**
 * Returns the loops whose end could depend on memory that another workgroup writes. A loop is safe
 * if its own counter is compared with, and moved by, a number, a constant, a local value or a
 * member of a uniform (by name: not an index, a call or a pointer).
 */
function openLoops(wgsl: string): string[] {
  const operand = String.raw`(?:\d+u?|[A-Za-z_]\w*(?:\.\w+)?)(?:\s*\/\s*\d+u?)?`;
  const header = new RegExp(
    String.raw`^var (\w+) = ${operand}; \1 (?:<|>|<=|>=) ${operand}; \1(?:\+\+|--| (?:\+|-|>>|<<)= ${operand})$`,
  );
  // Headers of safe loops have no parentheses; headers with parentheses do not match.
  return [...wgsl.matchAll(/\bfor\s*\(((?:[^()]|\([^()]*\))*)\)\s*\{/g)]
    .map(([, text]) => text.replace(/\s+/g, ' ').trim())
    .filter((text) => !header.test(text));
}
