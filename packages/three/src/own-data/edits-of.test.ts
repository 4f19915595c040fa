import { GpuLimitError, InvalidArgumentError, type SplatCloud, SplatSourceError } from '@websplatter/core';
import { Sphere, Vector3 } from 'three/webgpu';
import { afterAll, beforeAll, describe, expect, test, vi } from 'vitest';
import { SplatCloudObject } from '../cloud/splat-cloud-object.ts';
import { SplatData } from '../cloud/splat-data.ts';
import { fakeEngine } from '../testing/fake-engine.ts';
import { packedCloudAt, splatDataAt } from '../testing/test-clouds.ts';
import { editsOf } from './edits-of.ts';
import { makeSplatData } from './make-splat-data.ts';

/** An engine whose cloud is as after an upload of `packed`, and records writes to its planes. */
function editableEngine(packed = packedCloudAt([0, 0, 0], [1, 2, 3])) {
  const fake = fakeEngine();
  const writeBuffer = vi.fn();
  Object.assign(fake.cloud, {
    ...packed,
    device: readableDevice(packed.geometry.words, writeBuffer),
    planes: {
      ranges: [{ start: 0, end: packed.count }],
      held: { geometry: ['packed'], sh: ['u8'] },
      geometryPlane: () => [{}],
      chunksPlane: [{}],
    },
    isUploaded: true,
    checkUsable: () => {},
    features: [] as object[],
    addFeature(feature: object) {
      this.features.push(feature);
    },
    uploadedChunks: packed.chunks,
    moveChunks(chunks: ArrayBuffer, bounds: unknown) {
      Object.assign(this, { chunks, bounds });
    },
    markChanged: () => {},
    stretch: () => null,
    countWritten: () => {},
  });
  return { ...fake, writeBuffer };
}

/** A device whose buffers have these words, and memory unless it is `lacking`. */
function readableDevice(words: Uint32Array, writeBuffer: () => void, lacking = false): object {
  return {
    limits: { maxBufferSize: 1e9 },
    pushErrorScope: () => {},
    popErrorScope: async () => (lacking ? { message: 'none' } : null),
    createBuffer: () => ({
      mapAsync: async () => {},
      getMappedRange: () => words.slice().buffer,
      destroy: () => {},
    }),
    createCommandEncoder: () => ({ copyBufferToBuffer: () => {}, finish: () => {} }),
    queue: { writeBuffer, submit: () => {} },
  };
}

beforeAll(() => {
  vi.stubGlobal('GPUBufferUsage', {});
  vi.stubGlobal('GPUMapMode', {});
});
afterAll(() => {
  vi.unstubAllGlobals();
});

const passTask = () => new Promise((resolve) => setTimeout(resolve, 0));

describe('edits of data', () => {
  test('are the same ones always, and none of a preview', () => {
    const data = splatDataAt([0, 0, 0]);
    expect(editsOf(data)).toBe(editsOf(data));
    Object.assign(data, { isPreview: true });
    expect(() => editsOf(data)).toThrow(SplatSourceError);
  });

  test('refuse rows that own data do not have', () => {
    const data = makeSplatData({ positions: [0, 0, 0], scales: [1, 1, 1], colors: [1, 1, 1] });
    expect(() => editsOf(data).set([1], { visible: false })).toThrow(InvalidArgumentError);
  });

  test('request one frame for all that a task edits, and move bounds', async () => {
    const { engine, writeBuffer } = editableEngine();
    const data = splatDataAt([0, 0, 0], [1, 2, 3]);
    const object = new SplatCloudObject(data);
    data.acquire(engine, object);
    const edits = editsOf(data);
    await passTask();
    const needsframe = vi.fn();
    object.addEventListener('needsframe', needsframe);
    edits.set([1], { positions: [5, 6, 7] });
    edits.set([0], { colors: [1, 0, 0] });
    expect(needsframe).not.toHaveBeenCalled();
    await passTask();
    expect(needsframe).toHaveBeenCalledOnce();
    // Both splats lie close together, and their chunk has new bounds.
    expect(writeBuffer).toHaveBeenCalledTimes(2);
    expect(data.bounds.max.toArray()).toEqual([5, 6, 7]);
    expect(object.geometry.boundingBox!.max.toArray()).toEqual(data.robustBounds.max.toArray());
  });

  /**
   * @fault GPU memory: geometry that is read back for edits finds no memory
   * @consequence `GpuLimitError`; in three.js and React, `onError` is called
   */
  test('say so where there is no memory to read splats back', async () => {
    const { engine, cloud } = editableEngine();
    Object.assign(cloud, { device: readableDevice(new Uint32Array(16), () => {}, true) });
    const data = splatDataAt([0, 0, 0], [1, 2, 3]);
    const object = new SplatCloudObject(data);
    const told: Error[] = [];
    object.onError = (error) => told.push(error);
    data.acquire(engine, object);
    editsOf(data);
    await expect.poll(() => told).toHaveLength(1);
    expect(told[0]).toBeInstanceOf(GpuLimitError);
  });

  test('reach engines that get the splats later, before their first frame', () => {
    const [first, second] = [editableEngine(), editableEngine()];
    const data = splatDataAt([0, 0, 0], [1, 2, 3]);
    data.acquire(first.engine, {});
    const edits = editsOf(data);
    edits.set([0], { visible: false });
    const cloud = data.acquire(second.engine, {}) as SplatCloud;
    expect(cloud.features).toMatchObject([{ edits }]);
    cloud.features[0].flush!();
    expect(second.writeBuffer).toHaveBeenCalledOnce();
  });

  test('reach splats that are read again, which are those of the file all the same', async () => {
    const [first, second] = [editableEngine(), editableEngine()];
    const packed = packedCloudAt([0, 0, 0], [1, 2, 3]);
    const data = new SplatData(packed, 'garden', 'https://a.test/garden.ply');
    data.acquire(first.engine, {});
    const edits = editsOf(data);
    edits.set([1], { positions: [5, 6, 7] });
    await passTask();
    second.load.mockResolvedValue(second.cloud);
    const cloud = await data.acquire(second.engine, {});
    expect(cloud.features).toMatchObject([{ edits }]);
  });

  test('move the splats that are sought, where they are on no GPU', async () => {
    const data = splatDataAt([0, 0, 0], [1, 2, 3]);
    editsOf(data).set([0], { positions: [8, 8, 8] });
    expect([...(await data.rowsIn(new Sphere(new Vector3(8, 8, 8), 1)))]).toEqual([0]);
    expect([...(await data.rowsIn(new Sphere(new Vector3(0, 0, 0), 1)))]).toEqual([]);
  });
});
