import { gpuTest, shareTestDevice } from '@websplatter/node/gpu-test';
import { afterAll, beforeAll, describe, expect } from 'vitest';
import { type Camera, cameraFromMatrices } from '../camera/camera.ts';
import type { SplatCloud } from '../clouds/splat-cloud.ts';
import { SplatEngine } from '../create-engine.ts';
import { tint } from '../effects/tint.ts';
import { InvalidArgumentError } from '../errors.ts';
import { readTexture } from '../gpu/read-texture.ts';
import { compose } from '../reference/compose.ts';
import { compareImages, renderReference } from '../reference/index.ts';
import { prepared } from '../testing/prepared.ts';
import { randomSplats } from '../testing/random-splats.ts';
import { testCameras } from '../testing/test-cameras.ts';
import type { EmbeddedFrameRequest, EmbeddedView } from './embedded-view.ts';

const SIZE = { widthPx: 48, heightPx: 40 };
const PIXELS = SIZE.widthPx * SIZE.heightPx;
const SET = randomSplats({ count: 3000, seed: 8, logScales: [-5, -2] });
/** Half the distance of the eyes: each sees splats that the other does not. */
const HALF_DISTANCE = 0.06;

let device: GPUDevice;
let engine: SplatEngine;
let cloud: SplatCloud;
/** The host's image, transparent black. */
let color: GPUTexture;

/** The camera in the midst of the splats, moved to the right in its own space, with its image's middle moved against that. */
function eye(rightBy: number, turnedBy = 0): Camera {
  const { viewMatrix, projectionMatrix, near, far } = testCameras(SIZE.widthPx / SIZE.heightPx).inside;
  const [view, projection] = [Float64Array.from(viewMatrix), Float64Array.from(projectionMatrix)];
  view[12] -= rightBy;
  projection[8] -= 3 * rightBy;
  const [cos, sin] = [Math.cos(turnedBy), Math.sin(turnedBy)];
  for (let column = 0; column < 16; column += 4) {
    const [x, z] = [view[column], view[column + 2]];
    view[column] = cos * x + sin * z;
    view[column + 2] = cos * z - sin * x;
  }
  return cameraFromMatrices(view, projection, { near, far });
}

const LEFT = eye(-HALF_DISTANCE);
const RIGHT = eye(HALF_DISTANCE);

/** Prepares until shaders of the frame that is asked for are there. */
async function prepareAs(
  order: 'own' | 'lent' | 'taken',
  view: EmbeddedView,
  frame: EmbeddedFrameRequest,
): Promise<void> {
  await prepared(view, frame);
  await expect.poll(() => view.prepare(frame) && view.shape?.order).toBe(order);
}

async function imageOf(view: EmbeddedView) {
  const encoder = device.createCommandEncoder();
  const image = view.draw(encoder, { color, depth: null, xPx: 0, yPx: 0 });
  device.queue.submit([encoder.finish()]);
  const { data } = await readTexture(device, image.color);
  return data;
}

describe.for(['quads', 'tiles'] as const)('views that share an order, by %s', (rasterizer) => {
  let views: EmbeddedView[] = [];
  const frame = (camera: Camera): EmbeddedFrameRequest => ({ camera, clouds: [{ cloud }], ...SIZE });
  const newView = () => {
    const view = engine.createEmbeddedView();
    views.push(view);
    return view;
  };
  const lending = (): EmbeddedFrameRequest => ({ ...frame(LEFT), beside: [RIGHT] });
  const taking = (orderOf: EmbeddedView): EmbeddedFrameRequest => ({ ...frame(RIGHT), orderOf });
  /** A view of the left eye that lends its order, and one of the right eye that takes it. */
  const bothEyes = async (): Promise<[EmbeddedView, EmbeddedView]> => {
    const [left, right] = [newView(), newView()];
    await prepareAs('lent', left, lending());
    await prepareAs('taken', right, taking(left));
    return [left, right];
  };
  const ownImage = async (request: EmbeddedFrameRequest) => {
    const view = newView();
    await prepareAs('own', view, request);
    return imageOf(view);
  };

  beforeAll(async () => {
    device = await shareTestDevice();
    engine = await SplatEngine.create({ device, accuracy: { preset: 'high', rasterizer } });
    cloud = engine.add(SET);
    color = device.createTexture({
      size: [SIZE.widthPx, SIZE.heightPx],
      format: 'rgba16float',
      usage: GPUTextureUsage.TEXTURE_BINDING,
    });
  });

  afterAll(() => {
    for (const view of views) view.destroy();
    views = [];
    engine?.destroy();
    device?.destroy();
  });

  gpuTest('both images are those that each view draws by itself, and right', async () => {
    const eyes = await bothEyes();
    for (const [i, camera] of [LEFT, RIGHT].entries()) {
      const image = await imageOf(eyes[i]);
      expect(image).toEqual(await ownImage(frame(camera)));
      const layer = renderReference({ clouds: [{ set: SET }], camera, ...SIZE });
      expect(layer.visibleSplats).toBeGreaterThan(300);
      const expected = compose(layer.data, new Float64Array(4 * PIXELS));
      expect(compareImages(image, expected, SIZE).psnrDb).toBeGreaterThanOrEqual(50);
    }
  });

  gpuTest('an order by depth suits cameras that look the same way from the same depth alone', async () => {
    const [left, right] = [newView(), newView()];
    const turned = eye(HALF_DISTANCE, 0.02);
    await prepareAs('own', left, { ...frame(LEFT), beside: [turned] });
    await prepareAs('own', right, { ...frame(turned), orderOf: left });
    await prepareAs('lent', left, { ...frame(LEFT), beside: [turned, RIGHT] });
    await prepareAs('own', right, { ...frame(turned), orderOf: left });
    await prepareAs('taken', right, taking(left));
    // Rounded to float32, as poses are.
    const rounded = { ...RIGHT, viewMatrix: Float32Array.from(RIGHT.viewMatrix) };
    await prepareAs('lent', left, { ...frame(LEFT), beside: [rounded] });
    await prepareAs('taken', right, { ...frame(rounded), orderOf: left });
  });

  gpuTest('a view finds its own order where the other has other splats, or none', async () => {
    const [left, right] = await bothEyes();
    const other = taking(left);
    await prepareAs('own', right, { ...other, widthPx: SIZE.widthPx - 1 });
    await prepareAs('own', right, { ...other, clouds: [{ cloud, modelMatrix: MOVED }] });
    await prepareAs('own', right, { ...other, clouds: [{ cloud }, { cloud }] });
    await prepareAs('own', right, { ...other, accuracy: { preset: 'balanced', rasterizer } });
    await prepareAs('taken', right, other);
    await prepareAs('own', left, frame(LEFT));
    await prepareAs('own', right, other);
    await prepareAs('own', left, { ...lending(), sortBy: 'distance' });
    await prepareAs('own', right, { ...other, sortBy: 'distance' });
    await prepareAs('lent', left, lending());
    await prepareAs('taken', right, other);
    left.destroy();
    await prepareAs('own', right, other);
    expect(await imageOf(right)).toEqual(await ownImage(frame(RIGHT)));
  });

  gpuTest('a view follows the order that it takes, and stands while that stands', async () => {
    const [left, right] = await bothEyes();
    const framesOf = () => engine.counters().framesPrepared;
    const before = framesOf();
    left.prepare(lending());
    right.prepare(taking(left));
    expect(framesOf()).toBe(before);

    // Colours alone change: nothing is sorted, and the other view need not draw again.
    const tinted = { ...lending(), clouds: [{ cloud, effects: [tint([1, 0.5, 0.2])] }] };
    await prepareAs('lent', left, tinted);
    const afterTint = framesOf();
    right.prepare(taking(left));
    expect(framesOf()).toBe(afterTint);

    const nearer = [LEFT, RIGHT].map((camera) => {
      const viewMatrix = Float64Array.from(camera.viewMatrix);
      viewMatrix[14] += 0.1;
      return { ...camera, viewMatrix };
    });
    await prepareAs('lent', left, { ...frame(nearer[0]), beside: [nearer[1]] });
    await prepareAs('taken', right, { ...frame(nearer[1]), orderOf: left });
    expect(await imageOf(right)).toEqual(await ownImage(frame(nearer[1])));
  });

  gpuTest(
    'picking in a view whose order is taken finds the same splat, and nothing once the order is another',
    async () => {
      const [left, right] = await bothEyes();
      const own = newView();
      await prepareAs('own', own, frame(RIGHT));
      const expected = await own.pick(20, 20);
      expect(expected?.splatIndex).toBeGreaterThanOrEqual(0);
      const { splatIndex, point, depthView, alpha } = expected!;
      expect(await right.pick(20, 20)).toMatchObject({ splatIndex, point, depthView, alpha });
      left.prepare({ ...frame(LEFT), beside: [eye(2 * HALF_DISTANCE)] });
      expect(await right.pick(20, 20)).toBeNull();
    },
  );

  gpuTest('cameras beside are checked as the camera itself', () => {
    const view = newView();
    for (const wrong of [
      { ...RIGHT, near: Number.NaN },
      { ...RIGHT, viewMatrix: [1, 2] },
    ])
      expect(() => view.prepare({ ...frame(LEFT), beside: [wrong] })).toThrow(InvalidArgumentError);
  });

  gpuTest('a view that takes its order holds less', async () => {
    const [left, right] = await bothEyes();
    expect(right.memory.totalBytes).toBeLessThan(left.memory.totalBytes);
  });
});

const MOVED = Float64Array.of(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0.1, 0, 1);
