import { createTestDevice, gpuTest, shareTestDevice } from '@websplatter/node/gpu-test';
import { beforeAll, describe, expect, vi } from 'vitest';
import { makeColliderMesh } from '../../clouds/collider/index.ts';
import { makeRayTree } from '../../clouds/rays/rays.ts';
import type { SplatCloud } from '../../clouds/splat-cloud.ts';
import { SplatEngine } from '../../create-engine.ts';
import type { Accuracy } from '../../data/accuracy/accuracy.ts';
import { perspectiveCamera } from '../../data/camera/camera.ts';
import { type SplatArrays, splatsFromArrays } from '../../data/editing/splats-from-arrays.ts';
import { DestroyedError, GpuLimitError, InvalidArgumentError, SplatSourceError } from '../../data/errors.ts';
import { frameScene } from '../../framing/frame-scene.ts';
import { compareImages, renderReference } from '../../reference/index.ts';
import { countedDevice } from '../../testing/counted-device.ts';
import { deviceWith, limitsWith } from '../../testing/device-with.ts';
import { NARROW_REFERENCE } from '../../testing/narrow-reference.ts';
import { seededRandom } from '../../testing/seeded-random.ts';
import { followEdits } from '../edits/edits.clouds.ts';
import { SplatEdits } from '../edits/splat-edits.data.ts';
import type { GpuSplats, GpuSplatsOptions, SplatBuffer } from './gpu-splats.clouds.ts';

const SIZE = { widthPx: 64, heightPx: 64 };
const CAMERA = perspectiveCamera({ position: [0, 0, 4], target: [0, 0, 0], fovYDegrees: 45, aspect: 1 });
const COUNT = 1500;
const BOUNDS = { min: [-1, -1, -1], max: [1, 1, 1] } as const;

type Columns = Required<Pick<SplatArrays, 'positions' | 'scales' | 'rotations' | 'opacities' | 'colors'>>;

function columns(seed: number, count = COUNT): Columns {
  const random = seededRandom(seed);
  const list = (width: number, least: number, most: number) =>
    Float32Array.from({ length: width * count }, () => least + (most - least) * random());
  return {
    positions: list(3, -1, 1),
    scales: list(3, 0.01, 0.1),
    rotations: list(4, -2, 2),
    opacities: list(1, 0.2, 1),
    colors: list(3, 0, 1),
  };
}

let device: GPUDevice;
let engine: SplatEngine;
beforeAll(async () => {
  device = await shareTestDevice();
  // Several pages.
  const limits = limitsWith(device, { maxStorageBufferBindingSize: 80_000 });
  engine = await SplatEngine.create({ device: deviceWith(device, { limits }) });
});

const DEFAULT_USAGE = () => GPUBufferUsage.STORAGE | GPUBufferUsage.COPY_DST;

function bufferOf(values: ArrayLike<number>, usage = DEFAULT_USAGE()): GPUBuffer {
  const buffer = device.createBuffer({ size: 4 * values.length, usage });
  if (usage & GPUBufferUsage.COPY_DST) device.queue.writeBuffer(buffer, 0, Float32Array.from(values));
  return buffer;
}

type InBuffers = { readonly [Name in keyof Columns]: SplatBuffer } & Pick<GpuSplatsOptions, 'count'>;

function inBuffers(of: Columns, count = COUNT): InBuffers {
  const buffers = Object.entries(of).map(([name, values]) => [name, { buffer: bufferOf(values) }]);
  return { count, ...Object.fromEntries(buffers) };
}

function write({ buffer }: SplatBuffer, values: ArrayLike<number>): void {
  device.queue.writeBuffer(buffer, 0, Float32Array.from(values));
}

async function imageOf(
  cloud: SplatCloud,
  accuracy: Accuracy = NARROW_REFERENCE,
  camera = CAMERA,
): Promise<Float32Array> {
  const view = engine.createView();
  view.render({ camera, clouds: [{ cloud }], accuracy, ...SIZE });
  const { data } = await view.readPixels();
  view.destroy();
  return data;
}

/** Picture of the same splats, uploaded by the CPU. */
async function ordinary(of: Columns, accuracy: Accuracy = NARROW_REFERENCE) {
  const cloud = engine.add(splatsFromArrays(of));
  const image = await imageOf(cloud, accuracy);
  cloud.destroy();
  return image;
}

function reference(of: Columns): Float64Array {
  const clouds = [{ set: splatsFromArrays(of) }];
  return renderReference({ clouds, camera: CAMERA, ...SIZE }).data as Float64Array;
}

const psnrDb = (actual: Float32Array, expected: Float32Array | Float64Array) =>
  compareImages(actual, expected, SIZE).psnrDb;

const A = columns(1);
const B = columns(2);

describe('splats that the GPU makes', () => {
  gpuTest('are drawn like the same splats of the CPU, and follow their buffers', async () => {
    await engine.setAccuracy(NARROW_REFERENCE);
    const buffers = inBuffers(A);
    const splats = await engine.addGpuSplats({ ...buffers, bounds: BOUNDS });
    expect(splats.cloud.planes.ranges.length).toBeGreaterThan(1);
    expect(splats.cloud.facts).toMatchObject({ declaredShDegree: 0, trueShDegree: 0, shBandReach: [] });
    const first = await imageOf(splats.cloud);
    expect(psnrDb(first, await ordinary(A))).toBeGreaterThan(90);
    expect(psnrDb(first, reference(A))).toBeGreaterThan(60);
    for (const [name, values] of Object.entries(B)) write(buffers[name as keyof Columns], values);
    // Until they are told, frames draw what was packed last.
    expect(await imageOf(splats.cloud)).toEqual(first);
    splats.changed();
    const second = await imageOf(splats.cloud);
    expect(psnrDb(second, reference(B))).toBeGreaterThan(60);
    expect(psnrDb(second, first)).toBeLessThan(30);
    splats.cloud.destroy();
  });

  gpuTest('are packed in any precision, and in that of the engine from the start', async () => {
    await engine.setAccuracy('balanced');
    const buffers = inBuffers(A);
    const splats = await engine.addGpuSplats(buffers);
    expect(splats.cloud.precisions.geometry).toEqual(['packed']);
    const packed = await imageOf(splats.cloud, 'balanced');
    expect(psnrDb(packed, await ordinary(A, 'balanced'))).toBeGreaterThan(50);
    await engine.requestPrecision(splats.cloud, { geometryPrecision: 'f32', shPrecision: 'f32' });
    expect(splats.cloud.precisions.geometry).toEqual(['f32']);
    expect(psnrDb(await imageOf(splats.cloud), reference(A))).toBeGreaterThan(60);
    // Both at once follow the buffers.
    const lease = splats.cloud.hold({ geometryPrecision: 'packed', shPrecision: 'u8' });
    await lease.met;
    for (const [name, values] of Object.entries(B)) write(buffers[name as keyof Columns], values);
    splats.changed();
    expect(psnrDb(await imageOf(splats.cloud), reference(B))).toBeGreaterThan(60);
    expect(psnrDb(await imageOf(splats.cloud, 'balanced'), reference(B))).toBeGreaterThan(45);
    splats.cloud.destroy();
  });

  gpuTest('may share a buffer, with strides, and have neither rotations nor opacities', async () => {
    await engine.setAccuracy(NARROW_REFERENCE);
    // Two vec4f and a vec3f for each splat, after a header.
    const words = 12;
    const header = 3;
    const mixed = new Float32Array(header + words * COUNT).fill(Number.NaN);
    for (let i = 0; i < COUNT; i++) {
      for (let k = 0; k < 3; k++) {
        mixed[header + words * i + k] = A.positions[3 * i + k];
        mixed[header + words * i + 4 + k] = A.scales[3 * i + k];
        mixed[header + words * i + 8 + k] = A.colors[3 * i + k];
      }
    }
    const buffer = bufferOf(mixed);
    const at = (word: number) => ({ buffer, offsetBytes: 4 * (header + word), strideBytes: 4 * words });
    const splats = await engine.addGpuSplats({
      count: COUNT,
      positions: at(0),
      scales: at(4),
      colors: at(8),
    });
    const expected = {
      ...A,
      rotations: Float32Array.from({ length: 4 * COUNT }, (_, i) => (i % 4 === 3 ? 1 : 0)),
      opacities: new Float32Array(COUNT).fill(1),
    };
    expect(psnrDb(await imageOf(splats.cloud), await ordinary(expected))).toBeGreaterThan(90);
    splats.cloud.destroy();
  });

  gpuTest('are written by a compute pass, with nothing read back and nothing made per frame', async () => {
    const { device: counted, calls } = countedDevice(device);
    const own = await SplatEngine.create({ device: counted, accuracy: NARROW_REFERENCE });
    const buffers = inBuffers(A);
    const splats = await own.addGpuSplats({ ...buffers, bounds: { min: [-3, -3, -3], max: [3, 3, 3] } });
    const module = device.createShaderModule({
      code: `@group(0) @binding(0) var<storage, read_write> positions: array<f32>;
        @compute @workgroup_size(64) fn main(@builtin(global_invocation_id) id: vec3u) {
          if (id.x < ${COUNT}u) { positions[3u * id.x] += 0.25; }
        }`,
    });
    const pipeline = await device.createComputePipelineAsync({ layout: 'auto', compute: { module } });
    const group = device.createBindGroup({
      layout: pipeline.getBindGroupLayout(0),
      entries: [{ binding: 0, resource: { buffer: buffers.positions.buffer } }],
    });
    const view = own.createView();
    const frame = async () => {
      const encoder = device.createCommandEncoder();
      const pass = encoder.beginComputePass();
      pass.setPipeline(pipeline);
      pass.setBindGroup(0, group);
      pass.dispatchWorkgroups(Math.ceil(COUNT / 64));
      pass.end();
      device.queue.submit([encoder.finish()]);
      splats.changed();
      view.render({ camera: CAMERA, clouds: [{ cloud: splats.cloud }], ...SIZE });
      await view.whenDrawn();
    };
    await frame();
    await frame();
    const mapping = vi.spyOn(GPUBuffer.prototype, 'mapAsync');
    const before = { ...calls };
    const uploaded = own.counters().uploadedBytes;
    await frame();
    await frame();
    const labels = mapping.mock.contexts.map((buffer) => (buffer as unknown as GPUBuffer).label);
    // Views time the stages of any frame.
    expect(labels.filter((label) => !label.startsWith('statistics'))).toEqual([]);
    mapping.mockRestore();
    expect(calls).toEqual(before);
    expect(own.counters().uploadedBytes).toBe(uploaded);
    const moved = { ...A, positions: Float32Array.from(A.positions, (x, i) => x + (i % 3 === 0 ? 1 : 0)) };
    expect(psnrDb((await view.readPixels()).data, reference(moved))).toBeGreaterThan(60);
    // At rest, nothing is submitted.
    const { framesPrepared } = own.counters();
    view.render({ camera: CAMERA, clouds: [{ cloud: splats.cloud }], ...SIZE });
    expect(own.counters().framesPrepared).toBe(framesPrepared);
    own.destroy();
  });

  gpuTest('with faults are left out alone, and counted on request', async () => {
    await engine.setAccuracy(NARROW_REFERENCE);
    for (const accuracy of [NARROW_REFERENCE, 'balanced'] as const) {
      await engine.setAccuracy(accuracy);
      const broken = structuredClone(A) as { [Name in keyof Columns]: Float32Array };
      const [nan, infinite] = [Number.NaN, Number.POSITIVE_INFINITY];
      broken.positions[3 * 3 + 1] = nan;
      broken.positions[3 * 4] = -infinite;
      broken.scales[3 * 5] = infinite;
      broken.rotations[4 * 6 + 3] = nan;
      broken.opacities[7] = nan;
      broken.opacities[8] = -0.5;
      broken.colors[3 * 9] = nan;
      broken.positions[3 * 10] = 1.5;
      // A whole chunk without splats.
      broken.opacities.fill(0, 512, 768);
      const sound = structuredClone(A) as typeof broken;
      for (const row of [3, 4, 5, 6, 7, 8, 9, 10]) sound.opacities[row] = 0;
      sound.opacities.fill(0, 512, 768);
      const splats = await engine.addGpuSplats({ ...inBuffers(broken), bounds: BOUNDS });
      const image = await imageOf(splats.cloud, accuracy);
      expect(image.every(Number.isFinite)).toBe(true);
      const whole = await engine.addGpuSplats({ ...inBuffers(sound), bounds: BOUNDS });
      expect(image).toEqual(await imageOf(whole.cloud, accuracy));
      expect(await splats.countFaults()).toEqual({
        'non-finite-position': 2,
        'non-finite-scale': 1,
        'non-finite-rotation': 1,
        'non-finite-opacity': 1,
        'non-finite-color': 1,
        'out-of-bounds': 1,
      });
      expect(await whole.countFaults()).toEqual({});
      splats.cloud.destroy();
      whole.cloud.destroy();
    }
  });

  gpuTest('may have values of any size', async () => {
    await engine.setAccuracy(NARROW_REFERENCE);
    const extreme = structuredClone(A) as { [Name in keyof Columns]: Float32Array };
    const sizes = [0, 1e-45, 1e-38, 1e-20, 1, 1e20, 3e38];
    const random = seededRandom(3);
    for (const values of Object.values(extreme))
      for (let i = 0; i < values.length; i++)
        if (random() < 0.3)
          values[i] = sizes[Math.floor(random() * sizes.length)] * (random() < 0.5 ? 1 : -1);
    const splats = await engine.addGpuSplats(inBuffers(extreme));
    for (const accuracy of [NARROW_REFERENCE, 'balanced'] as const) {
      const image = await imageOf(splats.cloud, accuracy);
      expect(image.every(Number.isFinite), JSON.stringify(accuracy)).toBe(true);
    }
    splats.cloud.destroy();
  });

  gpuTest('have bounds that are given, or read back on request', async () => {
    const buffers = inBuffers(A);
    const given = await engine.addGpuSplats({ ...buffers, bounds: BOUNDS });
    expect(given.cloud.bounds).toEqual(BOUNDS);
    const splats = await engine.addGpuSplats(buffers);
    const axis = (k: number) => Array.from(A.positions).filter((_, i) => i % 3 === k);
    const bounds = {
      min: [0, 1, 2].map((k) => Math.min(...axis(k))),
      max: [0, 1, 2].map((k) => Math.max(...axis(k))),
    };
    expect(await splats.readBounds()).toEqual(bounds);
    write(
      buffers.positions,
      Float32Array.from(A.positions, (value) => 2 * value),
    );
    splats.changed();
    expect((await splats.readBounds())!.max[0]).toBe(2 * bounds.max[0]);
    write(buffers.opacities, new Float32Array(COUNT));
    splats.changed();
    expect(await splats.readBounds()).toBeNull();
    expect((await imageOf(splats.cloud)).every((value) => value === 0)).toBe(true);
    given.cloud.destroy();
    splats.cloud.destroy();
  });

  gpuTest('are found by picks, by their rows, and framed', async () => {
    await engine.setAccuracy('balanced');
    const one = {
      positions: [9, 9, 9, 0, 0, 0],
      scales: [0.1, 0.1, 0.1, 0.3, 0.3, 0.3],
      rotations: [0, 0, 0, 1, 0, 0, 0, 1],
      opacities: [1, 1],
      colors: [1, 0, 0, 0, 1, 0],
    };
    const { cloud } = await engine.addGpuSplats(inBuffers(one, 2));
    const view = engine.createView();
    view.render({ camera: CAMERA, clouds: [{ cloud }], ...SIZE });
    await view.whenDrawn();
    expect(await view.pick(32, 32)).toMatchObject({ row: 1 });
    view.destroy();
    const near = { ...one, positions: [-1, 0, 0, 1, 0, 0] };
    const framed = await engine.addGpuSplats(inBuffers(near, 2));
    const ordinaryCloud = engine.add(splatsFromArrays(near));
    const [a, b] = await Promise.all([
      frameScene([{ cloud: framed.cloud }]),
      frameScene([{ cloud: ordinaryCloud }]),
    ]);
    for (let k = 0; k < 3; k++) expect(a!.position[k]).toBeCloseTo(b!.position[k], 2);
    for (const each of [cloud, framed.cloud, ordinaryCloud]) each.destroy();
  });
});

describe('splats that the GPU makes refuse', () => {
  const refused = async (options: object): Promise<Error> =>
    engine.addGpuSplats({ ...inBuffers(A), ...options } as GpuSplatsOptions).then(
      () => expect.unreachable(),
      (error) => error,
    );

  for (const [what, change, argument, words] of [
    ['no splats', () => ({ count: 0 }), 'count', /1 or more/],
    ['more splats than a buffer has', () => ({ count: COUNT + 1 }), 'positions.buffer', /need 18012/],
    ['no colours', () => ({ colors: undefined }), 'colors', /an object/],
    [
      'odd offsets',
      () => ({ scales: { buffer: bufferOf(A.scales), offsetBytes: 2 } }),
      'scales.offsetBytes',
      /multiple of 4/,
    ],
    [
      'strides that overlap',
      () => ({ scales: { buffer: bufferOf(A.scales), strideBytes: 8 } }),
      'scales.strideBytes',
      /at least 12/,
    ],
    [
      'other usages',
      () => ({ opacities: { buffer: bufferOf(A.opacities, GPUBufferUsage.VERTEX) } }),
      'opacities.buffer',
      /STORAGE/,
    ],
    ['what is no buffer', () => ({ opacities: { buffer: {} } }), 'opacities.buffer.size', /a number/],
    ['bounds inside out', () => ({ bounds: { min: [0, 0, 2], max: [1, 1, 1] } }), 'bounds.min[2]', /at most/],
    [
      'a buffer that is still mapped',
      () => ({
        scales: {
          buffer: device.createBuffer({
            size: 12 * COUNT,
            usage: GPUBufferUsage.STORAGE,
            mappedAtCreation: true,
          }),
        },
      }),
      'scales.buffer',
      /mapped.*unmap/,
    ],
    [
      'bounds that float32 cannot hold',
      () => ({ bounds: { min: [0, 0, 0], max: [1, 1, 1e300] } }),
      'bounds.max',
      /finite/,
    ],
    [
      'bounds that are not finite',
      () => ({ bounds: { min: [0, 0, Number.NaN], max: [1, 1, 1] } }),
      'bounds.min',
      /finite/,
    ],
  ] as const)
    gpuTest(what, async () => {
      const held = engine.memory().totalBytes;
      const error = await refused(change());
      expect(error).toBeInstanceOf(InvalidArgumentError);
      expect((error as InvalidArgumentError).argument).toBe(argument);
      expect(error.message).toMatch(words);
      expect(engine.memory().totalBytes).toBe(held);
    });

  gpuTest('buffers of another device', async () => {
    const held = engine.memory().totalBytes;
    const other = await createTestDevice();
    const buffer = other.createBuffer({ size: 12 * COUNT, usage: GPUBufferUsage.STORAGE });
    const error = await refused({ colors: { buffer } });
    expect(error).toBeInstanceOf(InvalidArgumentError);
    expect((error as InvalidArgumentError).argument).toBe('colors.buffer');
    expect(error.message).toMatch(/engine\.device/);
    expect(engine.memory().totalBytes).toBe(held);
    other.destroy();
  });

  gpuTest('buffers that are destroyed, at first and later', async () => {
    const gone = inBuffers(A);
    gone.scales.buffer.destroy();
    expect(await refused(gone)).toBeInstanceOf(DestroyedError);
    const buffers = inBuffers(A);
    const splats = await engine.addGpuSplats(buffers);
    const before = await imageOf(splats.cloud);
    buffers.scales.buffer.destroy();
    splats.changed();
    expect(await imageOf(splats.cloud)).toEqual(before);
    expect(() => splats.changed()).toThrow(DestroyedError);
    await expect(splats.countFaults()).rejects.toThrow(DestroyedError);
    splats.cloud.destroy();
  });

  gpuTest('strides that no binding holds, and budgets that are exceeded', async () => {
    const strideBytes = 64 * 512;
    const buffer = device.createBuffer({ size: strideBytes * 300, usage: GPUBufferUsage.STORAGE });
    const one = { count: 300, positions: { buffer, strideBytes } };
    expect(await refused(one)).toMatchObject({ limit: 'maxStorageBufferBindingSize' });
    const small = await SplatEngine.create({ device, memoryBudgetBytes: 10_000 });
    await expect(small.addGpuSplats(inBuffers(A))).rejects.toThrow(GpuLimitError);
    expect(small.memory().totalBytes).toBe(0);
    small.destroy();
  });

  gpuTest('rays, colliders, edits and levels, and say what to do', async () => {
    const splats = await engine.addGpuSplats(inBuffers(A));
    const { cloud } = splats;
    await expect(makeRayTree(cloud)).rejects.toThrow(/read the buffers/);
    await expect(makeColliderMesh(cloud, { gridSize: 1 } as never)).rejects.toThrow(SplatSourceError);
    await expect(followEdits(cloud, new SplatEdits())).rejects.toThrow(/buffers of the GPU/);
    await expect(cloud.makeLevels()).rejects.toThrow(/in full detail/);
    // A frame that asks for levels is drawn in full.
    const view = engine.createView();
    view.render({ camera: CAMERA, clouds: [{ cloud }], detail: { maxSplats: 10 }, ...SIZE });
    const { data } = await view.readPixels();
    expect(psnrDb(data, await imageOf(cloud, 'balanced'))).toBeGreaterThan(60);
    view.destroy();
    cloud.destroy();
  });
});

describe('memory of splats that the GPU makes', () => {
  const live = async (): Promise<GpuSplats> => engine.addGpuSplats(inBuffers(A));

  gpuTest('is that of their planes, and is freed with their cloud', async () => {
    await engine.setAccuracy('balanced');
    const before = engine.memory().totalBytes;
    const splats = await live();
    expect(splats.cloud.bytes).toBe(32 * COUNT + 32 * 6);
    expect(engine.memory().scene.clouds.map(({ name }) => name)).toContain('splats');
    splats.cloud.destroy();
    expect(engine.memory().totalBytes).toBe(before);
    expect(engine.clouds).not.toContain(splats.cloud);
    expect(() => splats.changed()).toThrow(DestroyedError);
    await expect(splats.readBounds()).rejects.toThrow(DestroyedError);
  });

  gpuTest('leaves buffers to the application, and ends with the engine', async () => {
    const own = await SplatEngine.create({ device });
    const buffers = inBuffers(A);
    const splats = await own.addGpuSplats(buffers);
    own.destroy();
    expect(() => splats.changed()).toThrow(DestroyedError);
    const again = await engine.addGpuSplats(buffers);
    expect(await again.countFaults()).toEqual({});
    again.cloud.destroy();
  });
});
