// Proves: splats are darkened by shadow maps as in float64, and shaders without shadows have none of it.
import { gpuTest } from '@websplatter/node/gpu-test';
import { describe, expect } from 'vitest';
import { SplatEngine } from '../../../create-engine.ts';
import { type Camera, cameraFromMatrices } from '../../../data/camera/camera.ts';
import type { DepthConvention } from '../../../data/camera/depth-convention.ts';
import { storedDepth } from '../../../data/camera/depth-convention.ts';
import { compareImages, renderReference } from '../../../reference/index.ts';
import { expectAsReference } from '../../../testing/expect-as-reference.ts';
import { randomSplats } from '../../../testing/random-splats.ts';
import { TEST_MODELS, testCameras } from '../../../testing/test-cameras.ts';
import { testGpu } from '../../../testing/test-gpu.ts';
import type { MapDepths } from './shadows.reference.ts';
import { type ShadowLight, shadows } from './shadows.ts';

const SIZE = { widthPx: 48, heightPx: 48 };
const CAMERA = testCameras(1).perspective;
const SET = randomSplats({ count: 600, seed: 71, shDegree: 1, logScales: [-5, -3], colorDc: [-3, 3] });
const MAP = { widthPx: 32, heightPx: 24 };

const gpu = testGpu();

/** Looks down the y axis from 4 above the origin; depths of 0…1, as WebGPU has them. */
const FROM_ABOVE = [1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 0, -4, 1];
const [NEAR, FAR] = [0.5, 8];
const SUN = cameraFromMatrices(
  FROM_ABOVE,
  [0.6, 0, 0, 0, 0, 0.8, 0, 0, 0, 0, -1 / (FAR - NEAR), 0, 0.05, -0.1, -NEAR / (FAR - NEAR), 1],
  { near: NEAR, far: FAR },
);
const LAMP = cameraFromMatrices(
  FROM_ABOVE,
  [2.5, 0, 0, 0, 0, 2.5, 0, 0, 0, 0, -FAR / (FAR - NEAR), -1, 0, 0, (-FAR * NEAR) / (FAR - NEAR), 0],
  { near: NEAR, far: FAR },
);
const REVERSED_LAMP = cameraFromMatrices(
  FROM_ABOVE,
  [2.5, 0, 0, 0, 0, 2.5, 0, 0, 0, 0, NEAR / (FAR - NEAR), -1, 0, 0, (FAR * NEAR) / (FAR - NEAR), 0],
  { near: NEAR, far: FAR },
);
const CONE = { angle: 0.35, penumbra: 0.4, decay: 1.5, distance: 9 } as const;
const PLAIN: DepthConvention = { compare: 'less-equal', mapping: 'projection' };

/** A pattern of floors at several depths and holes between them. */
function depthsOf(camera: Camera, { compare, mapping }: DepthConvention): MapDepths {
  const { widthPx, heightPx } = MAP;
  const empty = compare === 'less-equal' ? 1 : 0;
  const depths = Float32Array.from({ length: widthPx * heightPx }, (_, i) => {
    const [x, y] = [i % widthPx, Math.floor(i / widthPx)];
    const floor = (Math.floor(x / 5) + 2 * Math.floor(y / 4)) % 4;
    return floor === 3 ? empty : storedDepth(3.4 + 0.4 * floor, camera, mapping);
  });
  return { ...MAP, depths };
}

/** Draws depths into a texture: they cannot be copied there. */
function depthTexture(device: GPUDevice, { widthPx, heightPx, depths }: MapDepths): GPUTexture {
  const { RENDER_ATTACHMENT, TEXTURE_BINDING } = GPUTextureUsage;
  const texture = device.createTexture({
    size: [widthPx, heightPx],
    format: 'depth32float',
    usage: RENDER_ATTACHMENT | TEXTURE_BINDING,
  });
  const code = `
    @group(0) @binding(0) var<storage, read> depths: array<f32>;
    @vertex fn corner(@builtin(vertex_index) i: u32) -> @builtin(position) vec4f {
      return vec4f(select(-1.0, 3.0, i == 1u), select(-1.0, 3.0, i == 2u), 0.0, 1.0);
    }
    @fragment fn depth(@builtin(position) place: vec4f) -> @builtin(frag_depth) f32 {
      return depths[u32(place.y) * ${widthPx}u + u32(place.x)];
    }`;
  const module = device.createShaderModule({ code });
  const pipeline = device.createRenderPipeline({
    layout: 'auto',
    vertex: { module },
    fragment: { module, targets: [] },
    depthStencil: { format: 'depth32float', depthWriteEnabled: true, depthCompare: 'always' },
  });
  const values = Float32Array.from(depths);
  const usage = GPUBufferUsage.STORAGE | GPUBufferUsage.COPY_DST;
  const buffer = device.createBuffer({ size: values.byteLength, usage });
  device.queue.writeBuffer(buffer, 0, values);
  const encoder = device.createCommandEncoder();
  const pass = encoder.beginRenderPass({
    colorAttachments: [],
    depthStencilAttachment: {
      view: texture.createView(),
      depthClearValue: 0,
      depthLoadOp: 'clear',
      depthStoreOp: 'store',
    },
  });
  pass.setPipeline(pipeline);
  const entries = [{ binding: 0, resource: { buffer } }];
  pass.setBindGroup(0, device.createBindGroup({ layout: pipeline.getBindGroupLayout(0), entries }));
  pass.draw(3);
  pass.end();
  device.queue.submit([encoder.finish()]);
  return texture;
}

/** A light, and the depths of its map for the reference. */
function lightFrom(
  device: GPUDevice,
  camera: Camera,
  options: Partial<ShadowLight> = {},
): { readonly light: ShadowLight; readonly depths: MapDepths } {
  const depths = depthsOf(camera, options.depth ?? PLAIN);
  const map = depthTexture(device, depths);
  return { light: { map, camera, irradiance: [3, 2.5, 2], ...options }, depths };
}

/** Shadows whose reference knows the contents of the maps. */
function shadowsOf(found: readonly ReturnType<typeof lightFrom>[], steady?: [number, number, number]) {
  const depthsBy = new Map(found.map(({ light, depths }) => [light.map, depths]));
  const options = { lights: found.map(({ light }) => light), steady };
  const use = shadows(options);
  return { ...use, options: { ...options, depthsOf: (map: GPUTexture) => depthsBy.get(map)! } };
}

const LIGHTS: Readonly<Record<string, readonly [Camera, Partial<ShadowLight>]>> = {
  'the sun': [SUN, {}],
  'the sun, in part, with bias and offset': [SUN, { strength: 0.6, bias: -0.01, offset: 0.05 }],
  'the sun, of a host with logarithmic depth': [
    SUN,
    { depth: { compare: 'less-equal', mapping: 'logarithmic' } },
  ],
  'a spot light': [LAMP, { cone: CONE, irradiance: [30, 20, 40] }],
  'a spot light, reversed': [
    REVERSED_LAMP,
    { cone: CONE, irradiance: [30, 20, 40], depth: { compare: 'greater-equal', mapping: 'projection' } },
  ],
  'a spot light, logarithmic': [
    LAMP,
    { cone: { angle: 0.4 }, irradiance: [9, 9, 9], depth: { compare: 'less-equal', mapping: 'logarithmic' } },
  ],
};

describe('shadows', () => {
  for (const [name, [camera, options]] of Object.entries(LIGHTS))
    gpuTest(`of ${name}, on clouds in any place`, async () => {
      const found = lightFrom(gpu.device, camera, options);
      const effects = [shadowsOf([found], [1, 1.2, 1.5])];
      const clouds = Object.values(TEST_MODELS).map((modelMatrix) => ({ set: SET, modelMatrix, effects }));
      for (const count of await expectAsReference(gpu.device, { clouds, camera: CAMERA, ...SIZE }, 2e-4))
        expect(count).toBeGreaterThan(100);
      found.light.map.destroy();
    });

  gpuTest('pictures of four lights, and after a map has been drawn again', async () => {
    const found = Object.values(LIGHTS)
      .slice(0, 4)
      .map(([camera, options]) => lightFrom(gpu.device, camera, options));
    const engine = await SplatEngine.create({ device: gpu.device, accuracy: 'high' });
    const cloud = engine.add(SET);
    const view = engine.createView();
    const picture = async (effects: ReturnType<typeof shadows>[]) => {
      view.render({ camera: CAMERA, clouds: [{ cloud, effects }], ...SIZE });
      return (await view.readPixels()).data;
    };
    const psnr = async (use: ReturnType<typeof shadowsOf>) => {
      const clouds = [{ set: SET, effects: [use] }];
      const { data } = renderReference({ clouds, camera: CAMERA, ...SIZE });
      return compareImages(await picture([use]), data, SIZE).psnrDb;
    };
    expect(await psnr(shadowsOf(found, [1, 1, 1]))).toBeGreaterThan(60);
    expect(await psnr(shadowsOf(found.slice(0, 1)))).toBeGreaterThan(60);
    const lit = await picture([]);
    const [sun] = found;
    const without = shadows({ lights: [{ ...sun.light, strength: 0 }] });
    expect(compareImages(await picture([without]), lit, SIZE).psnrDb).toBeGreaterThan(80);
    const shadowed = await picture([shadows({ lights: [sun.light] })]);
    expect(compareImages(shadowed, lit, SIZE).psnrDb).toBeLessThan(30);
    const { framesDrawn } = engine.counters();
    for (const _ of [0, 1]) await picture([shadows({ lights: [{ ...sun.light, version: 1 }] })]);
    expect(engine.counters().framesDrawn).toBe(framesDrawn + 1);
    await picture([shadows({ lights: [{ ...sun.light, version: 2 }] })]);
    expect(engine.counters().framesDrawn).toBe(framesDrawn + 2);
    const [entry] = view.effects().filter(({ name }) => name === 'shadows');
    expect(entry).toMatchObject({ isOn: true, reason: 'a light casts shadows on it', stages: ['project'] });
    engine.destroy();
  });

  gpuTest('instances', async () => {
    const { light } = lightFrom(gpu.device, SUN);
    const engine = await SplatEngine.create({ device: gpu.device, accuracy: 'high' });
    const cloud = engine.add(SET);
    const view = engine.createView();
    const place = (x: number) => [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, x, 0, 0, 1];
    const effects = [shadows({ lights: [light], steady: [1, 1, 1] })];
    const picture = async (clouds: Parameters<typeof view.render>[0]['clouds']) => {
      view.render({ camera: CAMERA, clouds, ...SIZE });
      return (await view.readPixels()).data;
    };
    const modelMatrices = [...place(0.4), ...place(-0.5)];
    const together = await picture([{ cloud, effects, instances: { modelMatrices } }]);
    const apart = await picture([
      { cloud, effects, modelMatrix: place(0.4) },
      { cloud, effects, modelMatrix: place(-0.5) },
    ]);
    expect(together).toEqual(apart);
    engine.destroy();
  });
});
