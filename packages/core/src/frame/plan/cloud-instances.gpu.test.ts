import { gpuTest, shareTestDevice } from '@websplatter/node/gpu-test';
import { beforeAll, describe, expect, test } from 'vitest';
import type { SplatCloud } from '../../clouds/splat-cloud.ts';
import { SplatEngine } from '../../create-engine.ts';
import { multiply4 } from '../../data/math/mat4.ts';
import { SplatSelection } from '../../data/splats/splat-selection.ts';
import { followEdits } from '../../features/edits/edits.clouds.ts';
import { SplatEdits } from '../../features/edits/splat-edits.data.ts';
import { fog, highlight, opacity, tint, volumes } from '../../gpu/effects/effects.ts';
import { Pipelines } from '../../gpu/pipelines.ts';
import { InspectedFrame, type InspectOptions } from '../../inspect/inspected-frame.ts';
import { drawMeasured } from '../../measure/measured-frames.ts';
import { renderReference } from '../../reference/render.ts';
import { compareImages } from '../../stages/measure/measure.reference.ts';
import { NARROW_REFERENCE } from '../../testing/narrow-reference.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { TEST_MODELS, testCameras } from '../../testing/test-cameras.ts';
import { type CloudInstances, checkInstances } from './cloud-instances.ts';
import type { Detail } from './detail.ts';
import type { CloudInstance } from './frame-request.ts';

const SIZE = { widthPx: 96, heightPx: 64 };
const isFull = process.env.WEBSPLATTER_FULL === '1';
const { perspective, orthographic } = testCameras(SIZE.widthPx / SIZE.heightPx);
const SET = randomSplats({ count: 700, shDegree: 3 });
const OTHER = randomSplats({ count: 300, shDegree: 1, seed: 2 });
const MODELS = Object.values(TEST_MODELS);

let device: GPUDevice;
beforeAll(async () => {
  device = await shareTestDevice();
});

type Cloud = InspectOptions['clouds'][number];

/** So many instances in a grid, by turns as in TEST_MODELS. */
function grid(count: number): number[][] {
  const columns = Math.ceil(Math.sqrt(count));
  return Array.from({ length: count }, (_, i) => {
    const matrix = Array.from(MODELS[i % MODELS.length], (value, at) => (at === 15 ? value : 0.4 * value));
    matrix[12] += (3 * (i % columns)) / columns - 1.5;
    matrix[14] -= (3 * Math.floor(i / columns)) / columns;
    return matrix;
  });
}

const tintsOf = (count: number) => Array.from({ length: 3 * count }, (_, i) => 0.25 + (i % 7) / 4);
const opacitiesOf = (count: number) => Array.from({ length: count }, (_, i) => (i % 5) / 4);

/** The same as clouds of their own, whose effects are products of the cloud's and the instance's. */
function separately({ instances, modelMatrix, opacity: faded = 1, effects = [], ...cloud }: Cloud): Cloud[] {
  const { modelMatrices, tints, opacities } = instances!;
  return Array.from({ length: modelMatrices.length / 16 }, (_, i) => {
    const own = Array.from(modelMatrices).slice(16 * i, 16 * i + 16);
    const colored = effects.find(({ effect }) => effect === tint.effect);
    const [r, g, b] = [0, 1, 2].map(
      (at) => (tints?.[3 * i + at] ?? 1) * ((colored?.options as number[] | undefined)?.[at] ?? 1),
    );
    return {
      ...cloud,
      modelMatrix: modelMatrix ? multiply4(modelMatrix, own) : own,
      effects: [
        ...effects.filter((use) => use !== colored),
        tint([r, g, b]),
        opacity(faded * (opacities?.[i] ?? 1)),
      ],
    };
  });
}

const instanced = (cloud: Cloud, lists: Partial<CloudInstances>, count: number): Cloud => ({
  ...cloud,
  instances: { modelMatrices: grid(count).flat(), ...lists },
});

function selected(...rows: number[]): SplatSelection {
  const selection = new SplatSelection();
  selection.add(rows);
  return selection;
}

interface Case {
  readonly cloud: Cloud;
  readonly options?: Partial<InspectOptions>;
}

const IN_LOCKSTEP = 'where many threads run in lockstep';
const PACKED: Case = {
  cloud: instanced(
    { set: SET, modelMatrix: TEST_MODELS.sheared, shDegree: 2 },
    { tints: tintsOf(9), opacities: opacitiesOf(9) },
    9,
  ),
  options: {
    accuracy: {
      geometryPrecision: 'packed',
      shPrecision: 'u8',
      recordPrecision: 'f16',
      rasterizer: 'tiles',
    },
  },
};
const WITH_EFFECTS: Cloud = instanced(
  {
    set: SET,
    opacity: 0.7,
    effects: [
      volumes([{ shape: 'sphere', mode: 'keep', radius: 1.2, softEdge: 0.2 }]),
      tint([0.5, 0.9, 1.5]),
      fog({ color: [0.2, 0.3, 0.4], density: 0.3 }),
    ],
  },
  { tints: tintsOf(5), opacities: opacitiesOf(5) },
  5,
);
/** Two batches, or three. */
const MANY_INSTANCES = isFull ? 500 : 200;

const CASES: Readonly<Record<string, Case>> = {
  // By keys of the preset, whose stages read places of instances too.
  'in their places': { cloud: instanced({ set: SET }, {}, 6), options: { keyBits: 64 } },
  'one of them': { cloud: instanced({ set: SET }, {}, 1) },
  'none of them': { cloud: instanced({ set: SET }, {}, 0) },
  [`packed, by tiles, with a matrix of the whole and colours and opacities of their own, ${IN_LOCKSTEP}`]: {
    ...PACKED,
    options: { ...PACKED.options, isNarrow: false },
  },
  'with effects in the world, besides opacity and tint of all, of several pages': {
    cloud: { ...WITH_EFFECTS, splatsPerPage: 256 },
  },
  ...(isFull && {
    [IN_LOCKSTEP]: {
      cloud: instanced({ set: SET }, { opacities: opacitiesOf(6) }, 6),
      options: { isNarrow: false },
    },
    'packed, by tiles, with a matrix of the whole and colours and opacities of their own': PACKED,
    'with effects in the world, besides opacity and tint of all': { cloud: WITH_EFFECTS },
    'of several pages': {
      cloud: { ...instanced({ set: SET }, { tints: tintsOf(4) }, 4), splatsPerPage: 256 },
    },
  }),
  'in several batches, without perspective, with a selection': {
    cloud: instanced(
      {
        set: randomSplats({ count: 20, shDegree: 0 }),
        effects: [highlight({ selection: selected(3, 7, 12), color: [1, 0, 0], strength: 0.8 })],
      },
      { opacities: opacitiesOf(MANY_INSTANCES) },
      MANY_INSTANCES,
    ),
    options: { camera: orthographic, dispatchRow: 7 },
  },
};

describe('instances of a cloud', () => {
  for (const [name, { cloud, options }] of Object.entries(CASES)) {
    gpuTest(`${name}, are drawn bit for bit as clouds of their own`, { tags: 'deeper' }, async () => {
      const draw = (clouds: Cloud[]) =>
        InspectedFrame.draw(device, {
          camera: perspective,
          ...SIZE,
          keyBits: 32,
          ...options,
          clouds: [{ set: OTHER }, ...clouds, { set: OTHER, modelMatrix: TEST_MODELS.moved }],
        });
      const together = await draw([cloud]);
      const apart = await draw(separately(cloud));
      expect(together.image.data.some((value) => value > 0)).toBe(true);
      expect(together.image.data).toEqual(apart.image.data);
      const visibleSplats = async (frame: InspectedFrame) =>
        (await frame.words('visibleSplats')).subarray(0, await frame.visibleCount());
      // Indices are unique, and tell instances apart.
      expect(await visibleSplats(together)).toEqual(await visibleSplats(apart));
      together.destroy();
      apart.destroy();
    });
  }

  gpuTest('are told from a picture in which one has the place of another', async () => {
    const { cloud } = CASES['in their places'];
    const mutation = {
      file: 'lib/instances',
      find: 'pages[instanceIndex].translation',
      replace: 'pages[0].translation',
    };
    const images = await Promise.all(
      [undefined, mutation].map(async (changed) => {
        const pipelines = new Pipelines(device, changed);
        const frame = await InspectedFrame.draw(device, {
          camera: perspective,
          ...SIZE,
          clouds: [cloud],
          keyBits: 8,
          pipelines,
        });
        frame.destroy();
        return frame.image.data;
      }),
    );
    expect(images[1]).not.toEqual(images[0]);
  });

  gpuTest('take as many dispatches as one, or as one batch for each few hundred of them', async () => {
    const options = { camera: perspective, ...SIZE, keyBits: 8 };
    // How many instances a batch has does not depend on their splats.
    const small = randomSplats({ count: 20, shDegree: 0 });
    const { pages } = await InspectedFrame.draw(device, {
      ...options,
      clouds: [instanced({ set: small }, {}, 6), instanced({ set: small }, {}, 500)],
    }).then(({ parts }) => parts);
    expect(pages.map(({ instances }) => instances)).toEqual([
      { first: 0, count: 6 },
      { first: 0, count: 186 },
      { first: 186, count: 186 },
      { first: 372, count: 128 },
    ]);
    // Of several pages, batches have one instance, and bindings no room for more.
    const paged = { ...instanced({ set: SET }, {}, 2), splatsPerPage: 256 };
    const { parts } = await InspectedFrame.draw(device, { ...options, clouds: [paged] });
    expect(parts.pages.map(({ instances, uniform }) => [instances?.first, uniform.size])).toEqual(
      [0, 0, 0, 1, 1, 1].map((first) => [first, 352]),
    );
  });
});

describe('instances in a view', () => {
  let engine: SplatEngine;
  beforeAll(async () => {
    const accuracy = { ...NARROW_REFERENCE, rasterizer: 'quads' } as const;
    engine = await SplatEngine.create({ device, accuracy });
  });

  const MOVED = TEST_MODELS.moved;
  const LISTS = { modelMatrices: grid(12).flat(), tints: tintsOf(12), opacities: opacitiesOf(12) };

  gpuTest('are what the reference draws in float64, and picks tell which was hit', async () => {
    const view = engine.createView();
    const cloud = engine.add(SET);
    const frame = { camera: perspective, ...SIZE };
    view.render({ ...frame, clouds: [{ cloud, modelMatrix: MOVED, instances: LISTS }] });
    const { data } = await view.readPixels();
    const apart = separately({ set: SET, modelMatrix: MOVED, instances: LISTS });
    const reference = renderReference({ ...frame, clouds: apart });
    expect(compareImages(data, reference.data, SIZE).psnrDb).toBeGreaterThan(60);

    const others = engine.createView();
    others.render({ ...frame, clouds: apart.map(({ set: _, ...placed }) => ({ ...placed, cloud })) });
    await others.whenDrawn();
    const hit = new Set<number | null>();
    for (let pixel = 0; pixel < SIZE.widthPx * SIZE.heightPx; pixel += 61) {
      const [xPx, yPx] = [pixel % SIZE.widthPx, Math.floor(pixel / SIZE.widthPx)];
      const [picked, expected] = [await view.pick(xPx, yPx), await others.pick(xPx, yPx)];
      if (!picked || !expected) {
        expect(picked).toBe(expected);
        continue;
      }
      const { cloudIndex, instanceIndex, ...shares } = picked;
      expect({ ...shares, cloudIndex: instanceIndex, instanceIndex: null }).toEqual(expected);
      expect(cloudIndex).toBe(0);
      hit.add(instanceIndex);
    }
    expect(hit.size).toBeGreaterThan(4);
    for (const each of [view, others]) each.destroy();
    cloud.destroy();
  });

  /** Faint and small, so that blobs stand for many. */
  const MANY = randomSplats({
    count: 3000,
    seed: 5,
    shDegree: 1,
    logScales: [-6, -4],
    opacityLogits: [-3, -1],
  });

  interface CutCase {
    readonly detail: Detail;
    readonly count?: number;
    /** Whether some splats are edited, and others selected. */
    readonly isTouched?: boolean;
  }
  const CUTS: Readonly<Record<string, CutCase>> = {
    // Errors, a share and touched splats at once; below, a budget alone.
    'a share, and errors at most, around what is edited and selected': {
      detail: { maxShare: 0.3, maxErrorPx: 4 },
      isTouched: true,
    },
    ...(isFull && {
      errors: { detail: { maxErrorPx: 1 } },
      'a budget': { detail: { maxSplats: 6000 } },
      'errors, in several batches': { detail: { maxErrorPx: 2 }, count: 250 },
    }),
  };
  for (const [name, { detail, count = 9, isTouched }] of Object.entries(CUTS)) {
    gpuTest(`are cut by ${name}, each as a cloud of its own`, { tags: 'deeper' }, async () => {
      const cloud = engine.add(MANY);
      await cloud.makeLevels();
      const edits = new SplatEdits();
      if (isTouched) await followEdits(cloud, edits);
      edits.set([7, 500, 1200], { colors: [1, 0, 0] });
      const effects = isTouched
        ? [highlight({ selection: selected(3, 900), color: [0, 1, 0], strength: 1 })]
        : [];
      const instances = { modelMatrices: grid(count).flat(), opacities: opacitiesOf(count) };
      const draw = async (clouds: CloudInstance[]) => {
        const view = engine.createView();
        const frame = { camera: perspective, ...SIZE, clouds, detail };
        const statistics = await drawMeasured(engine, view, frame);
        const { data } = await view.readPixels();
        const levels = view.effects().filter((feature) => feature.name === 'levels');
        const picks = [];
        for (let xPx = 4; xPx < SIZE.widthPx; xPx += 8) picks.push(await view.pick(xPx, 34));
        view.destroy();
        const places = picks.map((pick) => pick && (pick.instanceIndex ?? pick.cloudIndex));
        const found = picks.map((pick) => pick && { ...pick, cloudIndex: 0, instanceIndex: 0 });
        const isCut = levels.length > 0 && levels.every(({ isOn }) => isOn);
        return { data, drawn: statistics.visibleSplats, places, found, isCut };
      };
      const together = await draw([{ cloud, effects, instances }]);
      const apart = await draw(
        separately({ set: MANY, effects, instances }).map(({ set: _, ...placed }) => ({ ...placed, cloud })),
      );
      expect(together).toEqual(apart);
      expect(together.isCut).toBe(true);
      expect(together.drawn).toBeLessThan((MANY.count * count) / 2);
      expect(new Set(together.places).size).toBeGreaterThan(2);
      cloud.destroy();
    });
  }

  gpuTest('without an extent take no budget from others, and their blobs are finite', async () => {
    const cloud = engine.add(MANY);
    const shown = grid(9).flat();
    const point = (x: number) => [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, x, 0.4, -1, 1];
    const pane = (x: number) => [0.3, 0, 0, 0, 0, 0.3, 0, 0, 0, 0, 0, 0, x, -0.4, -1, 1];
    const hidden = [-0.6, -0.3, 0, 0.3, 0.6].flatMap((x) => [...point(x), ...pane(x)]);
    const draw = async (modelMatrices: number[]) => {
      const view = engine.createView();
      const clouds = [{ cloud, instances: { modelMatrices } }];
      const frame = { camera: perspective, ...SIZE, clouds, detail: { maxSplats: 9000 } };
      const { cutErrorPx, visibleSplats } = await drawMeasured(engine, view, frame);
      const { data } = await view.readPixels();
      view.destroy();
      expect(data.every(Number.isFinite)).toBe(true);
      return { cutErrorPx: cutErrorPx!, visibleSplats };
    };
    const alone = await draw(shown);
    const beside = await draw([...shown, ...hidden]);
    expect(alone.visibleSplats).toBeGreaterThan(6000);
    expect(beside.visibleSplats).toBeGreaterThan(6000);
    expect(beside.cutErrorPx).toBeLessThan(1.5 * alone.cutErrorPx);
    cloud.destroy();
  });

  gpuTest('are drawn again when a list changes, and only then', async () => {
    const view = engine.createView();
    const cloud = engine.add(OTHER);
    const lists = {
      modelMatrices: Float64Array.from(grid(3).flat()),
      tints: Float32Array.from(tintsOf(3)),
      opacities: Float32Array.from(opacitiesOf(3)),
    };
    const draw = async (instances?: CloudInstances) => {
      const isDrawn = view.render({ camera: perspective, ...SIZE, clouds: [{ cloud, instances }] });
      const { data } = await view.readPixels();
      return { isDrawn, data };
    };
    let { data: last } = await draw(lists);
    expect((await draw(lists)).isDrawn).toBe(false);
    const { modelMatrices, tints, opacities } = lists;
    const changes = [
      { list: modelMatrices, at: 28, drawn: lists },
      { list: tints, at: 4, drawn: lists },
      { list: opacities, at: 1, drawn: lists },
      { drawn: { modelMatrices, opacities } },
      { drawn: { modelMatrices: modelMatrices.subarray(16) } },
      { drawn: { modelMatrices } },
      { drawn: undefined },
      { drawn: { modelMatrices, tints } },
    ];
    for (const { list, at, drawn: instances } of changes) {
      list?.set([0.9], at);
      const { isDrawn, data } = await draw(instances);
      expect(isDrawn).toBe(true);
      expect(data).not.toEqual(last);
      expect((await draw(instances)).isDrawn).toBe(false);
      const fresh = engine.createView();
      fresh.render({ camera: perspective, ...SIZE, clouds: [{ cloud, instances }] });
      expect((await fresh.readPixels()).data).toEqual(data);
      fresh.destroy();
      last = data;
    }
    view.destroy();
    cloud.destroy();
  });

  test('of a cloud that streams are refused', () => {
    const city = { name: 'city', pool: {} } as SplatCloud;
    const error = /^city streams, and a cloud that streams has no instances/;
    expect(() => checkInstances({ modelMatrices: grid(1)[0] }, city)).toThrow(error);
  });

  test('of more splats than a frame numbers are refused', () => {
    const city = { name: 'city', count: 1e6, pool: null } as SplatCloud;
    const error = /^2001 instances of city have 2001384192 splats, .* a frame numbers 2000000000/;
    expect(() => checkInstances({ modelMatrices: new Float32Array(16 * 2001) }, city)).toThrow(error);
    expect(() => checkInstances({ modelMatrices: new Float32Array(16 * 1999) }, city)).not.toThrow();
  });

  gpuTest('are refused where lists do not fit together', async () => {
    const view = engine.createView();
    const cloud = engine.add(OTHER, { name: 'robot' });
    const modelMatrices = grid(2).flat();
    for (const [instances, message] of [
      [{}, /robot: instances.modelMatrices is undefined; it must be a list of 16 finite numbers for each/],
      [{ modelMatrices: [1, 2] }, /instances.modelMatrices is \[1, 2\]/],
      [{ modelMatrices: modelMatrices.with(3, Number.NaN) }, /instances.modelMatrices/],
      [{ modelMatrices, tints: [1, 1, 1] }, /instances.tints is .* 3 finite numbers, 0 or more, for each/],
      [{ modelMatrices, tints: [1, 1, 1, 1, 1, -1] }, /instances.tints/],
      [{ modelMatrices: modelMatrices.with(30, -Infinity) }, /instances.modelMatrices/],
      [{ modelMatrices, opacities: [1, 1.5] }, /instances.opacities is .* 1 number, 0…1, for each/],
    ] as const) {
      const clouds = [{ cloud, instances: instances as CloudInstances }];
      expect(() => view.render({ camera: perspective, ...SIZE, clouds })).toThrow(message);
    }
    view.destroy();
    cloud.destroy();
  });
});
