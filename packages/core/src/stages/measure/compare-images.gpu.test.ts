import { gpuTest, shareTestDevice } from '@websplatter/node/gpu-test';
import { beforeAll, describe, expect } from 'vitest';
import { fromHalfBits, toHalfBits } from '../../data/layout/half.ts';
import { GpuMemory } from '../../gpu/gpu-memory.ts';
import { Pipelines } from '../../gpu/pipelines.ts';
import { compareTextures, NonFiniteImageError } from '../../measure/compare-textures.ts';
import { seededRandom } from '../../testing/seeded-random.ts';
import { compareImages, type ImageDifference } from './measure.reference.ts';

type Size = readonly [widthPx: number, heightPx: number];

let device: GPUDevice;
let context: { device: GPUDevice; pipelines: Pipelines; memory: GpuMemory };

beforeAll(async () => {
  device = await shareTestDevice();
  context = { device, pipelines: new Pipelines(device), memory: new GpuMemory(device) };
});

/** Premultiplied RGBA: blobs as smooth as typical images. */
function blobs([widthPx, heightPx]: Size, seed: number): Float32Array {
  const random = seededRandom(seed);
  const waves = Array.from({ length: 4 }, () => [random() * 0.6, random() * 0.6, 7 * random()] as const);
  return Float32Array.from({ length: 4 * widthPx * heightPx }, (_, i) => {
    const [x, y] = [(i >> 2) % widthPx, Math.floor((i >> 2) / widthPx)];
    const [dx, dy, phase] = waves[i % 4];
    const alpha = 0.5 + 0.5 * Math.sin(waves[3][0] * x + waves[3][1] * y + waves[3][2]);
    return i % 4 === 3 ? alpha : alpha * (0.5 + 0.55 * Math.sin(dx * x + dy * y + phase));
  });
}

/** Adds errors of up to about `amount`, of all orders of magnitude below it. */
function disturbed(data: Float32Array, amount: number, seed = 9): Float32Array {
  const random = seededRandom(seed);
  return data.map((value, i) => (i % 4 === 3 ? value : value + amount * (random() - 0.5) * random() ** 3));
}

const textureOf = (data: Float32Array, [width, height]: Size, format: GPUTextureFormat = 'rgba32float') => {
  const texture = context.memory.createTexture({
    label: 'image',
    size: { width, height },
    format,
    usage: GPUTextureUsage.TEXTURE_BINDING | GPUTextureUsage.COPY_DST,
  });
  const encoded =
    format === 'rgba32float'
      ? data
      : format === 'rgba16float'
        ? Uint16Array.from(data, toHalfBits)
        : Uint8Array.from(data, (value) => Math.round(255 * Math.max(0, Math.min(1, value))));
  const bytesPerRow = encoded.byteLength / height;
  device.queue.writeTexture({ texture }, encoded as BufferSource, { bytesPerRow }, [width, height]);
  return texture;
};

async function onGpu(
  actual: Float32Array,
  expected: Float32Array,
  size: Size,
  background?: readonly [number, number, number],
): Promise<ImageDifference> {
  const textures = [textureOf(actual, size), textureOf(expected, size)] as const;
  try {
    return await compareTextures(context, ...textures, background);
  } finally {
    for (const texture of textures) context.memory.destroy(texture);
  }
}

function expectAlike(found: ImageDifference, expected: ImageDifference): void {
  if (expected.psnrDb === Number.POSITIVE_INFINITY) expect(found.psnrDb).toBe(Number.POSITIVE_INFINITY);
  else expect(Math.abs(found.psnrDb - expected.psnrDb)).toBeLessThan(0.01);
  // Values up to 1 are composited over the background and subtracted in float32.
  expect(Math.abs(found.maxError - expected.maxError)).toBeLessThanOrEqual(2 ** -22);
  expect(Math.abs(found.p999Error - expected.p999Error)).toBeLessThanOrEqual(
    0.01 * expected.p999Error + 2 ** -22,
  );
  expect(Math.abs(found.ssim - expected.ssim)).toBeLessThan(1e-4);
}

describe('compare-images', () => {
  // Smaller than a window, one window, one tile, and partial tiles.
  const sizes: readonly Size[] = [
    [1, 1],
    [3, 40],
    [11, 11],
    [16, 16],
    [17, 33],
    [50, 31],
    [64, 64],
  ];
  for (const size of sizes) {
    gpuTest(`agrees with the CPU on ${size[0]}×${size[1]} px`, async () => {
      const [widthPx, heightPx] = size;
      const expected = blobs(size, 1);
      for (const amount of [1e-5, 1e-3, 0.05, 1]) {
        const actual = disturbed(expected, amount);
        expectAlike(
          await onGpu(actual, expected, size),
          compareImages(actual, expected, { widthPx, heightPx }),
        );
      }
    });
  }

  gpuTest('finds equal images equal', async () => {
    const size: Size = [40, 23];
    const same = blobs(size, 2);
    expect(await onGpu(same, same, size)).toEqual({
      psnrDb: Number.POSITIVE_INFINITY,
      maxError: 0,
      p999Error: 0,
      ssim: 1,
    });
  });

  gpuTest('finds a wrong image, and a single wrong pixel', async () => {
    const size: Size = [40, 23];
    const [widthPx, heightPx] = size;
    const expected = blobs(size, 3);
    const other = blobs(size, 4);
    const wrong = await onGpu(other, expected, size);
    expectAlike(wrong, compareImages(other, expected, { widthPx, heightPx }));
    expect(wrong.psnrDb).toBeLessThan(15);
    expect(wrong.ssim).toBeLessThan(0.5);
    // In the last pixel of the last tile, which is a partial one.
    const spot = Float32Array.from(expected);
    spot[spot.length - 3] = expected[spot.length - 3] > 0.5 ? 0.1 : 0.9;
    const found = await onGpu(spot, expected, size);
    expectAlike(found, compareImages(spot, expected, { widthPx, heightPx }));
    expect(found.maxError).toBeGreaterThan(0.3);
    expect(found.p999Error).toBe(0);
  });

  gpuTest('composites both images over the background, and clamps', async () => {
    const size: Size = [21, 18];
    const [widthPx, heightPx] = size;
    const expected = blobs(size, 5).map((value) => 1.4 * value - 0.1);
    const actual = disturbed(expected, 0.2).map((value, i) => (i % 4 === 3 ? 0.9 * value : value));
    const background = [0.2, 0.6, 1] as const;
    const options = { widthPx, heightPx, background };
    expectAlike(await onGpu(actual, expected, size, background), compareImages(actual, expected, options));
  });

  for (const format of ['rgba8unorm', 'rgba16float'] as const) {
    gpuTest(`compares ${format} with rgba32float`, async () => {
      const size: Size = [33, 20];
      const [widthPx, heightPx] = size;
      const expected = blobs(size, 6).map((value) => Math.max(0, Math.min(1, value)));
      const textures = [textureOf(expected, size, format), textureOf(expected, size)] as const;
      const rounded =
        format === 'rgba8unorm'
          ? expected.map((value) => Math.round(255 * value) / 255)
          : Float32Array.from(expected, (value) => fromHalfBits(toHalfBits(value)));
      expectAlike(
        await compareTextures(context, ...textures),
        compareImages(rounded, expected, { widthPx, heightPx }),
      );
      for (const texture of textures) context.memory.destroy(texture);
    });
  }

  gpuTest('names the image that has non-finite values', async () => {
    const size: Size = [40, 23];
    const good = blobs(size, 7);
    for (const value of [Number.NaN, Number.POSITIVE_INFINITY, Number.NEGATIVE_INFINITY]) {
      const bad = Float32Array.from(good);
      bad[4 * (18 * 40 + 35) + 1] = value;
      await expect(onGpu(bad, good, size)).rejects.toThrow(
        'The compared image has values that are not finite in 1 pixels, the first of them in the 16×16 px from 32, 16.',
      );
      await expect(onGpu(good, bad, size)).rejects.toThrow(NonFiniteImageError);
    }
  });

  gpuTest('keeps no memory, and refuses images of different sizes', async () => {
    const [small, large] = [textureOf(blobs([4, 4], 1), [4, 4]), textureOf(blobs([4, 5], 1), [4, 5])];
    const { totalBytes } = context.memory.report();
    await compareTextures(context, small, small);
    expect(context.memory.report().totalBytes).toBe(totalBytes);
    await expect(compareTextures(context, small, large)).rejects.toThrow('4×4 and 4×5 px');
  });
});
