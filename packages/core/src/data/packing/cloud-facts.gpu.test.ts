import { gpuTest, shareTestDevice } from '@websplatter/node/gpu-test';
import { beforeAll, describe, expect, onTestFinished } from 'vitest';
import type { SplatCloud } from '../../clouds/splat-cloud.ts';
import { SplatEngine } from '../../create-engine.ts';
import type { GpuMemoryReport } from '../../gpu/gpu-memory.ts';
import { compareRecords } from '../../inspect/compare-records.ts';
import { describeFieldError } from '../../inspect/field-error.ts';
import { InspectedFrame } from '../../inspect/inspected-frame.ts';
import { encodePly } from '../../io/formats/ply/write-ply.ts';
import { compareImages, renderReference } from '../../reference/index.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { splatsOfDegree } from '../../testing/splats-of-degree.ts';
import { testCameras } from '../../testing/test-cameras.ts';
import { coefficientsPerSplat, type ShDegree, type SplatSet } from '../splats/splat-set.ts';

const SIZE = { widthPx: 64, heightPx: 64 };
const CAMERA = testCameras(1).perspective;
const COUNT = 600;
const TIMED_ROUNDS = 4;

/** Texts of all shaders that were compiled on `device`. */
const shaderTexts = new Set<string>();
let device: GPUDevice;
beforeAll(async () => {
  device = await shareTestDevice();
  const createShaderModule = device.createShaderModule.bind(device);
  device.createShaderModule = (descriptor) => {
    shaderTexts.add(descriptor.code);
    return createShaderModule(descriptor);
  };
});

interface Drawn {
  readonly image: Float32Array;
  /** Its costs, and the shaders that no engine on the device had compiled before. */
  readonly costs: {
    readonly memory: GpuMemoryReport;
    readonly uploadedBytes: number;
    readonly shDegree: ShDegree;
    readonly newShaders: number;
  };
  /** Draws the image again; milliseconds until the GPU has done it. */
  readonly again: () => Promise<number>;
}

/** An image of the cloud that `addTo` adds, by an engine of its own. */
async function drawn(addTo: (engine: SplatEngine) => SplatCloud | Promise<SplatCloud>): Promise<Drawn> {
  const textsBefore = shaderTexts.size;
  // Images are compared bit for bit: their rasteriser must not follow from times.
  const engine = await SplatEngine.create({ device, accuracy: { rasterizer: 'tiles' } });
  onTestFinished(() => engine.destroy());
  const cloud = await addTo(engine);
  const view = engine.createView();
  const frame = { camera: CAMERA, clouds: [{ cloud }], force: true, ...SIZE };
  view.render(frame);
  const { data: image } = await view.readPixels();
  const costs = {
    memory: engine.memory(),
    uploadedBytes: engine.counters().uploadedBytes,
    shDegree: cloud.shDegree,
    newShaders: shaderTexts.size - textsBefore,
  };
  const again = async () => {
    const start = performance.now();
    view.render(frame);
    await device.queue.onSubmittedWorkDone();
    return performance.now() - start;
  };
  return { image, costs, again };
}

/** Least milliseconds of a frame of each, in turn, there and back: other load only adds to them. */
async function timesOf(all: readonly Drawn[]): Promise<string> {
  const times = new Map<Drawn, number[]>(all.map((each) => [each, []]));
  const order = [...all];
  for (let round = 0; round < TIMED_ROUNDS; round++, order.reverse())
    for (const each of order) times.get(each)!.push(await each.again());
  return [...times.values()].map((each) => `${Math.min(...each).toFixed(1)} ms`).join(', ');
}

const fileOf = (set: SplatSet) => new Blob([encodePly(set)]);
const bytesOf = ({ buffer }: Float32Array) => Buffer.from(buffer);

/** Splats of degree 3 that have nothing above `degree`, and the same ones of that degree. */
function declaredAndTrue(degree: ShDegree): [declared: SplatSet, lower: SplatSet] {
  const set = randomSplats({ count: COUNT });
  const values = set.harmonics.coefficients;
  for (let i = 0; i < COUNT; i++) values.fill(0, 45 * i + coefficientsPerSplat(degree), 45 * (i + 1));
  return [set, splatsOfDegree(set, degree)];
}

gpuTest('bands too faint to be seen are missing nowhere but in what is stored', async () => {
  const set = randomSplats({ count: COUNT });
  const values = set.harmonics.coefficients;
  for (let i = 0; i < values.length; i++) if (i % 45 >= coefficientsPerSplat(1)) values[i] *= 1e-4;
  const frame = await InspectedFrame.draw(device, {
    clouds: [{ set }],
    camera: CAMERA,
    keyBits: 32,
    ...SIZE,
  });
  expect(frame.clouds[0].packed.facts).toMatchObject({ declaredShDegree: 3, trueShDegree: 1 });
  const { firstBad } = await compareRecords(frame);
  if (firstBad) expect.fail(describeFieldError(firstBad));
  const reference = renderReference({ clouds: [{ set }], camera: CAMERA, ...SIZE });
  expect(compareImages(frame.image.data, reference.data, SIZE).psnrDb).toBeGreaterThan(60);
  frame.destroy();
});

describe('a file of degree 3 with nothing above degree', () => {
  for (const degree of [0, 1] as const) {
    gpuTest(`${degree}: is drawn as one of that degree, by the same shaders from as many bytes`, async () => {
      const [declared, lower] = declaredAndTrue(degree);
      const name = 'splats';
      const expected = await drawn((engine) => engine.load(fileOf(lower), { name }));
      expect(expected.costs.shDegree).toBe(degree);
      expect(expected.costs.newShaders).toBeGreaterThan(0);
      expect(new Set(expected.image).size).toBeGreaterThan(100);
      const loaded = await drawn((engine) => engine.load(fileOf(declared), { name }));
      const added = await drawn((engine) => engine.add(declared, { name }));
      for (const { image, costs } of [loaded, added]) {
        expect(bytesOf(image).equals(bytesOf(expected.image))).toBe(true);
        expect(costs).toEqual({ ...expected.costs, newShaders: 0 });
      }
      const times = await timesOf([expected, loaded, added]);
      console.info(`degree ${degree}, the same in a file of degree 3, the same added: ${times}`);
    });
  }

  gpuTest('0: holds every precision, of harmonics as well', async () => {
    const [declared] = declaredAndTrue(0);
    const engine = await SplatEngine.create({ device });
    const cloud = await engine.load(fileOf(declared));
    const before = cloud.bytes;
    await engine.requestPrecision(cloud, { geometryPrecision: 'packed', shPrecision: 'f32' });
    expect(cloud.bytes).toBe(before);
    engine.destroy();
  });

  gpuTest('1: is read again for a finer precision, and has that degree then too', async () => {
    const [declared] = declaredAndTrue(1);
    const engine = await SplatEngine.create({ device });
    const cloud = await engine.load(fileOf(declared));
    const { uploadedBytes } = engine.counters();
    await engine.requestPrecision(cloud, { geometryPrecision: 'packed', shPrecision: 'f32' });
    expect(cloud.precisions).toEqual({ geometry: ['packed'], sh: ['f32'] });
    expect(engine.counters().uploadedBytes - uploadedBytes).toBe(COUNT * 9 * 4);
    engine.destroy();
  });
});
