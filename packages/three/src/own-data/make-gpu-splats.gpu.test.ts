import {
  DestroyedError,
  InvalidArgumentError,
  perspectiveCamera,
  type SplatCloud,
  SplatEngine,
  SplatSourceError,
} from '@websplatter/core';
import { compareImages, renderReference } from '@websplatter/core/reference';
import { gpuTest, shareTestDevice } from '@websplatter/node/gpu-test';
import { Box3, BufferAttribute, Vector3, type WebGPURenderer } from 'three/webgpu';
import { beforeAll, describe, expect, test, vi } from 'vitest';
import { SplatCloudObject } from '../cloud/splat-cloud-object.ts';
import { editsOf } from './edits-of.ts';
import { type GpuSplatData, type MakeGpuSplatsOptions, makeGpuSplats } from './make-gpu-splats.ts';
import { makeSplatData } from './make-splat-data.ts';

const SIZE = { widthPx: 64, heightPx: 64 };
const CAMERA = perspectiveCamera({ position: [0, 0, 4], target: [0, 0, 0], fovYDegrees: 50, aspect: 1 });
const ARRAYS = {
  positions: [-0.8, 0, 0, 0.8, 0, 0],
  scales: [0.2, 0.2, 0.2, 0.3, 0.2, 0.1],
  colors: [1, 0, 0, 0, 1, 0],
};
const BOUNDS = { min: [-1, -1, -1], max: [1, 1, 1] } as const;

let device: GPUDevice;
let engine: SplatEngine;
beforeAll(async () => {
  device = await shareTestDevice();
  engine = await SplatEngine.create({ device, accuracy: 'reference' });
});

function bufferOf(values: Float32Array): GPUBuffer {
  const usage = GPUBufferUsage.STORAGE | GPUBufferUsage.COPY_DST;
  const buffer = device.createBuffer({ size: values.byteLength, usage });
  device.queue.writeBuffer(buffer, 0, values as Float32Array<ArrayBuffer>);
  return buffer;
}

/** A backend that makes buffers as three's does: it pads three values to four. */
function fakeRenderer() {
  const buffers = new Map<object, GPUBuffer>();
  const createStorageAttribute = vi.fn((attribute: BufferAttribute) => {
    const { array, itemSize, count } = attribute;
    const width = itemSize === 3 ? 4 : itemSize;
    const padded = new Float32Array(width * count);
    for (let i = 0; i < count; i++)
      padded.set((array as Float32Array).subarray(itemSize * i, itemSize * (i + 1)), width * i);
    buffers.set(attribute, bufferOf(padded));
  });
  const get = (of: object) => ({ buffer: buffers.get(of) });
  const backend = { isWebGPUBackend: true, get, createStorageAttribute };
  return { renderer: { backend } as unknown as WebGPURenderer, buffers, createStorageAttribute };
}

const attribute = (values: readonly number[], itemSize: number) =>
  new BufferAttribute(Float32Array.from(values), itemSize);

function attributes() {
  return {
    positions: attribute(ARRAYS.positions, 3),
    // As the node that `instancedArray` returns.
    scales: { value: attribute(ARRAYS.scales, 3) },
    colors: attribute(ARRAYS.colors, 3),
  };
}

/** An object with the data, whose cloud is there. */
async function shown(data: GpuSplatData) {
  const object = new SplatCloudObject(data);
  const needsframe = vi.fn();
  object.addEventListener('needsframe', needsframe);
  const cloud = await data.acquire(engine, object);
  await expect.poll(() => needsframe).toHaveBeenCalled();
  return { object, cloud, needsframe };
}

async function psnrDb(cloud: SplatCloud, arrays: typeof ARRAYS): Promise<number> {
  const view = engine.createView();
  view.render({ camera: CAMERA, clouds: [{ cloud }], ...SIZE });
  const { data } = await view.readPixels();
  view.destroy();
  const set = makeSplatData(arrays).set!;
  return compareImages(data, renderReference({ clouds: [{ set }], camera: CAMERA, ...SIZE }).data, SIZE)
    .psnrDb;
}

describe('data that the GPU makes', () => {
  gpuTest('show three’s attributes, and ask for one frame for all changes of a task', async () => {
    const { renderer, buffers, createStorageAttribute } = fakeRenderer();
    const given = attributes();
    const data = makeGpuSplats(renderer, { ...given, bounds: BOUNDS, name: 'particles' });
    expect([data.name, data.count]).toEqual(['particles', 2]);
    expect(data.bounds).toEqual(new Box3(new Vector3(-1, -1, -1), new Vector3(1, 1, 1)));
    expect(createStorageAttribute).not.toHaveBeenCalled();
    const { object, cloud, needsframe } = await shown(data);
    expect(createStorageAttribute).toHaveBeenCalledTimes(3);
    expect(await psnrDb(cloud, ARRAYS)).toBeGreaterThan(60);

    const moved = { ...ARRAYS, positions: [-0.8, 0.5, 0, 0.8, -0.5, 0] };
    const padded = Float32Array.of(-0.8, 0.5, 0, 0, 0.8, -0.5, 0, 0);
    device.queue.writeBuffer(buffers.get(given.positions)!, 0, padded);
    needsframe.mockClear();
    data.changed();
    data.changed();
    await expect.poll(() => needsframe).toHaveBeenCalledOnce();
    expect(await psnrDb(cloud, moved)).toBeGreaterThan(60);
    expect(await data.countFaults()).toEqual({});
    expect((await data.readBounds())!.max.x).toBeCloseTo(0.8);
    expect([...(await data.rowsIn(new Box3(new Vector3(0, -1, -1), new Vector3(1, 1, 1))))]).toEqual([1]);

    data.release(object);
    expect(cloud.isDestroyed).toBe(true);
    data.changed();
    expect(await data.countFaults()).toEqual({});
    expect(await data.readBounds()).toBeNull();
  });

  gpuTest('read buffers of other code, wherever they begin', async () => {
    const buffer = bufferOf(Float32Array.of(0, ...ARRAYS.positions, ...ARRAYS.scales, ...ARRAYS.colors));
    const at = (word: number) => ({ buffer, offsetBytes: 4 * word });
    const { renderer } = fakeRenderer();
    const data = makeGpuSplats(renderer, { count: 2, positions: at(1), scales: at(7), colors: at(13) });
    const { object, cloud } = await shown(data);
    expect(await psnrDb(cloud, ARRAYS)).toBeGreaterThan(60);
    data.release(object);
  });

  gpuTest('free a cloud whose last user leaves while it is made', async () => {
    const held = engine.memory().totalBytes;
    const data = makeGpuSplats(fakeRenderer().renderer, attributes());
    const user = {};
    const making = data.acquire(engine, user);
    data.release(user);
    await expect(making).rejects.toThrow('abort');
    expect(engine.memory().totalBytes).toBe(held);
  });

  gpuTest('report a destroyed buffer at the next change', async () => {
    const { renderer, buffers } = fakeRenderer();
    const given = attributes();
    const data = makeGpuSplats(renderer, given);
    const { object, cloud } = await shown(data);
    buffers.get(given.positions)!.destroy();
    data.changed();
    await psnrDb(cloud, ARRAYS);
    await expect.poll(() => errorOf(() => data.changed())).toBeInstanceOf(DestroyedError);
    data.release(object);
  });

  gpuTest('refuse edits and rays, and say what to do', async () => {
    const data = makeGpuSplats(fakeRenderer().renderer, attributes());
    expect(() => editsOf(data)).toThrow(/made by the GPU/);
    await expect(data.prepareRays()).rejects.toThrow(SplatSourceError);
  });

  test.each([
    ['a column', { colors: undefined }, 'colors'],
    ['what is no attribute', { scales: [1, 2, 3] }, 'scales'],
    ['a count', { positions: { buffer: {} } }, 'count'],
  ])('name %s that is missing or wrong', (_, wrong, argument) => {
    const options = { ...attributes(), ...wrong } as MakeGpuSplatsOptions;
    const error = errorOf(() => makeGpuSplats(fakeRenderer().renderer, options));
    expect(error).toBeInstanceOf(InvalidArgumentError);
    expect((error as InvalidArgumentError).argument).toBe(argument);
  });

  gpuTest('report that attributes need WebGPU', async () => {
    const data = makeGpuSplats({ backend: {} } as unknown as WebGPURenderer, attributes());
    await expect(data.acquire(engine, {})).rejects.toThrow(/WebGPU/);
  });
});

function errorOf(call: () => void): unknown {
  try {
    call();
    return null;
  } catch (error) {
    return error;
  }
}
