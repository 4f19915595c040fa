// Proves: splats in a host's frame: depth both ways, edges, textures.
import { createNodeGpu } from '@websplatter/node';
import { gpuTest, shareTestDevice } from '@websplatter/node/gpu-test';
import { beforeAll, beforeEach, describe, expect } from 'vitest';
import type { SplatCloud } from '../clouds/splat-cloud.ts';
import { SplatEngine } from '../create-engine.ts';
import type { AccuracySettings, FrameRasterizer } from '../data/accuracy/accuracy.ts';
import { type Camera, perspectiveCamera, projectionOf } from '../data/camera/camera.ts';
import { type DepthConvention, storedDepth } from '../data/camera/depth-convention.ts';
import { DestroyedError, InvalidArgumentError } from '../data/errors.ts';
import { toHalfBits } from '../data/layout/half.ts';
import { identity4, invert3, linearPart, transform3 } from '../data/math/mat4.ts';
import type { SplatSet } from '../data/splats/splat-set.ts';
import { followEdits } from '../features/edits/edits.clouds.ts';
import { SplatEdits } from '../features/edits/splat-edits.data.ts';
import type { EmbeddedImage } from '../frame/parts/host-textures.ts';
import { reveal } from '../gpu/effects/index.ts';
import { readWords } from '../gpu/read-buffer.ts';
import { readTexture } from '../gpu/read-texture.ts';
import { compareImages, renderReference } from '../reference/index.ts';
import { compose, faded } from '../stages/compose/compose.reference.ts';
import { onOwnAdapter } from '../testing/device-with.ts';
import { prepared } from '../testing/prepared.ts';
import { randomSplats, splatsOf } from '../testing/random-splats.ts';
import { seededRandom } from '../testing/seeded-random.ts';
import { testCameras } from '../testing/test-cameras.ts';
import { withClipDepth } from '../testing/with-clip-depth.ts';
import type { EmbeddedFrameRequest, EmbeddedView } from './embedded-view.ts';

const isFull = process.env.WEBSPLATTER_FULL === '1';
const SIZE = { widthPx: 48, heightPx: 40 };
const PIXELS = SIZE.widthPx * SIZE.heightPx;
const SET = randomSplats({ count: 600, seed: 5, logScales: [-4, -1.5] });
/** Splats lie at view depths of about 0.2 to 3.6. */
const WALL_DEPTH = 1.9;

const BLENDABLE = 'float32-blendable' as GPUFeatureName;

let device: GPUDevice;
let engine: SplatEngine;
let cloud: SplatCloud;
/** Preset `high` with the rasteriser under test. */
let high: Partial<AccuracySettings> & { readonly preset: 'high' };

/** Starts the device and the engine that the helpers below draw with. */
async function start(rasterizer: AccuracySettings['rasterizer'], features: readonly GPUFeatureName[]) {
  device = await shareTestDevice({ requiredFeatures: [...features] });
  high = { preset: 'high', rasterizer };
  engine = await SplatEngine.create({ device: onOwnAdapter(device, 'embedded'), accuracy: high });
  cloud = engine.add(SET);
}

interface Host {
  readonly colorFormat?: GPUTextureFormat;
  readonly colorUsage?: GPUTextureUsageFlags;
  readonly depthFormat?: GPUTextureFormat;
  readonly sampleCount?: 1 | 4;
  readonly origin?: readonly [number, number];
}

/** Linear premultiplied colours behind the splats, some of them transparent. */
const BEHIND = (() => {
  const random = seededRandom(9);
  const values = new Float64Array(4 * PIXELS);
  for (let i = 0; i < PIXELS; i++) {
    const opacity = [1, 1, 0, random()][i % 4];
    const color = [random(), random() ** 3, 2 * random() ** 2].map((value) => value * opacity);
    values.set([...color, opacity], 4 * i);
  }
  return values;
})();

/** A wall in the left half of the image, nothing in the right. */
const hostDepthAt = (column: number) => (column < SIZE.widthPx / 2 ? WALL_DEPTH : Number.POSITIVE_INFINITY);
const HOST_DEPTHS = Float64Array.from({ length: PIXELS }, (_, i) => hostDepthAt(i % SIZE.widthPx));

/** A host's pass: textures larger than the image, which lies at `origin` in them. */
function hostPass(camera: Camera, depth: DepthConvention, host: Host) {
  const { colorFormat = 'rgba16float', depthFormat = 'depth24plus', sampleCount = 1, origin = [0, 0] } = host;
  const size = [SIZE.widthPx + origin[0] + 3, SIZE.heightPx + origin[1] + 2];
  const color = device.createTexture({
    size,
    format: colorFormat,
    usage: GPUTextureUsage.COPY_DST | (host.colorUsage ?? GPUTextureUsage.TEXTURE_BINDING),
  });
  const bytes =
    colorFormat === 'rgba16float'
      ? Uint16Array.from(BEHIND, toHalfBits)
      : Uint8Array.from(BEHIND, (value) => Math.round(255 * Math.min(1, value)));
  device.queue.writeTexture(
    { texture: color, origin: [...origin] },
    bytes,
    { bytesPerRow: bytes.byteLength / SIZE.heightPx },
    [SIZE.widthPx, SIZE.heightPx],
  );
  const depthTexture = device.createTexture({
    size,
    format: depthFormat,
    sampleCount,
    usage: GPUTextureUsage.RENDER_ATTACHMENT | GPUTextureUsage.TEXTURE_BINDING,
  });
  drawWall(depthTexture, storedDepth(WALL_DEPTH, camera, depth.mapping), depth, origin);
  return { pass: { color, depth: depthTexture, xPx: origin[0], yPx: origin[1] }, bytes, color };
}

/** Clears to the far plane and draws the wall into the left half, as a host's pass would. */
function drawWall(
  texture: GPUTexture,
  stored: number,
  { compare }: DepthConvention,
  [xPx, yPx]: readonly [number, number],
): void {
  const module = device.createShaderModule({
    code: `@vertex fn corner(@builtin(vertex_index) i: u32) -> @builtin(position) vec4f {
        return vec4f(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, ${stored}, 1.0);
      }`,
  });
  const pipeline = device.createRenderPipeline({
    layout: 'auto',
    vertex: { module },
    multisample: { count: texture.sampleCount },
    depthStencil: { format: texture.format, depthCompare: 'always', depthWriteEnabled: true },
  });
  const encoder = device.createCommandEncoder();
  const hasStencil = texture.format.includes('stencil');
  const pass = encoder.beginRenderPass({
    colorAttachments: [],
    depthStencilAttachment: {
      view: texture.createView(),
      depthLoadOp: 'clear',
      depthStoreOp: 'store',
      depthClearValue: compare === 'less-equal' ? 1 : 0,
      ...(hasStencil && { stencilLoadOp: 'clear', stencilStoreOp: 'store' }),
    },
  });
  pass.setPipeline(pipeline);
  pass.setScissorRect(xPx, yPx, SIZE.widthPx / 2, SIZE.heightPx);
  pass.draw(3);
  pass.end();
  device.queue.submit([encoder.finish()]);
}

function record(view: EmbeddedView, pass: Parameters<EmbeddedView['draw']>[1]): EmbeddedImage {
  const encoder = device.createCommandEncoder();
  const image = view.draw(encoder, pass);
  device.queue.submit([encoder.finish()]);
  return image;
}

/** Reads back an r32float texture. */
async function readDepths(texture: GPUTexture): Promise<Float32Array> {
  const bytesPerRow = 256;
  const buffer = device.createBuffer({
    size: bytesPerRow * SIZE.heightPx,
    usage: GPUBufferUsage.COPY_DST | GPUBufferUsage.COPY_SRC,
  });
  const encoder = device.createCommandEncoder();
  encoder.copyTextureToBuffer({ texture }, { buffer, bytesPerRow }, [SIZE.widthPx, SIZE.heightPx]);
  device.queue.submit([encoder.finish()]);
  const rows = new Float32Array((await readWords(device, buffer)).buffer);
  buffer.destroy();
  return Float32Array.from(
    { length: PIXELS },
    (_, i) => rows[(Math.floor(i / SIZE.widthPx) * bytesPerRow) / 4 + (i % SIZE.widthPx)],
  );
}

const CONVENTIONS: readonly [string, DepthConvention, boolean][] = [
  ['depth as projected', { compare: 'less-equal', mapping: 'projection' }, false],
  ['reversed depth', { compare: 'greater-equal', mapping: 'projection' }, true],
  ['logarithmic depth', { compare: 'less-equal', mapping: 'logarithmic' }, false],
];

async function expectRight(
  camera: Camera,
  depth: DepthConvention,
  host: Host = {},
  resolutionScale = 1,
  hasOccluders = true,
): Promise<void> {
  const view = engine.createEmbeddedView();
  const frame = { camera, clouds: [{ cloud }], ...SIZE, depth, hasOccluders, writesDepth: true } as const;
  await prepared(view, { ...frame, accuracy: { ...high, resolutionScale } });
  const { pass, bytes, color } = hostPass(camera, depth, host);
  expect(view.shape?.rasterizer).toBe(high.rasterizer);
  const image = record(view, pass);
  const { data } = await readTexture(device, image.color);
  const depths = await readDepths(image.depth!);

  const hostDepths = hasOccluders ? HOST_DEPTHS : HOST_DEPTHS.map(() => Number.POSITIVE_INFINITY);
  const scene = { clouds: [{ set: SET }], camera, ...SIZE, hostDepths };
  const layer = renderReference({ ...scene, settings: { resolutionScale } });
  expect(layer.visibleSplats).toBeGreaterThan(100);
  const behind = bytes instanceof Uint16Array ? BEHIND : Float64Array.from(bytes, (value) => value / 255);
  const expected = compose(layer.data, behind);
  const opacity = (image: ArrayLike<number>, i: number) => image[4 * i + 3];
  for (let i = 0; i < PIXELS; i++)
    if (opacity(data, i) > 0 !== opacity(expected, i) > 0)
      expect.fail(`pixel ${i}: opacity ${opacity(data, i)}, expected ${opacity(expected, i)}`);
  const options = { ...SIZE };
  expect(compareImages(data, expected, options).psnrDb).toBeGreaterThanOrEqual(50);

  let [covered, differing] = [0, 0];
  const weighted = high.rasterizer === 'tiles' ? layer.medianDepths! : layer.depths!;
  for (let i = 0; i < PIXELS; i++) {
    const coverage = layer.data[4 * i + 3];
    if (Math.abs(coverage - 0.5) < 0.01) continue;
    if (coverage < 0.5) {
      if (depths[i] !== -1) expect.fail(`pixel ${i}: depth ${depths[i]}, expected -1`);
      continue;
    }
    covered++;
    const depthView = weighted[i] / coverage;
    // Float16 if float32 cannot be blended: every layer rounds the sum to 11 bits.
    const bounds = [depthView * 0.98, depthView * 1.02].map((value) =>
      storedDepth(value, camera, depth.mapping),
    );
    if (depths[i] < Math.min(...bounds) || depths[i] > Math.max(...bounds)) differing++;
  }
  expect(covered).toBeGreaterThan(100);
  // Rounding decides which splat is the median where two reach the half.
  expect(differing).toBeLessThanOrEqual(high.rasterizer === 'tiles' ? 0.01 * covered : 0);
  view.destroy();
  color.destroy();
}

const WALL_COLOR = [0.9, 0.5, 0.1] as const;
const SKY_COLOR = [0.02, 0.04, 0.3] as const;
const EDGE_SIZE = 64;

/** A camera facing a wall, with splats that fill the view in front of the wall and behind it. */
function edgeScene() {
  const camera = perspectiveCamera({ position: [0, 0, 2], target: [0, 0, 0], fovYDegrees: 40, aspect: 1 });
  const sheet = (z: number, opacityLogit: number, colorDc: readonly number[]) =>
    splatsOf([{ position: [0, 0, z], opacityLogit, colorDc, logScales: [6, 6, -6] }]);
  return { camera, near: sheet(1, -0.5, [1.5, 1, -1]), far: sheet(-1, 4, [-1, 1.2, 0.8]) };
}

/** A wall with a slanting edge before the sky, drawn with four samples, resolved, as by a host. */
function drawSlantedWall(camera: Camera, { compare, mapping }: DepthConvention) {
  const texture = (format: GPUTextureFormat, sampleCount: number, usage: GPUTextureUsageFlags) =>
    device.createTexture({
      size: [EDGE_SIZE, EDGE_SIZE],
      format,
      sampleCount,
      usage: usage | GPUTextureUsage.RENDER_ATTACHMENT,
    });
  const samples = texture('rgba16float', 4, 0);
  const color = texture('rgba16float', 1, GPUTextureUsage.TEXTURE_BINDING | GPUTextureUsage.COPY_SRC);
  const depth = texture('depth32float', 4, GPUTextureUsage.TEXTURE_BINDING);
  const module = device.createShaderModule({
    code: `@vertex fn corner(@builtin(vertex_index) i: u32) -> @builtin(position) vec4f {
        let corners = array(vec2f(-1.5, -1.0), vec2f(-0.23, -1.0), vec2f(-1.5, 1.0), vec2f(0.31, 1.0));
        return vec4f(corners[i], ${storedDepth(2, camera, mapping)}, 1.0);
      }
      @fragment fn paint() -> @location(0) vec4f { return vec4f(${WALL_COLOR.join(', ')}, 1.0); }`,
  });
  const pipeline = device.createRenderPipeline({
    layout: 'auto',
    vertex: { module },
    fragment: { module, targets: [{ format: samples.format }] },
    primitive: { topology: 'triangle-strip' },
    multisample: { count: 4 },
    depthStencil: { format: depth.format, depthCompare: compare, depthWriteEnabled: true },
  });
  const encoder = device.createCommandEncoder();
  const pass = encoder.beginRenderPass({
    colorAttachments: [
      {
        view: samples.createView(),
        resolveTarget: color.createView(),
        loadOp: 'clear',
        storeOp: 'store',
        clearValue: [...SKY_COLOR, 1],
      },
    ],
    depthStencilAttachment: {
      view: depth.createView(),
      depthLoadOp: 'clear',
      depthStoreOp: 'store',
      depthClearValue: compare === 'less-equal' ? 1 : 0,
    },
  });
  pass.setPipeline(pipeline);
  pass.draw(4);
  pass.end();
  device.queue.submit([encoder.finish()]);
  samples.destroy();
  return { color, depth };
}

/**
 * Draws `sets` at the slanting wall and compares the pixels on its edge with the expected colour:
 * the mean, in linear light, of the colours three pixels further into the wall and three pixels out
 * of it, weighted by the part of the pixel that the wall covers.
 */
async function drawEdge(camera: Camera, depth: DepthConvention, sets: readonly SplatSet[]) {
  const wall = drawSlantedWall(camera, depth);
  const host = (await readTexture(device, wall.color)).data;
  const clouds = sets.map((set) => ({ cloud: engine.add(set) }));
  const view = engine.createEmbeddedView();
  await prepared(view, { camera, clouds, widthPx: EDGE_SIZE, heightPx: EDGE_SIZE, depth });
  const image = record(view, { ...wall, xPx: 0, yPx: 0 });
  const { data } = await readTexture(device, image.color);
  view.destroy();
  for (const { cloud: each } of clouds) each.destroy();
  for (const each of Object.values(wall)) each.destroy();

  // Where there is no splat the host shows its own image.
  const shown = (channel: number) => (data[4 * (channel >> 2) + 3] > 0 ? data[channel] : host[channel]);
  let pixels = 0;
  let maxError = 0;
  for (let row = 0; row < EDGE_SIZE; row++) {
    for (let column = 3; column < EDGE_SIZE - 3; column++) {
      const at = 4 * (row * EDGE_SIZE + column);
      const share = (host[at + 2] - SKY_COLOR[2]) / (WALL_COLOR[2] - SKY_COLOR[2]);
      if (share < 0.1 || share > 0.9) continue;
      pixels++;
      for (let channel = at; channel < at + 3; channel++) {
        const expected = share * shown(channel - 12) + (1 - share) * shown(channel + 12);
        maxError = Math.max(maxError, Math.abs(shown(channel) - expected));
      }
    }
  }
  return { pixels, maxError };
}

/**
 * Without `float32-blendable`, splats' depth is blended in r16float, which compute shaders cannot
 * write: quads draw such frames in any case.
 */
const VARIANTS = [
  { rasterizer: 'quads', features: [] },
  { rasterizer: 'tiles', features: [BLENDABLE] },
] as const;

describe.each(VARIANTS)('an embedded view that draws $rasterizer', ({ rasterizer, features }) => {
  let canStart = true;
  beforeAll(async () => {
    const { adapter } = await createNodeGpu();
    canStart = features.every((feature) => adapter.features.has(feature));
    if (canStart) await start(rasterizer, features);
  });
  beforeEach(({ skip }) => {
    if (!canStart) skip(`this adapter lacks ${features.join(', ')}`);
  });

  for (const [name, depth, isReversed] of CONVENTIONS) {
    gpuTest(`hides splats behind the host's ${name}, and returns their own`, async () => {
      const { perspective, orthographic } = testCameras(SIZE.widthPx / SIZE.heightPx);
      for (const camera of [perspective, orthographic]) {
        await expectRight(withClipDepth(camera, isReversed), depth);
      }
    });
  }

  for (const [name, depth, isReversed] of CONVENTIONS) {
    gpuTest(`returns the depth of splats as the host's ${name}, which hides none if told so`, async () => {
      const { perspective } = testCameras(SIZE.widthPx / SIZE.heightPx);
      const camera = withClipDepth(perspective, isReversed);
      await expectRight(camera, depth, {}, 1, false);
      await expectRight(camera, depth, { sampleCount: 4 }, 0.5, false);
    });
  }

  gpuTest('knows whether its last image shows the prepared frame', async () => {
    const [, depth] = CONVENTIONS[0];
    const cameras = testCameras(SIZE.widthPx / SIZE.heightPx);
    const own = engine.add(SET);
    const view = engine.createEmbeddedView();
    const { pass, color } = hostPass(cameras.perspective, depth, {});
    const instance = { cloud: own, effects: [reveal({ from: [0, 0, 0], radius: 9 })] };
    const first = {
      camera: cameras.perspective,
      clouds: [instance],
      ...SIZE,
      depth,
      hasOccluders: false,
      writesDepth: true,
    } as const;
    const aside = identity4();
    aside[12] = 0.1;
    const changes: readonly Partial<EmbeddedFrameRequest>[] = [
      {},
      { camera: withClipDepth(cameras.mirrored, false) },
      { widthPx: SIZE.widthPx - 8 },
      { clouds: [{ ...instance, modelMatrix: aside }] },
      { clouds: [{ ...instance, opacity: 0.5 }] },
      { clouds: [{ ...instance, effects: [reveal({ from: [0, 0, 0], radius: 0.5 })] }] },
      { clouds: [{ ...instance, instances: { modelMatrices: [...identity4(), ...aside] } }] },
      { clouds: [instance, { cloud }] },
      { accuracy: { ...high, alphaCutoff: 0.1 } },
    ];
    expect(view.drawnImage).toBeNull();
    const edits = new SplatEdits();
    await followEdits(own, edits);
    const edit = () => edits.set({ first: 0, count: 100 }, { opacities: [0.1] });
    for (const change of [...changes, edit]) {
      if (change === edit) edit();
      await prepared(view, { ...first, ...change });
      await view.whenComplete();
      await prepared(view, { ...first, ...change });
      expect(view.drawnImage, `${Object.keys(change)}`).toBeNull();
      const image = record(view, pass);
      for (let again = 0; again < 3; again++) {
        const { framesPrepared } = engine.counters();
        expect(view.prepare({ ...first, ...change })).toBe(true);
        expect(view.drawnImage).toBe(image);
        expect(engine.counters().framesPrepared).toBe(framesPrepared);
      }
    }
    view.destroy();
    own.destroy();
    color.destroy();
  });

  gpuTest(
    'tests depth only if there may be something that hides splats, and never waits for a shader',
    async () => {
      const depth = CONVENTIONS[0][1];
      const camera = withClipDepth(testCameras(SIZE.widthPx / SIZE.heightPx).perspective, false);
      const { pass, color } = hostPass(camera, depth, {});
      const frame = { camera, clouds: [{ cloud }], ...SIZE };
      const imageOf = async (view: EmbeddedView) =>
        (await readTexture(device, record(view, pass).color)).data;
      const imageWith = async (options: Pick<EmbeddedFrameRequest, 'depth'>) => {
        const view = engine.createEmbeddedView();
        await prepared(view, { ...frame, ...options });
        const image = await imageOf(view);
        view.destroy();
        return image;
      };
      const [unhidden, hidden] = [await imageWith({}), await imageWith({ depth })];
      expect(hidden).not.toEqual(unhidden);

      // Shaders that no other test has compiled.
      const view = engine.createEmbeddedView();
      const changing = { ...frame, depth, accuracy: { ...high, sortKeyBits: 24 } } as const;
      await prepared(view, { ...changing, hasOccluders: false });
      expect(view.shape?.depth).toBeNull();
      expect(await imageOf(view)).toEqual(unhidden);
      expect(view.prepare(changing)).toBe(true);
      await expect.poll(() => view.prepare(changing) && view.shape?.depth).toBeTruthy();
      expect(await imageOf(view)).toEqual(hidden);
      expect(view.prepare({ ...changing, hasOccluders: false })).toBe(true);
      expect(await imageOf(view)).toEqual(unhidden);
      view.destroy();
      color.destroy();
    },
  );

  gpuTest(
    'writes its image into the host’s, with the same bits, and nothing beside the viewport',
    async () => {
      const camera = testCameras(SIZE.widthPx / SIZE.heightPx).perspective;
      const view = engine.createEmbeddedView();
      await prepared(view, { camera, clouds: [{ cloud }], ...SIZE });
      const { TEXTURE_BINDING, COPY_SRC } = GPUTextureUsage;
      for (const readable of [TEXTURE_BINDING, 0]) {
        const host = { colorUsage: readable | COPY_SRC, origin: [2, 1] } as const;
        const { pass, color } = hostPass(camera, CONVENTIONS[0][1], host);
        const before = await readTexture(device, color);
        const image = (await readTexture(device, record(view, pass).color)).data;
        record(view, { ...pass, writesColor: true });
        const { data } = await readTexture(device, color);
        const expected = before.data.slice();
        for (let i = 0; i < PIXELS; i++) {
          const at = 4 * ((Math.floor(i / SIZE.widthPx) + 1) * color.width + (i % SIZE.widthPx) + 2);
          if (image[4 * i + 3] > 0) expected.set(image.slice(4 * i, 4 * i + 4), at);
        }
        expect(data).toEqual(expected);
        expect(data).not.toEqual(before.data);
        color.destroy();
      }
      view.destroy();
    },
  );

  for (const [name, depth, isReversed] of CONVENTIONS) {
    gpuTest(`tells what covers points: splats in front, and the host's ${name}`, async () => {
      const camera = withClipDepth(testCameras(SIZE.widthPx / SIZE.heightPx).perspective, isReversed);
      const view = engine.createEmbeddedView();
      await prepared(view, { camera, clouds: [{ cloud }], ...SIZE, depth });
      const { pass, color } = hostPass(camera, depth, { origin: [2, 1] });
      record(view, pass);
      // Left and right of the middle, before the wall, in it and behind it.
      const places = [8, 40].flatMap((column) =>
        [0.3, 0.99, 1.01, 1.5].map((part) => [column, part] as const),
      );
      const { focalPx, centerPx } = projectionOf(camera, SIZE.widthPx, SIZE.heightPx);
      const { viewMatrix: v } = camera;
      const points = places.map(([column, part]) => {
        const depthView = part * WALL_DEPTH;
        const x = ((column + 0.5 - centerPx[0]) / focalPx[0]) * depthView;
        const y = ((centerPx[1] - 20.5) / focalPx[1]) * depthView;
        const toWorld = invert3(linearPart(v))!;
        return { point: transform3(toWorld, [x - v[12], y - v[13], -depthView - v[14]]) };
      });
      const found = await view.coverage(points);
      expect(found!.map(({ isBehindHost }) => isBehindHost)).toEqual([
        ...[false, false, true, true],
        ...[false, false, false, false],
      ]);
      const opacities = found!.map(({ opacity }) => opacity);
      // Whatever hides splats from the eye, points behind them are covered no less.
      for (const start of [0, 4]) {
        const line = opacities.slice(start, start + 4);
        expect(line).toEqual(line.toSorted((a, b) => a - b));
        expect(line[3]).toBeGreaterThan(0);
      }
      const tolerant = await view.coverage(points.map((each) => ({ ...each, tolerance: 10 })));
      for (const { opacity, isBehindHost } of tolerant!) {
        expect({ opacity, isBehindHost }).toEqual({ opacity: 0, isBehindHost: false });
      }
      view.destroy();
      color.destroy();
    });
  }

  gpuTest('fades the finished picture of all clouds, not each splat', async () => {
    const [, depth] = CONVENTIONS[0];
    const camera = withClipDepth(testCameras(SIZE.widthPx / SIZE.heightPx).perspective, false);
    const { pass, color } = hostPass(camera, depth, {});
    const view = engine.createEmbeddedView();
    const frame = { camera, clouds: [{ cloud }], ...SIZE, depth };
    const scene = { clouds: [{ set: SET }], camera, ...SIZE, hostDepths: HOST_DEPTHS };
    const layer = renderReference(scene).data;
    const point = { point: [0, 0, -1] } as const;
    const seen: { picked: number | undefined; opacity: number }[] = [];
    for (const fade of [1, 0.3, 0.7, 0, 1]) {
      const preparedFaded = () => (view.prepare({ ...frame, fade }) ? view.shape?.isFaded : null);
      await expect.poll(preparedFaded).toBe(fade !== 1);
      const { data } = await readTexture(device, record(view, pass).color);
      const expected = compose(faded(layer, fade), BEHIND);
      expect(compareImages(data, expected, SIZE).psnrDb).toBeGreaterThanOrEqual(50);
      const [cover] = (await view.coverage([point]))!;
      seen.push({ picked: (await view.pick(20, 20))?.row, opacity: cover.opacity });
      expect(view.effects().find(({ name }) => name === 'fade')?.isOn).toBe(fade !== 1);
    }
    const [full] = seen;
    expect(full.picked).toBeDefined();
    expect(full.opacity).toBeGreaterThan(0.1);
    expect(seen).toEqual(
      [1, 0.3, 0.7, 0, 1].map((fade) => ({ ...full, opacity: expect.closeTo(fade * full.opacity, 6) })),
    );
    for (const fade of [-0.1, 1.5, Number.NaN])
      expect(() => view.prepare({ ...frame, fade })).toThrow(InvalidArgumentError);
    view.destroy();
    color.destroy();
  });

  gpuTest('says what draws it, and why', async () => {
    const camera = withClipDepth(testCameras(SIZE.widthPx / SIZE.heightPx).perspective, false);
    const frame = { camera, clouds: [{ cloud }], ...SIZE, depth: CONVENTIONS[0][1], writesDepth: true };
    const ofTiles =
      rasterizer === 'tiles'
        ? { rasterizer, reason: 'tiles were asked for' }
        : { rasterizer, reason: 'tiles cannot write depth on this device' };
    for (const [asked, expected] of [
      ['quads', { rasterizer: 'quads', reason: 'quads were asked for' }],
      ['tiles', ofTiles],
    ] as const) {
      const view = engine.createEmbeddedView();
      await prepared(view, { ...frame, accuracy: { ...high, rasterizer: asked } });
      expect(view.rasterizer).toMatchObject(expected);
      const effect = view.effects().find(({ name }) => name === 'tiles');
      expect(effect).toMatchObject({ isOn: expected.rasterizer === 'tiles', reason: expected.reason });
      view.destroy();
    }
  });

  gpuTest('draws splats at half and at two thirds of the resolution', async () => {
    const camera = withClipDepth(testCameras(SIZE.widthPx / SIZE.heightPx).perspective, false);
    const [, depth] = CONVENTIONS[0];
    for (const resolutionScale of [0.5, 0.66]) {
      await expectRight(camera, depth, { origin: [5, 3] }, resolutionScale);
      await expectRight(camera, depth, { sampleCount: 4 }, resolutionScale);
    }
  });

  gpuTest('reads every kind of host texture, at any place in it', async () => {
    const { perspective } = testCameras(SIZE.widthPx / SIZE.heightPx);
    const camera = withClipDepth(perspective, false);
    const [, depth] = CONVENTIONS[0];
    const hosts: readonly Host[] = [
      { sampleCount: 4, origin: [5, 2] },
      { depthFormat: 'depth32float', origin: [0, 7] },
      { depthFormat: 'depth24plus-stencil8', sampleCount: 4 },
      { colorFormat: 'rgba8unorm', colorUsage: GPUTextureUsage.COPY_SRC, origin: [4, 3] },
      { colorFormat: 'rgba8unorm' },
    ];
    for (const host of hosts) await expectRight(camera, depth, host);
  });

  gpuTest('white at half opacity over black is 128 and not 188', async () => {
    const white = splatsOf([{ opacityLogit: 0, colorDc: [1.7725, 1.7725, 1.7725], logScales: [6, 6, 6] }]);
    const one = engine.add(white);
    const { perspective: camera } = testCameras(1);
    const view = engine.createEmbeddedView();
    await prepared(view, { camera, clouds: [{ cloud: one }], ...SIZE });
    const color = device.createTexture({
      size: [SIZE.widthPx, SIZE.heightPx],
      format: 'rgba16float',
      usage: GPUTextureUsage.RENDER_ATTACHMENT | GPUTextureUsage.TEXTURE_BINDING,
    });
    const encoder = device.createCommandEncoder();
    encoder
      .beginRenderPass({
        colorAttachments: [
          { view: color.createView(), loadOp: 'clear', storeOp: 'store', clearValue: [0, 0, 0, 1] },
        ],
      })
      .end();
    const pass = { color, depth: null, xPx: 0, yPx: 0 };
    const made = view.makeImage(pass);
    const image = view.draw(encoder, pass);
    expect(image, 'the image that was made before').toBe(made);
    device.queue.submit([encoder.finish()]);
    const { data } = await readTexture(device, image.color);
    const [red, , , alpha] = data.subarray(4 * (20 * SIZE.widthPx + 24));
    expect(alpha).toBeCloseTo(1, 3);
    // The linear value that encodes to half of white.
    expect(red).toBeCloseTo(0.214, 3);
    expect(image.depth).toBeNull();
    view.destroy();
    one.destroy();
    color.destroy();
  });

  gpuTest('keeps the edges of multisampled meshes smooth, before splats and amid them', async () => {
    const { camera, near, far } = edgeScene();
    for (const [, depth, isReversed] of CONVENTIONS) {
      const seenBy = withClipDepth(camera, isReversed);
      // The splats in front of the wall are a veil, those behind it nearly opaque.
      for (const sets of [[far], [near], [near, far]]) {
        const edge = await drawEdge(seenBy, depth, sets);
        expect(edge.pixels).toBeGreaterThan(30);
        expect(edge.maxError, `${sets.length} clouds, ${depth.mapping}`).toBeLessThan(0.012);
      }
    }
  });

  gpuTest(
    'calls onReady for clouds that join, though the host goes on with the others meanwhile',
    async () => {
      const view = engine.createEmbeddedView();
      const { perspective } = testCameras(1);
      const alone = { camera: perspective, clouds: [{ cloud }], ...SIZE };
      await prepared(view, alone);
      // Of a degree that no shader has been compiled for yet.
      const joining = engine.add(randomSplats({ count: 50, seed: 6, shDegree: 2 }));
      const both = { ...alone, clouds: [{ cloud }, { cloud: joining, shDegree: 1 as const }] };
      const ready = new Promise<void>((resolve) => {
        view.onReady = resolve;
      });
      expect(view.prepare(both)).toBe(false);
      expect(view.prepare(alone)).toBe(true);
      await ready;
      expect(view.prepare(both)).toBe(true);
      view.destroy();
      joining.destroy();
    },
  );

  gpuTest(
    'prepares again only if something has moved, draws every time, and frees all memory it held',
    async () => {
      const bytesBefore = engine.memory().totalBytes;
      const { perspective, orthographic } = testCameras(1);
      const view = engine.createEmbeddedView();
      const clouds = [{ cloud }];
      await prepared(view, { camera: perspective, clouds, ...SIZE });
      const color = device.createTexture({
        size: [64, 64],
        format: 'rgba16float',
        usage: GPUTextureUsage.TEXTURE_BINDING | GPUTextureUsage.COPY_DST,
      });
      const pass = { color, depth: null, xPx: 0, yPx: 0 };
      const first = await readTexture(device, record(view, pass).color);
      const before = engine.counters().framesPrepared;
      expect(view.prepare({ camera: perspective, clouds, ...SIZE })).toBe(true);
      expect(engine.counters().framesPrepared).toBe(before);
      expect((await readTexture(device, record(view, pass).color)).data).toEqual(first.data);
      const moved = { camera: perspective, clouds: [{ cloud, opacity: 0.5 }], ...SIZE };
      // Until the shaders that make it fainter are compiled, it is drawn as before.
      expect(view.prepare(moved)).toBe(true);
      expect(engine.counters().framesPrepared).toBe(before);
      await new Promise<void>((resolve) => {
        view.onReady = resolve;
      });
      expect(view.prepare(moved)).toBe(true);
      expect(engine.counters().framesPrepared).toBe(before + 1);
      expect((await readTexture(device, record(view, pass).color)).data).not.toEqual(first.data);

      // With another size and camera, the image equals that of a new view.
      const other = { camera: orthographic, clouds, widthPx: 20, heightPx: 30 };
      await prepared(view, other);
      const again = await readTexture(device, record(view, pass).color);
      const fresh = engine.createEmbeddedView();
      await prepared(fresh, other);
      expect((await readTexture(device, record(fresh, pass).color)).data).toEqual(again.data);

      // The view is destroyed while the host is still recording.
      const encoder = device.createCommandEncoder();
      fresh.draw(encoder, pass);
      fresh.destroy();
      device.queue.submit([encoder.finish()]);
      view.destroy();
      view.destroy();
      expect(() => view.prepare(other)).toThrow(DestroyedError);
      // Commands that the host has recorded so far stay valid.
      const last = device.createCommandEncoder();
      expect(() => view.draw(last, pass)).toThrow(DestroyedError);
      device.queue.submit([last.finish()]);
      await device.queue.onSubmittedWorkDone();
      expect(engine.memory().totalBytes).toBe(bytesBefore);
      color.destroy();
    },
  );

  gpuTest('always has a frame to draw while its clouds change their precision', async ({ skip }) => {
    // Precisions are those of stages before any rasteriser.
    if (!isFull && rasterizer === 'tiles') skip('quads suffice in the short run');
    const set = randomSplats({ count: 300, seed: 77, shDegree: 2 });
    const one = engine.add(set);
    const view = engine.createEmbeddedView();
    const frame = { camera: testCameras(1).perspective, clouds: [{ cloud: one }], ...SIZE };
    await prepared(view, frame);
    for (const geometryPrecision of ['packed', 'f32'] as const)
      for (const shPrecision of ['u8', 'f16', 'f32'] as const) {
        await engine.requestPrecision(one, { geometryPrecision, shPrecision });
        expect(one.precisions).toEqual({ geometry: [geometryPrecision], sh: [shPrecision] });
        expect(view.prepare(frame)).toBe(true);
      }
    view.destroy();
    one.destroy();
  });

  gpuTest('has nothing to draw without clouds or pixels, and names missing depth', async () => {
    const { perspective: camera } = testCameras(1);
    const view = engine.createEmbeddedView();
    expect(view.prepare({ camera, clouds: [], ...SIZE })).toBe(false);
    expect(view.prepare({ camera, clouds: [{ cloud }], widthPx: 0, heightPx: 4 })).toBe(false);
    const encoder = device.createCommandEncoder();
    const color = device.createTexture({
      size: [64, 64],
      format: 'rgba16float',
      usage: GPUTextureUsage.TEXTURE_BINDING,
    });
    const pass = { color, depth: null, xPx: 0, yPx: 0 };
    expect(() => view.draw(encoder, pass)).toThrow(InvalidArgumentError);
    expect(() => view.makeImage(pass)).toThrow(InvalidArgumentError);
    const depth = { compare: 'less-equal', mapping: 'projection' } as const;
    await prepared(view, { camera, clouds: [{ cloud }], ...SIZE, depth });
    expect(() => view.draw(encoder, pass)).toThrow(/host gave none/);
    expect(() => view.makeImage(pass)).toThrow(/host gave none/);
    view.destroy();
    color.destroy();
  });
});

/** `camera` with a slanting near plane, as a mirror's: stored depths depend on the pixel. */
function oblique(camera: Camera): Camera {
  const projectionMatrix = Float64Array.from(camera.projectionMatrix);
  projectionMatrix[2] += 0.06;
  projectionMatrix[6] -= 0.04;
  return { ...camera, projectionMatrix };
}

describe('both rasterisers', () => {
  let canWriteDepth = true;
  beforeAll(async () => {
    const { adapter } = await createNodeGpu();
    canWriteDepth = adapter.features.has(BLENDABLE);
    await start('tiles', canWriteDepth ? [BLENDABLE] : []);
  });

  /** Draws twice from one preparation, as a host with two passes, and returns image and depth. */
  async function drawnBy(
    by: SplatEngine,
    rasterizer: FrameRasterizer,
    frame: EmbeddedFrameRequest,
    pass: ReturnType<typeof hostPass>['pass'],
  ) {
    const own = by.add(SET);
    const view = by.createEmbeddedView();
    // A coverage rounded to float16 would move depths.
    const colorTarget = canWriteDepth ? 'rgba32float' : 'rgba16float';
    const accuracy = { ...high, rasterizer, colorTarget } as const;
    await prepared(view, { ...frame, clouds: [{ cloud: own }], accuracy });
    const first = (await readTexture(device, record(view, pass).color)).data;
    const image = record(view, pass);
    const { data } = await readTexture(device, image.color);
    expect(data).toEqual(first);
    const depths = image.depth && (await readDepths(image.depth));
    view.destroy();
    own.destroy();
    return { data, depths };
  }

  // In the short run, each rasteriser's own tests show the others.
  const compared = isFull ? CONVENTIONS : CONVENTIONS.slice(0, 1);
  for (const [name, depth, isReversed] of compared) {
    gpuTest(`hide the same splats behind the host's ${name}, with an oblique near plane too`, async () => {
      const { perspective, orthographic, mirrored } = testCameras(SIZE.widthPx / SIZE.heightPx);
      const straight = withClipDepth(perspective, isReversed);
      // A logarithm of depth has no oblique plane.
      const bent = depth.mapping === 'logarithmic' ? [] : [oblique(straight)];
      const cameras = [orthographic, mirrored].map((each) => withClipDepth(each, isReversed));
      for (const camera of isFull ? [straight, ...bent, ...cameras] : bent) {
        const { pass, color } = hostPass(camera, depth, {});
        const frame = { camera, clouds: [], ...SIZE, depth, writesDepth: canWriteDepth };
        const quads = await drawnBy(engine, 'quads', frame, pass);
        const tiles = await drawnBy(engine, 'tiles', frame, pass);
        expect(compareImages(tiles.data, quads.data, SIZE).psnrDb).toBeGreaterThan(60);
        let differing = 0;
        tiles.depths?.forEach((stored, i) => {
          // Tiles write the median and quads the mean, both of the same pixels.
          if (stored < 0 !== quads.depths![i] < 0) differing++;
        });
        // Pixels about half covered have a depth or have none, by rounding.
        expect(differing).toBeLessThan(3);
        const unhidden = await drawnBy(
          engine,
          'tiles',
          { ...frame, depth: undefined, writesDepth: false },
          pass,
        );
        expect(compareImages(tiles.data, unhidden.data, SIZE).psnrDb).toBeLessThan(40);
        color.destroy();
      }
    });
  }

  gpuTest('draw the same bits where tiles have no room', async () => {
    const depth = CONVENTIONS[0][1];
    const camera = withClipDepth(testCameras(SIZE.widthPx / SIZE.heightPx).perspective, false);
    const { pass, color } = hostPass(camera, depth, {});
    const frame = { camera, clouds: [], ...SIZE, depth, writesDepth: canWriteDepth };
    const crowded = await SplatEngine.create({ device, accuracy: high, tileBudgetBytes: 0 });
    const quads = await drawnBy(crowded, 'quads', frame, pass);
    const tiles = await drawnBy(crowded, 'tiles', frame, pass);
    expect(tiles).toEqual(quads);
    crowded.destroy();
    color.destroy();
  });
});
