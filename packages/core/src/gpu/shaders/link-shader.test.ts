import { describe, expect, test } from 'vitest';
import type { TemplateInfo, TypeInfo } from 'wgsl_reflect';
import type { GpuFields, GpuStruct } from '../../data/layout/gpu-struct.ts';
import * as structs from '../../data/layout/structs.ts';
import { allStageVariants } from '../../testing/stage-variants.ts';
import { ResourceType, reflectWgsl, type WgslReflection } from '../../testing/wgsl-reflect.ts';
import type { BindingKind, StageDefinition } from '../pipelines.ts';
import { cullSplats } from '../stages/cull-splats.ts';
import { project } from '../stages/project.ts';
import { linkShader } from './link-shader.ts';

const stageFiles = Object.keys(import.meta.glob('../../../../../shaders/stages/*.wgsl')).map(
  (path) => /([^/]+)\.wgsl$/.exec(path)![1],
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

const TEXTURE_KINDS: Partial<Record<string, BindingKind>> = {
  texture_2d: 'texture',
  texture_depth_2d: 'depth-texture',
  texture_depth_multisampled_2d: 'multisampled-depth-texture',
};

/** Kind of a texture that a shader writes; undefined for other types. */
function storageTextureKind(type: TypeInfo): BindingKind | undefined {
  if (type.name !== 'texture_storage_2d') return undefined;
  const { format, access } = type as TemplateInfo;
  expect(access).toBe('write');
  return `${format!.name} writes` as BindingKind;
}

const describeVariant = ({ stage, conditions }: StageDefinition) =>
  `${stage} ${Object.keys(conditions ?? {}).filter((name) => conditions![name])}`;

describe('linked shaders', () => {
  test('there are variants of every stage', () => {
    expect(new Set(linked.map(({ stage }) => stage.stage))).toEqual(new Set(stageFiles));
  });

  test('have the entry points that their stages name', () => {
    for (const { stage, reflection } of linked) {
      const { compute, vertex, fragment } = reflection.entry;
      if (stage.entryPoint) expect(compute.map(({ name }) => name)).toContain(stage.entryPoint);
      else expect([vertex[0].name, fragment[0].name]).toEqual(['vertexMain', 'fragmentMain']);
    }
  });

  test('bind what their stages declare: names, numbers and kinds', () => {
    for (const { stage, reflection } of linked) {
      const found: Record<string, readonly [number, BindingKind]> = {};
      for (const resource of reflection.getBindGroups().flat()) {
        if (!resource) continue;
        expect(resource.group).toBe(0);
        const isStorage = resource.resourceType === ResourceType.Storage;
        const textureKind = TEXTURE_KINDS[resource.type.name] ?? storageTextureKind(resource.type);
        const storageKind = resource.access === 'read_write' ? 'read-write' : 'read';
        found[resource.name] = [resource.binding, textureKind ?? (isStorage ? storageKind : 'uniform')];
      }
      expect(found, describeVariant(stage)).toEqual(stage.bindings);
    }
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
      linkShader(
        project({
          isOrthographic: false,
          geometryPrecision: 'packed',
          recordPrecision: 'f16',
          shPrecision: 'u8',
          shortKeyBits: null,
          maxColor: 65504,
          storedShDegree: 3,
          shDegree: 3,
          ...changes,
        }),
      );
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
    for (const { wgsl } of linked) expect(wgsl).not.toMatch(/@(if|else|elif)\b|\bimport\b/);
  });

  test('end: every loop counts up to, or down from, a value that cannot change while it runs', () => {
    for (const { stage, wgsl } of linked) {
      expect(wgsl, `${describeVariant(stage)} has an open loop`).not.toMatch(/\b(while|loop)\b/);
      for (const flaw of openLoops(wgsl)) expect.fail(`${describeVariant(stage)}: ${flaw}`);
    }
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
