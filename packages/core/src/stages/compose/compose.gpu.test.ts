import { gpuTest } from '@websplatter/node/gpu-test';
import { describe, expect } from 'vitest';
import {
  type Camera,
  cameraFromMatrices,
  orthographicCamera,
  perspectiveCamera,
} from '../../data/camera/camera.ts';
import { type DepthConvention, depthMapping, storedDepth } from '../../data/camera/depth-convention.ts';
import { SHADER_CONSTANTS } from '../../data/layout/constants.ts';
import { HostDepth, HostViewport } from '../../data/layout/structs.ts';
import { dispatchOf, recordPass } from '../../gpu/passes.ts';
import { Pipelines } from '../../gpu/pipelines.ts';
import { readTexture } from '../../gpu/read-texture.ts';
import { colorTexture, depthTexture, readFloats } from '../../testing/gpu-textures.ts';
import { seededRandom } from '../../testing/seeded-random.ts';
import { testGpu } from '../../testing/test-gpu.ts';
import { withClipDepth } from '../../testing/with-clip-depth.ts';
import type { RasterizeDepth } from '../quads/quads.ts';
import { composeDepth, compose as composeReference, composeWithEdges, faded } from './compose.reference.ts';
import { compose } from './compose.ts';

const gpu = testGpu();

const SIZE = { widthPx: 13, heightPx: 9 };
const PIXELS = SIZE.widthPx * SIZE.heightPx;
/** Origins of the image within the host's textures, different in each. */
const COLOR_ORIGIN_PX = [2, 1] as const;
const DEPTH_ORIGIN_PX = [1, 3] as const;
const SAMPLES = 4;

/** Premultiplied RGBA with empty, partial and full pixels, and colours beyond 1. */
function randomImage(seed: number): Float32Array {
  const random = seededRandom(seed);
  const values = new Float32Array(4 * PIXELS);
  for (let at = 0; at < values.length; at += 4) {
    const opacity = [0, 1, 1, 0.5, random()][Math.floor(5 * random())];
    values.set([...[1, 1.5, 0.02].map((most) => most * random() * opacity), opacity], at);
  }
  return values;
}

/** Places the image in a larger one, with garbage around it; `values` per pixel. */
function placed(image: ArrayLike<number>, values: number, [xPx, yPx]: readonly [number, number]) {
  const size = { widthPx: SIZE.widthPx + xPx + 1, heightPx: SIZE.heightPx + yPx + 2 };
  const larger = new Float32Array(values * size.widthPx * size.heightPx).fill(0.123);
  for (let i = 0; i < values * PIXELS; i++) {
    const pixel = Math.floor(i / values);
    const [x, y] = [pixel % SIZE.widthPx, Math.floor(pixel / SIZE.widthPx)];
    larger[values * ((y + yPx) * size.widthPx + x + xPx) + (i % values)] = image[i];
  }
  return { ...size, values: larger };
}

/**
 * View depths of every pixel's samples, on one surface or several. No two depths are about 5 %
 * apart, because rounding would decide whether they lie on one surface. 35 and 40, the far plane,
 * are two surfaces; their logarithms would make them one.
 */
function randomSamples(far: number): Float64Array {
  const random = seededRandom(8);
  const surfaces = [2, 2.02, 3, 3.05, 7, 35, far];
  const any = () => surfaces[Math.floor(surfaces.length * random())];
  return Float64Array.from(
    Array.from({ length: PIXELS }, () => {
      const [most, some] = [any(), any()];
      return Array.from(
        { length: SAMPLES },
        () => [most, most, most, some, some, any()][Math.floor(6 * random())],
      );
    }).flat(),
  );
}

interface Options {
  readonly camera: Camera;
  readonly depth: Omit<RasterizeDepth, 'isOrthographic'> | null;
  readonly isMultisampled: boolean;
  /** Whether pixels without splats have the host's colour. Default: false. */
  readonly hasHost?: boolean;
  /** Default: 1. */
  readonly fade?: number;
}

/** Composes random images and returns the largest errors of colours and depths. */
async function check(options: Options, pipelines = new Pipelines(gpu.device)) {
  const { camera, isMultisampled, hasHost = false, fade = 1 } = options;
  const isOrthographic = camera.projectionMatrix[11] === 0;
  const depth = options.depth && { ...options.depth, isOrthographic };
  const mapping = depth?.mapping ?? 'projection';
  const hasDepthLayer = depth?.layerFormat != null;
  const stored = (depthView: number, ndc?: readonly [number, number]) =>
    storedDepth(depthView, camera, mapping, ndc);

  const layer = randomImage(1);
  const behind = randomImage(2);
  const random = seededRandom(3);
  const depthsView = Float32Array.from({ length: PIXELS }, (_, i) => layer[4 * i + 3] * (1.5 + 5 * random()));
  const samplesView = randomSamples(camera.far);
  const hostColors = placed(behind, 4, COLOR_ORIGIN_PX);
  const hostDepths = placed(
    samplesView.map((value) => stored(value)),
    SAMPLES,
    DEPTH_ORIGIN_PX,
  );
  const origins = { colorOriginPx: COLOR_ORIGIN_PX, depthOriginPx: DEPTH_ORIGIN_PX };
  const viewport = HostViewport.pack({ ...origins, pxPerLayerPx: [1, 1], hasHost: Number(hasHost) });
  const hostDepth = HostDepth.pack(depthMapping(camera, mapping));
  // In float32, because the formats of real hosts would hide errors.
  const [image, depthImage] = (['rgba32float', 'r32float'] as const).map((format) =>
    gpu.device.createTexture({
      size: [SIZE.widthPx, SIZE.heightPx],
      format,
      usage: GPUTextureUsage.STORAGE_BINDING | GPUTextureUsage.COPY_SRC,
    }),
  );
  const inDepthLayer = Float32Array.from({ length: 4 * PIXELS }, (_, i) => (i % 4 ? 0 : depthsView[i / 4]));
  const stage = compose(depth, isMultisampled, fade !== 1, 'rgba32float');
  await pipelines.prepare([stage]);
  const bindings = {
    viewport: gpu.uniform(viewport),
    layer: colorTexture(gpu.device, layer, SIZE).createView(),
    behind: colorTexture(gpu.device, hostColors.values, hostColors).createView(),
    depthLayer: colorTexture(gpu.device, inDepthLayer, SIZE).createView(),
    hostDepth: gpu.uniform(hostDepth),
    hostDepths: depthTexture(gpu.device, { ...hostDepths, samples: SAMPLES }).createView(),
    image: image.createView(),
    depthImage: depthImage.createView(),
    fade: gpu.uniform(Float32Array.of(fade).buffer),
  };
  const encoder = gpu.device.createCommandEncoder();
  const tiles = [SIZE.widthPx, SIZE.heightPx].map((px) => Math.ceil(px / SHADER_CONSTANTS.IMAGE_TILE_PX));
  const dispatches = [dispatchOf(pipelines, stage, bindings, [tiles[0], tiles[1], 1])];
  recordPass(encoder, { label: 'compose', timed: 'composite', dispatches }, undefined);
  gpu.device.queue.submit([encoder.finish()]);
  const color = await readTexture(gpu.device, image);
  const depths = await readFloats(gpu.device, depthImage);
  const expectedColor = isMultisampled
    ? composeWithEdges(faded(layer, fade), behind, samplesView, SAMPLES, SIZE)
    : composeReference(faded(layer, fade), behind);
  const expectedDepths = composeDepth(faded(layer, fade), faded(depthsView, fade), SIZE, stored);
  for (let i = 0; i < PIXELS; i++) {
    const isEmpty = layer[4 * i + 3] === 0;
    if (hasHost && isEmpty) expectedColor.set(behind.slice(4 * i, 4 * i + 4), 4 * i);
    else expect(color.data[4 * i + 3] === 0, `nothing at pixel ${i}`).toBe(isEmpty);
  }
  return {
    colorError: largestError(expectedColor, (i) => color.data[i]),
    depthError: hasDepthLayer ? largestError(expectedDepths, (i) => depths[i]) : 0,
  };
}

function largestError(expected: Float64Array, actualAt: (index: number) => number): number {
  return expected.reduce((error, value, i) => Math.max(error, Math.abs(actualAt(i) - value)), 0);
}

const place = { position: [0, 0, 4], target: [0, 0, 0], aspect: 13 / 9, near: 0.5, far: 40 } as const;
const perspective = withClipDepth(perspectiveCamera({ ...place, fovYDegrees: 50 }), false);
const orthographic = withClipDepth(orthographicCamera({ ...place, height: 3 }), false);
const tilted = Float64Array.from(perspective.projectionMatrix);
tilted[2] = 0.02;
tilted[6] = -0.03;
const CONVENTIONS: Readonly<Record<string, readonly [Camera, DepthConvention['mapping']]>> = {
  'depth as projected': [perspective, 'projection'],
  'reversed depth': [withClipDepth(perspective, true), 'projection'],
  'a tilted near plane': [cameraFromMatrices(perspective.viewMatrix, tilted, perspective), 'projection'],
  'depth of parallel rays': [orthographic, 'projection'],
  'reversed depth of parallel rays': [withClipDepth(orthographic, true), 'projection'],
  'logarithmic depth': [perspective, 'logarithmic'],
  'logarithmic depth of parallel rays': [orthographic, 'logarithmic'],
};

const DEPTH = {
  mapping: 'projection',
  compare: 'less-equal',
  isTested: true,
  layerFormat: null,
} as const;

/** Two of WGSL's pow, each within 2^-20 of its value, for colours up to 1.5; SwiftShader: 6e-7. */
const COLOR_BOUND = 1e-5;
/** Some roundings of terms of about 1. SwiftShader errs by 7e-8. */
const DEPTH_BOUND = 1e-6;

describe('compose', () => {
  for (const isMultisampled of [false, true]) {
    const samples = isMultisampled ? 'several samples' : 'one sample';
    gpuTest(`colours over the host's, ${samples}`, async () => {
      const depth = isMultisampled ? DEPTH : null;
      const { colorError } = await check({ camera: perspective, depth, isMultisampled });
      expect(colorError).toBeLessThanOrEqual(COLOR_BOUND);
    });

    gpuTest(`the host's colours where there is no splat, ${samples}`, async () => {
      const depth = isMultisampled ? DEPTH : null;
      const { colorError } = await check({ camera: perspective, depth, isMultisampled, hasHost: true });
      expect(colorError).toBeLessThanOrEqual(COLOR_BOUND);
    });

    gpuTest(`a part of the finished splats, and depth where it covers half, ${samples}`, async () => {
      const depth = { ...DEPTH, layerFormat: 'r32float' } as const;
      for (const fade of [0.3, 0.8]) {
        const { colorError, depthError } = await check({ camera: perspective, depth, isMultisampled, fade });
        expect(colorError).toBeLessThanOrEqual(COLOR_BOUND);
        expect(depthError).toBeLessThanOrEqual(DEPTH_BOUND);
      }
    });

    for (const [name, [camera, mapping]] of Object.entries(CONVENTIONS)) {
      gpuTest(`colours and ${name}, ${samples}`, async () => {
        const depth = { ...DEPTH, mapping, layerFormat: 'r32float' } as const;
        const { colorError, depthError } = await check({ camera, depth, isMultisampled });
        expect(colorError).toBeLessThanOrEqual(COLOR_BOUND);
        expect(depthError).toBeLessThanOrEqual(DEPTH_BOUND);
      });
    }
  }

  for (const [what, find, replace] of [
    ['one surface for two', 'farthest <= EDGE_RATIO * nearest', 'true'],
    ['the far surface for the near one', 'candidateShare > neighborShare', 'candidateShare < neighborShare'],
    ['a colour that is blended in linear light', 'decodeSrgb(covered / max(opacity, 1e-6))', 'covered'],
  ] as const)
    gpuTest(`${what} is noticed`, async () => {
      const mutation = { file: 'stages/compose', find, replace };
      const options = { camera: perspective, depth: DEPTH, isMultisampled: true };
      const { colorError } = await check(options, new Pipelines(gpu.device, mutation));
      expect(colorError).toBeGreaterThan(0.01);
    });

  gpuTest('a mean depth that is not divided by the covered share of the pixel is noticed', async () => {
    const mutation = { file: 'stages/compose', find: ' / max(splats.a, 0.5)', replace: '' };
    const depth = { ...DEPTH, layerFormat: 'r32float' } as const;
    const options = { camera: perspective, depth, isMultisampled: false };
    const { depthError } = await check(options, new Pipelines(gpu.device, mutation));
    expect(depthError).toBeGreaterThan(0.001);
  });
});
