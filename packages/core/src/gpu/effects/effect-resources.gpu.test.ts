// Proves: effects read textures and buffers of the caller's, and turn splats, as in float64.
import { gpuTest, shareTestDevice } from '@websplatter/node/gpu-test';
import { beforeAll, describe, expect } from 'vitest';
import { SplatEngine } from '../../create-engine.ts';
import { InvalidArgumentError } from '../../data/errors.ts';
import type { SplatSet } from '../../data/splats/splat-set.ts';
import type { ReferenceFunction } from '../../reference/effects/references.ts';
import { compareImages, renderReference } from '../../reference/index.ts';
import { expectAsReference } from '../../testing/expect-as-reference.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { TEST_MODELS, testCameras } from '../../testing/test-cameras.ts';
import type { SplatView } from '../../views/splat-view.ts';
import { defineEffect } from './define-effect.ts';
import type { EffectUse } from './effect.ts';
import { effectResources, type GivenResource } from './effect-resources.ts';

const SIZE = { widthPx: 48, heightPx: 48 };
const camera = testCameras(1).perspective;

/** Spheres: without effects their shaders would leave rotations out. */
function balls(count: number): SplatSet {
  const set = randomSplats({ count, seed: 70, shDegree: 0, logScales: [-3.5, -2] });
  for (let i = 0; i < set.count; i++) set.logScales.fill(set.logScales[3 * i], 3 * i, 3 * i + 3);
  return set;
}
const SET = balls(600);

/** Flattens splats to disks and turns them about z, each by an angle of its own. */
const spin = defineEffect<{ angles: GivenResource; numbers: ArrayLike<number> }>({
  name: 'test-spin',
  label: 'Spin',
  about: 'Turns splats.',
  hooks: { splat: 'spinSplat' },
  resources: effectResources({ angles: 'array<vec2f>' }, ({ angles }) => ({ angles })),
  wgsl: `import package::lib::packing::Splat;
import parameters::testSpinAngles;
fn spinSplat(splat: Splat, splatIndex: u32) -> Splat {
  // Cosine and sine of half the angle: those of devices are inexact.
  let half = testSpinAngles[splatIndex];
  let q = splat.rotation;
  var turned = splat;
  turned.scale.x *= 0.05;
  turned.rotation = half.x * q + half.y * vec4f(-q.w, -q.z, q.y, q.x);
  return turned;
}`,
  calledFor: () => 'splats are turned',
});

const paint = defineEffect<{ image: GivenResource; texels: GivenResource }>({
  name: 'test-paint',
  label: 'Paint',
  about: 'Colours splats by an image.',
  hooks: { color: 'paintColor' },
  resources: effectResources({ image: 'texture', texels: 'texels' }, ({ image, texels }) => ({
    image,
    texels,
  })),
  wgsl: `import package::lib::packing::Splat;
import parameters::{testPaintImage, testPaintImageSampler, testPaintTexels};
fn paintColor(color: vec3f, splat: Splat, splatIndex: u32, centerView: vec3f) -> vec3f {
  let uv = 0.5 + 0.4 * splat.position.xy;
  let smoothed = textureSampleLevel(testPaintImage, testPaintImageSampler, uv, 0.0).rgb;
  return smoothed * textureLoad(testPaintTexels, vec2u(splatIndex % 4u, 0u), 0).rgb;
}`,
  calledFor: () => 'an image colours it',
});

/** Colours of a 2×2 image, from the top left. */
const CORNERS = [
  [1, 0, 0],
  [0, 1, 0],
  [0, 0, 1],
  [1, 1, 0],
];
/** Cannot be filtered on every device. */
const TEXELS = [1, 0.5, 0.25, 1, 0.125, 1, 0.75, 1, 1, 1, 1, 1, 0.3, 0.6, 0.9, 1];

const effectReferences: Record<string, ReferenceFunction> = {
  'test-spin': ({ numbers }: { numbers: ArrayLike<number> }) => ({
    changeSplat({ rotation: [w, x, y, z], logScales: [a, b, c], ...splat }, index) {
      const [cos, sin] = [numbers[2 * index], numbers[2 * index + 1]];
      const rotation = [cos * w - sin * z, cos * x - sin * y, cos * y + sin * x, cos * z + sin * w] as const;
      return { ...splat, rotation, logScales: [a + Math.log(0.05), b, c] };
    },
  }),
  'test-paint': () => ({
    changeColor(_, { position: [x, y] }, index) {
      const at = (value: number) => Math.min(1, Math.max(0, 2 * (0.5 + 0.4 * value) - 0.5));
      const [u, v] = [at(x), at(y)];
      const weights = [(1 - u) * (1 - v), u * (1 - v), (1 - u) * v, u * v];
      const channel = (i: number) =>
        TEXELS[4 * (index % 4) + i] * weights.reduce((sum, weight, j) => sum + weight * CORNERS[j][i], 0);
      return [channel(0), channel(1), channel(2)];
    },
  }),
};

let device: GPUDevice;
let engine: SplatEngine;
let view: SplatView;
beforeAll(async () => {
  device = await shareTestDevice();
  engine = await SplatEngine.create({ device, accuracy: 'high' });
  view = engine.createView();
});

function bufferOf(numbers: Float32Array<ArrayBuffer>, usage = GPUBufferUsage.STORAGE): GPUBuffer {
  const buffer = device.createBuffer({ size: numbers.byteLength, usage: usage | GPUBufferUsage.COPY_DST });
  device.queue.writeBuffer(buffer, 0, numbers);
  return buffer;
}

function textureOf(
  format: GPUTextureFormat,
  [width, height]: [number, number],
  texels: ArrayLike<number>,
  descriptor: Partial<GPUTextureDescriptor> = {},
): GPUTexture {
  const usage = GPUTextureUsage.TEXTURE_BINDING | GPUTextureUsage.COPY_DST;
  const texture = device.createTexture({ size: [width, height], format, usage, ...descriptor });
  const data = format === 'rgba32float' ? Float32Array.from(texels) : Uint8Array.from(texels);
  device.queue.writeTexture({ texture }, data, { bytesPerRow: data.byteLength / height }, [width, height]);
  return texture;
}
const imageOf = (corners: readonly (readonly number[])[]) =>
  textureOf(
    'rgba8unorm',
    [2, 2],
    corners.flatMap((rgb) => [...rgb.map((value) => 255 * value), 255]),
  );

/** Cosine and sine of half the angle of each splat. */
function anglesOf(factor: number): Float32Array<ArrayBuffer> {
  const half = (i: number) => (factor * (i % 7)) / 2;
  return Float32Array.from({ length: 2 * SET.count }, (_, i) =>
    i % 2 === 0 ? Math.cos(half(i >> 1)) : Math.sin(half(i >> 1)),
  );
}

describe('resources of effects', () => {
  for (const geometryPrecision of ['f32', 'packed'] as const)
    gpuTest(`a buffer of angles turns round splats: every splat, ${geometryPrecision}`, async () => {
      const numbers = anglesOf(0.4);
      const effects = [spin({ angles: bufferOf(numbers), numbers })];
      const clouds = [{ set: SET, effects, modelMatrix: TEST_MODELS.sheared }];
      const options = { clouds, camera, accuracy: { geometryPrecision }, effectReferences, ...SIZE };
      for (const count of await expectAsReference(device, options, 1e-4)) expect(count).toBeGreaterThan(50);
    });

  gpuTest('textures, filtered and not, beside a buffer; replaced ones are bound in place', async () => {
    const cloud = engine.add(SET);
    const psnrDb = async (numbers: Float32Array<ArrayBuffer>, drawnBy = numbers) => {
      const texels = textureOf('rgba32float', [4, 1], TEXELS);
      const given = { image: imageOf(CORNERS), texels };
      const effects = [spin({ angles: bufferOf(numbers), numbers: drawnBy }), paint(given)];
      view.render({ camera, clouds: [{ cloud, effects }], ...SIZE });
      const { data } = renderReference({
        clouds: [{ set: SET, effects }],
        effectReferences,
        camera,
        ...SIZE,
      });
      return compareImages((await view.readPixels()).data, data, SIZE).psnrDb;
    };
    expect(await psnrDb(anglesOf(0.4))).toBeGreaterThan(50);
    expect(await psnrDb(anglesOf(0.9))).toBeGreaterThan(50);
    expect(await psnrDb(anglesOf(0.4), anglesOf(0.9))).toBeLessThan(40);
  });

  gpuTest('frames stay while the version of a resource does, and are drawn again without one', async () => {
    const cloud = engine.add(SET);
    const numbers = anglesOf(1);
    const source = bufferOf(numbers);
    const render = (angles: GivenResource) =>
      view.render({ camera, clouds: [{ cloud, effects: [spin({ angles, numbers })] }], ...SIZE });
    const drawn: boolean[] = [];
    for (const version of [1, 1, 2]) {
      drawn.push(render({ source, version }));
      await view.whenDrawn();
    }
    for (const angles of [source, source]) drawn.push(render(angles));
    expect(drawn).toEqual([true, false, true, true, true]);
  });

  gpuTest('unfit ones are refused by name', async () => {
    const cloud = engine.add(SET);
    const render = (...effects: EffectUse[]) =>
      view.render({ camera, clouds: [{ cloud, effects }], ...SIZE });
    const numbers = anglesOf(1);
    const image = imageOf(CORNERS);
    const floats = textureOf('rgba32float', [4, 1], TEXELS);
    const usage = GPUTextureUsage.TEXTURE_BINDING;
    const cases: [RegExp, () => unknown][] = [
      [/angles is no GPUBuffer/, () => render(spin({ angles: image, numbers }))],
      [/angles is no GPUBuffer/, () => render(spin({ angles: undefined as never, numbers }))],
      [
        /angles lacks the usage GPUBufferUsage.STORAGE/,
        () => render(spin({ angles: bufferOf(numbers, GPUBufferUsage.UNIFORM), numbers })),
      ],
      [/texels is no GPUTexture/, () => render(paint({ image, texels: bufferOf(numbers) }))],
      [
        /image has the format rgba32float, which this device cannot filter; declare it as texels/,
        () => render(paint({ image: floats, texels: floats })),
      ],
      [
        /image has the format r32uint/,
        () =>
          render(
            paint({ image: device.createTexture({ size: [1], format: 'r32uint', usage }), texels: floats }),
          ),
      ],
      [
        /image has 4 samples/,
        () =>
          render(
            paint({
              image: device.createTexture({
                size: [1],
                format: 'rgba8unorm',
                sampleCount: 4,
                usage: usage | GPUTextureUsage.RENDER_ATTACHMENT,
              }),
              texels: floats,
            }),
          ),
      ],
      [
        /image is 2d with 6 layers/,
        () =>
          render(
            paint({
              image: device.createTexture({ size: [1, 1, 6], format: 'rgba8unorm', usage }),
              texels: floats,
            }),
          ),
      ],
      [
        /image lacks the usage GPUTextureUsage.TEXTURE_BINDING/,
        () =>
          render(
            paint({
              image: device.createTexture({
                size: [1],
                format: 'rgba8unorm',
                usage: GPUTextureUsage.COPY_DST,
              }),
              texels: floats,
            }),
          ),
      ],
    ];
    for (const [message, act] of cases) {
      expect(act).toThrow(InvalidArgumentError);
      expect(act).toThrow(message);
    }
    const many = defineEffect<GPUBuffer>({
      name: 'test-many',
      label: 'Many',
      about: 'Reads two buffers.',
      hooks: { splat: 'manySplat' },
      resources: effectResources({ a: 'array<f32>', b: 'array<f32>' }, (a) => ({ a, b: a })),
      wgsl: '',
      calledFor: () => 'it is there',
    });
    expect(device.limits.maxStorageBuffersPerShaderStage).toBe(8);
    expect(() => render(many(bufferOf(numbers)))).toThrow(
      /need 9 storage buffers in one shader stage, of which this device allows 8 \(maxStorageBuffersPerShaderStage\)/,
    );
  });

  gpuTest('a resource of another device is refused when the device has answered', async () => {
    const { createNodeGpu } = await import('@websplatter/node');
    // Its errors are part of this test.
    const own = await (await createNodeGpu()).adapter.requestDevice();
    const errors: string[] = [];
    own.addEventListener('uncapturederror', ({ error }) => {
      errors.push(error.message);
    });
    const other = await SplatEngine.create({ device: own, accuracy: 'high' });
    const numbers = anglesOf(1);
    const effects = [spin({ angles: bufferOf(numbers), numbers })];
    const frame = { camera, clouds: [{ cloud: other.add(SET), effects }], ...SIZE };
    const otherView = other.createView();
    otherView.render(frame);
    // Its shaders compile first: the device answers meanwhile.
    await expect(otherView.whenDrawn()).rejects.toThrow(InvalidArgumentError);
    expect(errors).toEqual([]);
    expect(() => otherView.render(frame)).toThrow(/angles cannot be bound on the engine's device/);
    other.destroy();
    own.destroy();
  });
});
