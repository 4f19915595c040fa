import { gpuTest, shareBlendingDevice } from '@websplatter/node/gpu-test';
import { beforeAll, describe, expect, vi } from 'vitest';
import { SplatEngine } from '../create-engine.ts';
import { orthographicCamera, perspectiveCamera } from '../data/camera/camera.ts';
import { InvalidArgumentError } from '../data/errors.ts';
import type { SortBy } from '../data/splats/sort-by.ts';
import type { SplatSet } from '../data/splats/splat-set.ts';
import { renderReference } from '../reference/render.ts';
import { compareImages } from '../stages/measure/measure.reference.ts';
import { type SplatValues, splatsOf } from '../testing/random-splats.ts';
import type { SplatView } from '../views/splat-view.ts';
import { frameStages } from './frame-passes.ts';
import type { FrameRequest } from './plan/frame-request.ts';

const SIZE = { widthPx: 64, heightPx: 64 };
const PLACE = { position: [0, 0, 0], target: [0, 0, -1], aspect: 1 } as const;
const PERSPECTIVE = perspectiveCamera({ ...PLACE, fovYDegrees: 90 });
const ORTHOGRAPHIC = orthographicCamera({ ...PLACE, height: 4 });
const LARGE = { logScales: [-0.5, -0.5, -0.5], opacityLogit: 1.5 } satisfies SplatValues;
/** Two splats: red is less deep, and farther. */
const RED = splatsOf([{ ...LARGE, position: [-1.2, 0.4, -2], colorDc: [1.7, -1.4, -1.4] }]);
const BLUE = splatsOf([{ ...LARGE, position: [0, 0, -2.2], colorDc: [-1.4, -1, 1.7] }]);

const FILE = { format: 'gltf' };
const asking = (set: SplatSet): SplatSet => ({ ...set, fileFacts: { ...FILE, isSortedByDistance: true } });

let device: GPUDevice;
let engine: SplatEngine;
let view: SplatView;
beforeAll(async () => {
  device = await shareBlendingDevice();
  engine = await SplatEngine.create({ device, accuracy: 'reference' });
  view = engine.createView();
});

type Request = Partial<Omit<FrameRequest, 'clouds'>>;

async function draw(red: SplatSet, blue: SplatSet, request: Request = {}) {
  const [first, second] = [engine.add(red, { name: 'red' }), engine.add(blue, { name: 'blue' })];
  view.render({ camera: PERSPECTIVE, clouds: [{ cloud: first }, { cloud: second }], ...SIZE, ...request });
  const { data } = await view.readPixels();
  const entry = view.effects().find(({ name }) => name === 'distance-order')!;
  first.destroy();
  second.destroy();
  return { data, entry };
}

function reference(sortBy: SortBy, camera = PERSPECTIVE, sets: readonly SplatSet[] = [RED, BLUE]) {
  return renderReference({ clouds: sets.map((set) => ({ set })), camera, sortBy, ...SIZE }).data;
}

const psnrDb = (data: Float32Array, expected: Float64Array) => compareImages(data, expected, SIZE).psnrDb;

describe('the order of a frame', () => {
  for (const rasterizer of ['quads', 'tiles'] as const) {
    for (const [sortBy, other] of [
      ['depth', 'distance'],
      ['distance', 'depth'],
    ] as const) {
      gpuTest(`${rasterizer}, by ${sortBy}: as in float64, and not that by ${other}`, async () => {
        const accuracy = { preset: 'reference', rasterizer } as const;
        const { data } = await draw(RED, BLUE, { sortBy, accuracy });
        expect(psnrDb(data, reference(sortBy))).toBeGreaterThan(90);
        expect(psnrDb(data, reference(other))).toBeLessThan(30);
      });
    }
  }

  gpuTest('without perspective, is that of depths', async () => {
    for (const sortBy of ['distance', 'auto'] as const) {
      const { data, entry } = await draw(asking(RED), BLUE, { camera: ORTHOGRAPHIC, sortBy });
      expect(psnrDb(data, reference('depth', ORTHOGRAPHIC))).toBeGreaterThan(90);
      expect(psnrDb(data, reference('distance', ORTHOGRAPHIC))).toBeGreaterThan(90);
      expect(entry).toMatchObject({ isOn: false, reason: 'the camera has no perspective', clouds: [] });
    }
  });

  gpuTest('follows from files unless it is asked for, and the ledger says from which', async () => {
    const byFile = { isOn: true, reason: 'its file asks for it' };
    const byNone = { isOn: false, reason: 'no file asks for it', clouds: [] };
    const byRequest = { isOn: true, reason: 'the request asks for it', clouds: ['red', 'blue'] };
    const byDepth = { isOn: false, reason: 'the request asks for depths', clouds: [] };
    for (const [red, blue, sortBy, expected] of [
      [RED, { ...BLUE, fileFacts: FILE }, undefined, byNone],
      [RED, asking(BLUE), undefined, { ...byFile, clouds: ['blue'] }],
      [asking(RED), asking(BLUE), 'auto', { ...byFile, clouds: ['red', 'blue'] }],
      [RED, asking(BLUE), 'depth', byDepth],
      [RED, asking(BLUE), 'distance', byRequest],
      [RED, BLUE, 'distance', byRequest],
    ] as const) {
      const { data, entry } = await draw(red, blue, { sortBy });
      expect(entry).toMatchObject(expected);
      const exact = reference(expected.isOn ? 'distance' : 'depth');
      expect(psnrDb(data, exact)).toBeGreaterThan(90);
      expect(Array.from(reference(sortBy ?? 'auto', PERSPECTIVE, [red, blue]))).toEqual(Array.from(exact));
    }
  });

  gpuTest(
    'is another frame’s: a request that changes nothing else is drawn, and one that changes nothing is not',
    async () => {
      const clouds = [RED, BLUE].map((set) => ({ cloud: engine.add(set) }));
      const frame = { camera: PERSPECTIVE, clouds, ...SIZE };
      for (const [sortBy, isDrawn] of [
        ['distance', true],
        ['depth', true],
        ['auto', false],
        ['distance', true],
      ] as const) {
        expect(view.render({ ...frame, sortBy })).toBe(isDrawn);
        const { data } = await view.readPixels();
        expect(psnrDb(data, reference(sortBy))).toBeGreaterThan(90);
      }
      for (const { cloud } of clouds) cloud.destroy();
    },
  );

  gpuTest('stays that of the last frame while shaders for another compile', async () => {
    const flat = { ...LARGE, logScales: [-0.5, -0.5, -2] };
    const cloud = engine.add(splatsOf([{ ...flat, position: [0, 0, -2] }]));
    const frame = { clouds: [{ cloud }], ...SIZE };
    const other = engine.createView();
    other.render({ ...frame, camera: PERSPECTIVE });
    await other.whenDrawn();
    const moved = perspectiveCamera({ ...PLACE, position: [0.1, 0, 0], fovYDegrees: 90 });
    const submit = vi.spyOn(device.queue, 'submit');
    other.render({ ...frame, camera: moved, sortBy: 'distance' });
    expect(submit).toHaveBeenCalled();
    submit.mockRestore();
    expect(other.shape!.sortsByDistance).toBe(false);
    await other.whenDrawn();
    expect(other.shape!.sortsByDistance).toBe(true);
    other.destroy();
    cloud.destroy();
  });

  gpuTest(
    'by distance leaves tiles to go on behind a surface of the host: the next splats may be before it',
    async () => {
      const host = {
        mapping: 'projection',
        compare: 'less-equal',
        isOrthographic: false,
        isTested: true,
        layerFormat: null,
      } as const;
      for (const sortBy of ['depth', 'distance'] as const) {
        await draw(RED, BLUE, { sortBy, accuracy: { preset: 'reference', rasterizer: 'tiles' } });
        const stages = frameStages({ ...view.shape!, depth: host });
        const stage = stages.find((each) => 'stage' in each && each.stage === 'tile-rasterize');
        expect(stage).toMatchObject({ conditions: { SHORT_KEYS: sortBy === 'distance' } });
      }
    },
  );

  gpuTest('is checked', async () => {
    for (const sortBy of ['radial', null, 1] as unknown as readonly SortBy[]) {
      const error = await draw(RED, BLUE, { sortBy }).catch((thrown: unknown) => thrown);
      expect(error).toBeInstanceOf(InvalidArgumentError);
      expect((error as Error).message).toMatch(/sortBy is .* one of auto, depth, distance/);
    }
  });
});
