import { describe, expect, test } from 'vitest';
import { reflectWgsl } from '../../testing/wgsl-reflect.ts';
import { gpuStruct, roundUp } from './gpu-struct.ts';

const Mixed = gpuStruct('Mixed', {
  first: 'f32',
  pair: 'vec2f',
  count: 'u32',
  position: 'vec3f',
  scale: 'f32',
  linear: 'mat3x3f',
  planes: 'array<vec4f, 6>',
  toClip: 'mat4x4f',
  counts: 'vec2u',
  one: 'array<vec4f, 1>',
  offsets: 'array<vec4u, 2>',
  color: 'vec4f',
  last: 'u32',
});

describe('gpuStruct', () => {
  test('lays fields out by the rules of WGSL', () => {
    const { structs } = reflectWgsl(`${Mixed.wgsl}\n@group(0) @binding(0) var<uniform> mixed: Mixed;`);
    expect(structs[0].size).toBe(Mixed.bytes);
    expect(Object.fromEntries(structs[0].members.map(({ name, offset }) => [name, offset]))).toEqual(
      Mixed.offsets,
    );
  });

  test('writes every field at its offset, columns padded, and nothing else', () => {
    const target = new ArrayBuffer(2 * Mixed.bytes);
    const sequence = (length: number, from: number) => Array.from({ length }, (_, i) => from + i);
    Mixed.write(
      target,
      {
        first: 1,
        pair: [2, 3],
        count: 4_294_967_295,
        position: [5, 6, 7],
        scale: 8,
        linear: sequence(9, 10),
        planes: sequence(24, 100),
        toClip: sequence(16, 400),
        counts: [200, 201],
        one: [300, 301, 302, 303],
        offsets: sequence(8, 500),
        color: [0.25, 0.5, 0.75, 1],
        last: 9,
      },
      Mixed.bytes,
    );
    const floats = new Float32Array(target, Mixed.bytes);
    const words = new Uint32Array(target, Mixed.bytes);
    const at = (field: keyof typeof Mixed.offsets) => Mixed.offsets[field] / 4;
    expect(new Uint8Array(target, 0, Mixed.bytes).every((byte) => byte === 0)).toBe(true);
    expect(floats[at('first')]).toBe(1);
    expect(Array.from(floats.subarray(at('pair'), at('pair') + 2))).toEqual([2, 3]);
    expect(words[at('count')]).toBe(4_294_967_295);
    expect(Array.from(floats.subarray(at('position'), at('position') + 4))).toEqual([5, 6, 7, 8]);
    expect(Array.from(floats.subarray(at('linear'), at('linear') + 12))).toEqual([
      ...[10, 11, 12, 0],
      ...[13, 14, 15, 0],
      ...[16, 17, 18, 0],
    ]);
    expect(Array.from(floats.subarray(at('planes'), at('planes') + 24))).toEqual(sequence(24, 100));
    expect(Array.from(words.subarray(at('counts'), at('counts') + 2))).toEqual([200, 201]);
    expect(Array.from(floats.subarray(at('one'), at('one') + 4))).toEqual([300, 301, 302, 303]);
    expect(Array.from(floats.subarray(at('color'), at('color') + 4))).toEqual([0.25, 0.5, 0.75, 1]);
    expect(Array.from(floats.subarray(at('toClip'), at('toClip') + 16))).toEqual(sequence(16, 400));
    expect(words[at('last')]).toBe(9);
  });

  test('rejects a vector of the wrong length', () => {
    const Pair = gpuStruct('Pair', { pair: 'vec2f' });
    expect(() => Pair.write(new ArrayBuffer(8), { pair: [1, 2, 3] })).toThrow(RangeError);
  });

  test('rejects invalid array types, and values that do not fill an array', () => {
    for (const length of [0, -1, 1.5, Number.NaN])
      expect(() => gpuStruct('List', { list: `array<vec4f, ${length}>` })).toThrow(RangeError);
    const Three = gpuStruct('Three', { list: 'array<vec4f, 3>' });
    expect(() => Three.write(new ArrayBuffer(48), { list: [1, 2, 3, 4] })).toThrow(/takes 12 values, not 4/);
  });

  test('rounds up to multiples', () => {
    expect([0, 1, 255, 256, 257].map((value) => roundUp(value, 256))).toEqual([0, 256, 256, 256, 512]);
  });
});
