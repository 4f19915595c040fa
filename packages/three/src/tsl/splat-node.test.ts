import { InvalidArgumentError } from '@websplatter/core';
import {
  attribute,
  cameraPosition,
  cubeTexture,
  dFdx,
  Fn,
  float,
  instancedArray,
  instanceIndex,
  modelWorldMatrixInverse,
  positionLocal,
  storageTexture,
  struct,
  texture,
  texture3D,
  time,
  uniform,
  uniformArray,
  uvec2,
  vec3,
  vec4,
} from 'three/tsl';
import {
  CubeTexture,
  Data3DTexture,
  DataArrayTexture,
  DataTexture,
  DepthTexture,
  NodeFrame,
  Object3D,
  PerspectiveCamera,
  RGBAIntegerFormat,
  Scene,
  StorageTexture,
  Texture,
  UnsignedIntType,
  Vector3,
} from 'three/webgpu';
import { describe, expect, it } from 'vitest';
import type { FrameUse } from '../layer/layer-cloud.ts';
import { splatColor, splatIndex, splatNode, splatOpacity, splatPosition, splatRow } from './splat-node.ts';

const identity = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];
const PLACE = {
  modelMatrix: identity,
  origin: [0, 0, 0],
  viewMatrix: identity,
  projection: { isOrthographic: false, focalPx: [1, 1] },
} as const;

const AT = splatPosition;
const map = () => new DataTexture(new Uint8Array(4), 1, 1);
const video = () => Object.assign(new Texture(), { isVideoTexture: true, name: 'clip' });
const integers = () => new DataTexture(new Uint32Array(4), 1, 1, RGBAIntegerFormat, UnsignedIntType);
const ofStructs = () => {
  const cell = struct({ at: 'vec3', weight: 'float' });
  return instancedArray(1, cell as never)
    .element(0)
    .get('at') as never;
};
const writing = () =>
  Fn(() => {
    const cells = instancedArray(1, 'float');
    cells.element(0).assign(1);
    return float(1);
  })();

describe('splatNode', () => {
  it('has one program for nodes that are made again, with uniforms of their own', () => {
    const [a, b] = [0.5, 2].map((value) => splatNode({ opacity: splatOpacity.mul(uniform(value)) }));
    expect(a.effect).toBe(b.effect);
    expect([a, b].map((use) => use.valuesAt(PLACE))).toEqual([{ value0: 0.5 }, { value0: 2 }]);
    expect(splatNode({ opacity: splatOpacity.add(uniform(1)) }).effect).not.toBe(a.effect);
  });

  it('has hooks and fields only for what its nodes use', () => {
    const moved = splatNode({ position: splatPosition.mul(2) });
    expect(moved.effect.hooks).toEqual({ splat: expect.any(String) });
    expect(moved.valuesAt(PLACE)).toEqual({ origin: [0, 0, 0] });
    const coloured = splatNode({ color: vec3(float(splatIndex).fract()) });
    expect(coloured.effect.hooks).toEqual({ color: expect.any(String) });
    expect(coloured.effect.parameters).toBeNull();
  });

  it('takes rows only if its nodes read them', () => {
    const values = instancedArray(4, 'float');
    const byRow = splatNode({ opacity: values.element(splatRow), color: splatColor.mul(2) });
    expect(byRow.effect.rows).not.toBeNull();
    // All functions of an effect take the same arguments.
    expect(byRow.effect.wgsl).toContain('splatIndex: u32, splatRow: u32) -> Splat');
    expect(byRow.effect.wgsl).toContain('centerView: vec3f, splatRow: u32) -> vec3f');
    const byIndex = splatNode({ opacity: values.element(splatIndex) });
    expect(byIndex.effect.rows).toBeNull();
    expect(byIndex.effect.wgsl).not.toContain('splatRow');
  });

  it('reaches as far as is said; without limit where positions or scales change', () => {
    const reach = { displacement: 0.2, growth: 1 };
    expect(splatNode({ position: splatPosition, reach }).reach).toEqual(reach);
    expect(splatNode({ position: splatPosition }).reach).toEqual({
      displacement: Number.POSITIVE_INFINITY,
      growth: 1,
    });
    expect(splatNode({ opacity: float(1) }).reach).toEqual({ displacement: 0, growth: 1 });
  });

  it('knows where its cloud stands', () => {
    const renderer = { _nodes: { nodeFrame: new NodeFrame() } };
    const cloud = new Object3D();
    cloud.position.set(1, 2, 3);
    cloud.updateMatrixWorld();
    const offset = modelWorldMatrixInverse.mul(vec4(0, 1, 0, 0)).xyz;
    const node = splatNode({ position: splatPosition.add(offset) }) as FrameUse;
    const place = { renderer, scene: new Scene(), camera: new PerspectiveCamera(), object: cloud };
    const inverse = cloud.matrixWorld.clone().invert().elements;
    expect(Object.values(node.inFrame!(place).valuesAt(PLACE)!)).toContainEqual(inverse);
  });

  it('takes time and camera from the frame, and keeps what one frame has', () => {
    const renderer = { _nodes: { nodeFrame: Object.assign(new NodeFrame(), { time: 3 }) } };
    const camera = new PerspectiveCamera();
    camera.position.set(1, 2, 3);
    camera.updateMatrixWorld();
    const place = { renderer, scene: new Scene(), camera, object: camera };
    const node = splatNode({ position: splatPosition.add(cameraPosition.mul(time)) }) as FrameUse;
    const first = node.inFrame!(place);
    renderer._nodes.nodeFrame.time = 4;
    const second = node.inFrame!(place);
    const [at3, at4] = [first, second].map((use) => Object.values(use.valuesAt(PLACE)!));
    expect(at3).toEqual(expect.arrayContaining([3, [1, 2, 3]]));
    expect(at4).toEqual(expect.arrayContaining([4, [1, 2, 3]]));
    expect(first.effect).toBe(second.effect);
  });

  it.each<[string, () => unknown, string]>([
    ['no nodes', () => splatNode({}), 'would change nothing'],
    ['a texture without coordinates', () => splatNode({ color: texture(new DataTexture()).rgb }), '"uv"'],
    ['an array', () => splatNode({ color: uniformArray([new Vector3()]).element(0) as never }), 'a buffer'],
    ['a cube', () => splatNode({ color: cubeTexture(new CubeTexture(), AT).rgb }), 'equirectUV'],
    ['layers', () => splatNode({ color: texture3D(new Data3DTexture(), AT).rgb }), 'layers'],
    ['layers of an array', () => splatNode({ color: texture(new DataArrayTexture(), AT.xy).rgb }), 'layers'],
    ['a video', () => splatNode({ color: texture(video(), AT.xy).rgb }), 'CanvasTexture'],
    ['depth', () => splatNode({ opacity: texture(new DepthTexture(1, 1), AT.xy).r }), 'RenderTarget'],
    ['integers', () => splatNode({ opacity: texture(integers(), AT.xy).r.toFloat() }), 'floats'],
    ['a bias', () => splatNode({ color: texture(map(), AT.xy).bias(float(1)).rgb }), 'level()'],
    ['gathered texels', () => splatNode({ color: texture(map(), AT.xy).gather(0).rgb }), 'textureLoad'],
    ['a derivative', () => splatNode({ opacity: dFdx(AT.x) }), 'dFdx()'],
    [
      'a storage texture',
      () => splatNode({ color: storageTexture(new StorageTexture(1, 1), uvec2(0)).rgb }),
      'compute()',
    ],
    ['structs', () => splatNode({ position: ofStructs() }), 'one buffer for each member'],
    [
      'an atomic buffer',
      () => splatNode({ opacity: float(instancedArray(1, 'uint').toAtomic().element(0)) }),
      'toAtomic',
    ],
    ['a buffer that it writes', () => splatNode({ opacity: writing() }), 'write it in compute()'],
    ['an attribute', () => splatNode({ color: attribute('tangent', 'vec3') }), '"tangent"'],
    ['a mesh’s position', () => splatNode({ position: positionLocal }), '"position"'],
    ['an index of instances', () => splatNode({ opacity: float(instanceIndex) }), 'instanceIndex'],
    ['what is no node', () => splatNode({ opacity: 0.5 as never }), 'opacity is no node'],
    ['a negative reach', () => splatNode({ opacity: float(1), reach: { displacement: -1 } }), 'displacement'],
    ['nothing', () => splatNode(undefined as never), 'would change nothing'],
    ['a colour of what moves', () => splatNode({ position: splatColor }), 'splatColor'],
  ])('refuses %s', (_, make, text) => {
    expect(make).toThrow(InvalidArgumentError);
    expect(make).toThrow(text);
  });

  it('refuses a uniform that is not finite, when a frame asks for it', () => {
    const use = splatNode({ opacity: splatOpacity.mul(uniform(Number.NaN)) });
    expect(() => use.valuesAt(PLACE)).toThrow('finite');
  });
});
