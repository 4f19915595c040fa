import { gpuTest } from '@websplatter/node/gpu-test';
import { describe, expect } from 'vitest';
import type { DepthConvention } from '../../data/camera/depth-convention.ts';
import { HostViewport } from '../../data/layout/structs.ts';
import { Pipelines } from '../../gpu/pipelines.ts';
import { depthTexture, drawStage, readFloats } from '../../testing/gpu-textures.ts';
import { seededRandom } from '../../testing/seeded-random.ts';
import { testGpu } from '../../testing/test-gpu.ts';
import { TESTED_DEPTH_FORMAT } from '../quads/quads.ts';
import { type LayerPlace, resolveDepth as resolveReference } from './compose.reference.ts';
import { resolveDepth, resolveDepthState } from './compose.ts';

const gpu = testGpu();

/** Float32 values of 0…1, including both ends. */
function randomDepths(length: number): Float32Array {
  const random = seededRandom(length);
  return Float32Array.from({ length }, () => [0, 1, random(), random(), random()][Math.floor(5 * random())]);
}

interface Options {
  readonly compare: DepthConvention['compare'];
  readonly samples: 1 | 4;
  readonly place: LayerPlace;
}

/** Resolves random depths on the GPU and by the reference. */
async function run({ compare, samples, place }: Options, pipelines = new Pipelines(gpu.device)) {
  const { widthPx, heightPx, originPx, pxPerLayerPx } = place;
  const size = {
    widthPx: originPx[0] + Math.round(widthPx * pxPerLayerPx[0]) + 2,
    heightPx: originPx[1] + Math.round(heightPx * pxPerLayerPx[1]) + 3,
  };
  const host = { ...size, samples, values: randomDepths(samples * size.widthPx * size.heightPx) };
  // Only compose uses the host's colours.
  const viewport = HostViewport.pack({
    colorOriginPx: [1000, 1000],
    depthOriginPx: originPx,
    pxPerLayerPx,
    hasHost: 0,
  });
  const target = gpu.device.createTexture({
    size: [widthPx, heightPx],
    format: TESTED_DEPTH_FORMAT,
    usage: GPUTextureUsage.RENDER_ATTACHMENT | GPUTextureUsage.COPY_SRC,
  });
  const isScaled = pxPerLayerPx.some((scale) => scale !== 1);
  await drawStage(
    gpu.device,
    pipelines,
    [resolveDepth(compare, samples > 1, isScaled), resolveDepthState],
    { viewport: gpu.uniform(viewport), hostDepths: depthTexture(gpu.device, host).createView() },
    {
      colorAttachments: [],
      depthStencilAttachment: {
        view: target.createView(),
        depthLoadOp: 'clear',
        depthStoreOp: 'store',
        depthClearValue: 0.5,
      },
    },
  );
  return {
    actual: [...(await readFloats(gpu.device, target))],
    expected: [...resolveReference(host, place, compare)],
  };
}

/** A layer for part of a host's image, `widthPx` by `heightPx` at `originPx`. */
function layerFor(
  [imageWidthPx, imageHeightPx]: readonly [number, number],
  [widthPx, heightPx]: readonly [number, number],
  originPx: readonly [number, number],
): LayerPlace {
  return {
    widthPx,
    heightPx,
    originPx,
    pxPerLayerPx: [imageWidthPx / widthPx, imageHeightPx / heightPx],
  };
}

// Images of smaller layers have odd sizes: no middle of a layer's pixel lies between host pixels.
const PLACES: Readonly<Record<string, LayerPlace>> = {
  'the whole image': layerFor([17, 9], [17, 9], [0, 0]),
  'a part of the image': layerFor([17, 9], [17, 9], [5, 2]),
  'one pixel': layerFor([1, 1], [1, 1], [3, 4]),
  'a smaller layer': layerFor([33, 21], [14, 10], [0, 0]),
  'a smaller layer of a part': layerFor([33, 21], [31, 4], [6, 1]),
};

describe('resolve-depth', () => {
  for (const [name, place] of Object.entries(PLACES)) {
    for (const samples of [1, 4] as const) {
      for (const compare of ['less-equal', 'greater-equal'] as const) {
        gpuTest(`${name}, ${samples} samples, ${compare}: the reference's depths`, async () => {
          const { actual, expected } = await run({ compare, samples, place });
          expect(actual).toEqual(expected);
        });
      }
    }
  }

  for (const [what, find, replace] of [
    ['the nearest sample instead of the farthest', 'max(farthest, depth)', 'min(farthest, depth)'],
    ['a missing sample', 'i < samples', 'i < samples - 1u'],
    [
      'the corner of a pixel instead of its middle',
      'position.xy * viewport',
      'floor(position.xy) * viewport',
    ],
  ] as const)
    gpuTest(`${what} is noticed`, async () => {
      const mutation = { file: 'stages/resolve-depth', find, replace };
      const place = PLACES['a smaller layer'];
      const options = { compare: 'less-equal', samples: 4, place } as const;
      const { actual, expected } = await run(options, new Pipelines(gpu.device, mutation));
      expect(actual).not.toEqual(expected);
    });
});
