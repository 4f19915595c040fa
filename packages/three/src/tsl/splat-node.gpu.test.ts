import {
  perspectiveCamera,
  type SplatCloud,
  SplatEngine,
  type SplatSet,
  type SplatView,
} from '@websplatter/core';
import {
  antialias,
  brightness,
  depthOfField,
  type EFFECTS,
  type EffectPlace,
  type EffectUse,
  fog,
  grade,
  highlight,
  opacity,
  relight,
  reveal,
  SplatSelection,
  tint,
  volumes,
} from '@websplatter/core/effects';
import { compareImages, type EffectReference, renderReference } from '@websplatter/core/reference';
import { gpuTest, shareTestDevice } from '@websplatter/node/gpu-test';
import {
  Fn,
  float,
  If,
  instancedArray,
  ivec2,
  Loop,
  length,
  mix,
  mx_noise_float,
  smoothstep,
  texture,
  textureLoad,
  uniform,
  vec2,
  vec3,
} from 'three/tsl';
import {
  Color,
  DataTexture,
  FloatType,
  LinearFilter,
  Matrix3,
  NodeFrame,
  Object3D,
  PerspectiveCamera,
  RepeatWrapping,
  RGBAFormat,
  Scene,
  Vector3,
} from 'three/webgpu';
import { beforeAll, describe, expect } from 'vitest';
import type { FrameUse } from '../layer/layer-cloud.ts';
import {
  splatColor,
  splatIndex,
  splatNode,
  splatOpacity,
  splatPosition,
  splatPositionWorld,
  splatRotation,
  splatRow,
  splatScale,
  turned,
} from './splat-node.ts';

const isFull = process.env.WEBSPLATTER_FULL === '1';

const SIZE = { widthPx: 64, heightPx: 48 };
const CAMERA = perspectiveCamera({
  position: [0.4, 0.5, 3],
  target: [0, 0, 0],
  fovYDegrees: 45,
  aspect: 4 / 3,
});
const ORIGIN = [100, -50, 7] as const;
/** Turned about y, doubled, and moved to the camera. */
const MODEL = [1.6, 0, -1.2, 0, 0, 2, 0, 0, 1.2, 0, 1.6, 0, -168.4, 100, 108.8, 1];

/** A slab of coloured splats around ORIGIN. */
function slab(): SplatSet {
  const count = 600;
  const spread = (i: number, step: number) => ((i * step) % 1) - 0.5;
  const filled = (length: number, at: (i: number) => number) =>
    Float32Array.from({ length }, (_, i) => at(i));
  return {
    count,
    origin: ORIGIN,
    positions: filled(3 * count, (i) => spread(i + 1, [0.618, 0.415, 0.719][i % 3])),
    logScales: filled(3 * count, (i) => -3.4 + spread(i, 0.317)),
    rotations: filled(4 * count, (i) => spread(i, 0.233) + (i % 4 === 0 ? 1 : 0)),
    opacityLogits: filled(count, (i) => 4 * spread(i, 0.531)),
    colorDc: filled(3 * count, (i) => 2.4 * spread(i, 0.277)),
    harmonics: { degree: 0, coefficients: new Float32Array(0) },
    fileIndices: Uint32Array.from({ length: count }, (_, i) => i),
    dropped: {},
  };
}

const SET = slab();
let device: GPUDevice;
let cloud: SplatCloud;
let view: SplatView;
beforeAll(async () => {
  device = await shareTestDevice();
  const engine = await SplatEngine.create({ device, accuracy: { preset: 'reference', sortKeyBits: 32 } });
  cloud = engine.add(SET);
  view = engine.createView();
});

const requestOf = (effects: readonly EffectUse[]) => ({
  camera: CAMERA,
  clouds: [{ cloud, modelMatrix: MODEL, effects }],
  ...SIZE,
});

async function draw(effects: readonly EffectUse[]): Promise<Float32Array> {
  view.render(requestOf(effects));
  return (await view.readPixels()).data;
}

type Twin = (place: EffectPlace) => EffectReference;

/** Decibels of `effects` against float64; `twins` are those of the uses of nodes. */
async function psnrDb(effects: readonly EffectUse[], twins: readonly Twin[]): Promise<number> {
  const ofNodes = effects.filter(({ effect }) => effect.name.startsWith('splat-node'));
  const effectReferences = Object.fromEntries(
    ofNodes.map(({ effect }, i) => [effect.name, (_: never, place: EffectPlace) => twins[i](place)]),
  );
  const clouds = [{ set: SET, modelMatrix: MODEL, effects }];
  const { data } = renderReference({ clouds, effectReferences, camera: CAMERA, ...SIZE });
  return compareImages(await draw(effects), data, SIZE).psnrDb;
}

/** Centre in the cloud's space. */
function local([x, y, z]: readonly number[], { origin }: EffectPlace): [number, number, number] {
  return [x + origin[0], y + origin[1], z + origin[2]];
}

/** Centre in the world. */
function world(position: readonly number[], place: EffectPlace): [number, number, number] {
  const [x, y, z] = local(position, place);
  const m = place.modelMatrix;
  const at = (row: number) => m[row] * x + m[4 + row] * y + m[8 + row] * z + m[12 + row];
  return [at(0), at(1), at(2)];
}

const decoded = (value: number) => (value <= 0.04045 ? value / 12.92 : ((value + 0.055) / 1.055) ** 2.4);
const encoded = (value: number) => (value <= 0.0031308 ? value * 12.92 : 1.055 * value ** (1 / 2.4) - 0.055);
const mapped = (color: readonly number[], change: (linear: number, channel: number) => number) =>
  color.map((value, channel) => encoded(change(decoded(value), channel))) as [number, number, number];

describe('nodes', () => {
  gpuTest('of a position: wind by a uniform, in local space far from 0', async () => {
    const phase = uniform(0.7);
    const height = splatPosition.y.sub(ORIGIN[1]);
    const wind = splatNode({
      position: splatPosition.add(vec3(height.mul(6).add(phase).sin().mul(0.2), 0, 0)),
      reach: { displacement: 0.2 },
    });
    const twinAt =
      (value: number): Twin =>
      () => ({
        changeSplat({ position: [x, y, z], ...splat }) {
          return { ...splat, position: [x + 0.2 * Math.sin(6 * y + value), y, z] };
        },
      });
    expect(await psnrDb([wind], [twinAt(0.7)])).toBeGreaterThan(60);
    phase.value = 2;
    expect(await psnrDb([wind], [twinAt(2)])).toBeGreaterThan(60);
    expect(await psnrDb([wind], [twinAt(0.7)])).toBeLessThan(40);
  });

  gpuTest('of scale and opacity: a reveal about a point of the world', async () => {
    const from = uniform(new Vector3(0.2, 0.1, 0));
    const shown = smoothstep(0, 0.4, float(0.9).sub(length(splatPositionWorld.sub(from))));
    const reveal = splatNode({ scale: splatScale.mul(shown), opacity: splatOpacity.mul(shown) });
    const twin: Twin = (place) => ({
      changeSplat(splat) {
        const [x, y, z] = world(splat.position, place);
        const t = Math.min(1, Math.max(0, (0.9 - Math.hypot(x - 0.2, y - 0.1, z)) / 0.4));
        const factor = t * t * (3 - 2 * t);
        const [a, b, c] = splat.logScales;
        const growth = Math.log(factor);
        return { ...splat, opacity: splat.opacity * factor, logScales: [a + growth, b + growth, c + growth] };
      },
    });
    expect(await psnrDb([reveal], [twin])).toBeGreaterThan(60);
    expect(await psnrDb([reveal], [() => ({})])).toBeLessThan(40);
  });

  gpuTest('of a colour: linear light of a lamp, after what moved', async () => {
    const lamp = uniform(new Vector3(0.5, 0.5, 1));
    const glow = uniform(new Color().setRGB(1, 0.6, 0.2));
    const offset = uniform(new Vector3(0.3, 0, 0));
    const distance = length(splatPositionWorld.sub(lamp));
    const relight = splatNode({
      position: splatPosition.add(offset),
      color: splatColor.mul(mix(vec3(0.1), glow, float(1).div(distance.mul(distance).add(1)))),
    });
    const twin: Twin = (place) => ({
      changeSplat: ({ position: [x, y, z], ...splat }) => ({ ...splat, position: [x + 0.3, y, z] }),
      changeColor(color, { position }) {
        const [x, y, z] = world(position, place);
        const near = 1 / (1 + (x - 0.5) ** 2 + (y - 0.5) ** 2 + (z - 1) ** 2);
        return mapped(color, (linear, channel) => linear * (0.1 + near * ([1, 0.6, 0.2][channel] - 0.1)));
      },
    });
    expect(await psnrDb([relight], [twin])).toBeGreaterThan(60);
  });

  gpuTest('with functions, branches, loops and every kind of uniform', async () => {
    const [least, turns, isOn] = [uniform(-3, 'int'), uniform(4, 'uint'), uniform(true)];
    const matrix = uniform(new Matrix3().set(0, 1, 0, 1, 0, 0, 0, 0, 1));
    const faded = Fn(([opacity, index]: [typeof splatOpacity, typeof splatIndex]) => {
      const result = opacity.toVar();
      If(index.mod(3).equal(0), () => {
        Loop(turns, () => {
          result.mulAssign(0.8);
        });
      }).Else(() => {
        result.mulAssign(float(least).add(3.5));
      });
      return result;
    }).setLayout({
      name: 'faded',
      type: 'float',
      inputs: [
        { name: 'opacity', type: 'float' },
        { name: 'index', type: 'uint' },
      ],
    });
    const node = splatNode({
      opacity: isOn.select(faded(splatOpacity, splatIndex), 0),
      color: matrix.mul(splatColor),
    });
    const twin: Twin = () => ({
      changeSplat(splat, index) {
        return { ...splat, opacity: splat.opacity * (index % 3 === 0 ? 0.8 ** 4 : 0.5) };
      },
      changeColor: ([red, green, blue]) => [green, red, blue],
    });
    expect(await psnrDb([node], [twin])).toBeGreaterThan(60);
    isOn.value = false;
    expect(
      await psnrDb([node], [() => ({ changeSplat: (splat) => ({ ...splat, opacity: 0 }) })]),
    ).toBeGreaterThan(60);
  });

  gpuTest('several with functions of the same names, beside other effects', async () => {
    const noise = mx_noise_float(splatPosition);
    const [first, second] = [1, 0.5].map((factor) =>
      splatNode({
        opacity: splatOpacity.mul(noise.mul(0).add(factor)),
        color: splatColor.mul(noise.mul(0).add(factor)),
      }),
    );
    const twinOf =
      (factor: number): Twin =>
      () => ({
        changeSplat: (splat) => ({ ...splat, opacity: splat.opacity * factor }),
        changeColor: (color) => mapped(color, (linear) => linear * factor),
      });
    expect(await psnrDb([tint([1, 0.5, 0.8]), first, second], [twinOf(1), twinOf(0.5)])).toBeGreaterThan(60);
  });

  // A new effect of core enters by its line here: types ask for it.
  const selection = new SplatSelection();
  selection.add(Array.from({ length: SET.count / 3 }, (_, i) => 3 * i));
  const beside = {
    volumes: volumes([
      { shape: 'sphere', mode: 'tint', tint: [1, 0.2, 0.4], center: [0, 0, 0], radius: 0.7 },
    ]),
    reveal: reveal({ from: [0.2, 0, 0], radius: 0.9, softEdge: 0.4 }),
    opacity: opacity(0.6),
    antialias: antialias(),
    depthOfField: depthOfField({ aperture: 0.1, focusDistance: 2 }),
    brightness: brightness(1.8),
    grade: grade({ exposure: 0.4, saturation: 1.5 }),
    tint: tint([1, 0.5, 0.8]),
    highlight: highlight({ selection, color: [1, 0.6, 0], strength: 0.7 }),
    fog: fog({ color: [0.5, 0.6, 0.8], near: 0.5, far: 6 }),
    relight: relight({ lights: [{ kind: 'directional', direction: [1, -3, -2], irradiance: [3, 2, 2] }] }),
  } satisfies Record<keyof typeof EFFECTS | 'relight', EffectUse>;
  const all = splatNode({
    position: splatPosition.add(vec3(uniform(0.1), 0, 0)),
    scale: splatScale.mul(1.2),
    rotation: turned(splatRotation, vec3(0, 1, 2), float(0.6)),
    opacity: splatOpacity.mul(mx_noise_float(splatPosition).mul(0).add(0.8)),
    color: splatColor.mul(vec3(1, 0.5, 0.25)),
    reach: { displacement: 0.2, growth: 1.3 },
  });
  const each = Object.entries(beside);
  // Names clash as much in shaders of several effects, of which the first tier compiles three.
  const groups = isFull
    ? each.map((one) => [one])
    : [0, 1, 2].map((rest) => each.filter((_, i) => i % 3 === rest));
  for (const group of groups) {
    const names = group.map(([name]) => name).join(', ');
    gpuTest(`of everything, beside ${names}`, { tags: 'deeper' }, async () => {
      const twin: Twin = () => ({
        changeSplat({ position: [x, y, z], rotation: [w, i, j, k], logScales: [a, b, c], ...splat }) {
          const [cos, sin] = [Math.cos(0.3), Math.sin(0.3) / Math.hypot(1, 2)];
          const [p, q] = [sin, 2 * sin];
          const growth = Math.log(1.2);
          return {
            ...splat,
            opacity: 0.8 * splat.opacity,
            position: [x + 0.1, y, z],
            logScales: [a + growth, b + growth, c + growth],
            rotation: [
              cos * w - p * j - q * k,
              cos * i + p * k - q * j,
              cos * j + p * w + q * i,
              cos * k + q * w - p * i,
            ],
          };
        },
        changeColor: (color) => mapped(color, (linear, channel) => linear * [1, 0.5, 0.25][channel]),
      });
      const others = group.map(([, use]) => use);
      expect(await psnrDb([all, ...others], [twin])).toBeGreaterThan(60);
    });
  }

  gpuTest('of a rotation: each splat turned about an axis, and undirected ones left', async () => {
    const angle = float(splatIndex.mod(5)).mul(0.5);
    const spin = splatNode({ rotation: turned(splatRotation, vec3(0, 1, 2), angle) });
    const twin: Twin = () => ({
      changeSplat({ rotation: [w, x, y, z], ...splat }, index) {
        const half = 0.25 * (index % 5);
        const [cos, sin] = [Math.cos(half), Math.sin(half) / Math.hypot(1, 2)];
        const [b, c] = [sin, 2 * sin];
        const rotation = [
          cos * w - b * y - c * z,
          cos * x + b * z - c * y,
          cos * y + b * w + c * x,
          cos * z + c * w - b * x,
        ] as const;
        return { ...splat, rotation };
      },
    });
    expect(await psnrDb([spin], [twin])).toBeGreaterThan(60);
    expect(await psnrDb([spin], [() => ({})])).toBeLessThan(40);
    const still = splatNode({ rotation: splatRotation.mul(uniform(0)) });
    expect(await psnrDb([still], [() => ({})])).toBeGreaterThan(60);
  });

  gpuTest('of rows: each splat has the value of its row, beside a uniform', async () => {
    const glow = float(splatRow.mod(7)).div(7).mul(uniform(0.5));
    const lit = splatNode({ opacity: splatOpacity.mul(glow.add(0.5)), color: splatColor.mul(glow) });
    const of = (row: number) => ((row % 7) / 7) * 0.5;
    const twinBy =
      (rowOf: (row: number, index: number) => number): Twin =>
      () => ({
        changeSplat: (splat, index) => ({
          ...splat,
          opacity: splat.opacity * (of(rowOf(splat.row, index)) + 0.5),
        }),
        changeColor: (color, { row }, index) => mapped(color, (linear) => linear * of(rowOf(row, index))),
      });
    expect(await psnrDb([lit], [twinBy((row) => row)])).toBeGreaterThan(60);
    // Splats are stored in another order.
    expect(await psnrDb([lit], [twinBy((_, index) => index)])).toBeLessThan(40);
  });

  gpuTest('of textures and buffers: an image colours, texels fade, a buffer moves', async () => {
    const frame = new Object3D();
    const uploaded = new Map<object, object>();
    const renderer = {
      initTexture() {},
      _attributes: { update() {} },
      _nodes: { nodeFrame: new NodeFrame() },
      info: { compute: { calls: 0 } },
      backend: { device, get: (of: object) => uploaded.get(of) ?? {} },
    };
    const place = { renderer, scene: new Scene(), camera: new PerspectiveCamera(), object: frame };
    const image = new DataTexture();
    image.magFilter = LinearFilter;
    image.minFilter = LinearFilter;
    image.wrapS = RepeatWrapping;
    const fades = new DataTexture(undefined, 1, 1, RGBAFormat, FloatType);
    fades.magFilter = LinearFilter;
    const offsets = instancedArray(SET.count, 'vec3');
    const at = splatPosition.sub(vec3(...ORIGIN));
    const node = splatNode({
      position: splatPosition.add(offsets.element(splatIndex)),
      // Float32 is filtered in the shader, and in the middle of a texel is what it is.
      opacity: splatOpacity.mul(texture(fades, vec2(float(splatIndex.mod(2)).mul(0.5).add(0.25), 0.5)).r),
      scale: splatScale.mul(textureLoad(fades, ivec2(0, 0)).r),
      color: texture(image, at.xy).rgb,
      reach: { displacement: 0.5, growth: 1 },
    }) as FrameUse;
    expect(() => view.render(requestOf([node]))).toThrow(/a renderer of three/);
    const shift = Float32Array.from({ length: 4 * SET.count }, (_, i) => 0.1 * Math.sin(i));
    const buffer = device.createBuffer({
      size: shift.byteLength,
      usage: GPUBufferUsage.STORAGE | GPUBufferUsage.COPY_DST,
    });
    device.queue.writeBuffer(buffer, 0, shift);
    uploaded.set(offsets.value, { buffer });
    uploaded.set(fades, {
      texture: textureOf('rgba32float', 2, 1, new Float32Array([1, 0, 0, 0, 0.25, 0, 0, 0])),
    });
    const colors = [
      [255, 0, 51],
      [0, 204, 255],
    ];
    const twin: Twin = () => ({
      changeSplat({ position: [x, y, z], ...splat }, index) {
        const [dx, dy, dz] = shift.subarray(4 * index);
        return {
          ...splat,
          position: [x + dx, y + dy, z + dz],
          opacity: splat.opacity * (index % 2 === 0 ? 1 : 0.25),
        };
      },
      changeColor(_, { position: [x] }) {
        const u = 2 * x - 0.5;
        const [first, part] = [Math.floor(u), u - Math.floor(u)];
        const channel = (i: number) =>
          colors[Math.abs(first % 2)][i] * (1 - part) + colors[Math.abs((first + 1) % 2)][i] * part;
        return [0, 1, 2].map((i) => encoded(channel(i) / 255)) as [number, number, number];
      },
    });
    const texels = new Uint8Array([...colors[0], 255, ...colors[1], 255]);
    uploaded.set(image, { texture: textureOf('rgba8unorm', 2, 1, texels) });
    expect(await psnrDb([node.inFrame!(place)], [twin])).toBeGreaterThan(45);
    // A texture that three has made anew is bound without another shader.
    colors.reverse();
    texels.set([...colors[0], 255, ...colors[1]]);
    uploaded.set(image, { texture: textureOf('rgba8unorm', 2, 1, texels) });
    expect(await psnrDb([node.inFrame!(place)], [twin])).toBeGreaterThan(45);
    // Nothing is drawn again until a version changes: of a texture, of a buffer, or by a compute pass.
    const rendered = () => view.render(requestOf([node.inFrame!(place)]));
    expect(rendered()).toBe(false);
    image.needsUpdate = true;
    expect(rendered()).toBe(true);
    expect(rendered()).toBe(false);
    renderer.info.compute.calls++;
    expect(rendered()).toBe(true);
  });
});

function textureOf(
  format: GPUTextureFormat,
  width: number,
  height: number,
  texels: Uint8Array<ArrayBuffer> | Float32Array<ArrayBuffer>,
): GPUTexture {
  const usage = GPUTextureUsage.TEXTURE_BINDING | GPUTextureUsage.COPY_DST;
  const made = device.createTexture({ size: [width, height], format, usage });
  device.queue.writeTexture({ texture: made }, texels, { bytesPerRow: texels.byteLength / height }, [
    width,
    height,
  ]);
  return made;
}
