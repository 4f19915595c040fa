// Proves: arguments of the wrong type are refused by name.

import { gpuTest, shareTestDevice } from '@websplatter/node/gpu-test';
import { beforeAll, describe, expect, vi } from 'vitest';
import { makeColliderMesh } from './clouds/collider/index.ts';
import { WebSplatterError } from './data/errors.ts';
import { identity4 } from './data/math/mat4.ts';
import * as core from './index.ts';
import * as measure from './measure/index.ts';
import * as ownData from './own-data.ts';
import { randomSplats } from './testing/random-splats.ts';
import * as write from './write.ts';

/** Values that callers without types pass by mistake, of every kind that `typeof` tells. */
const WRONG: readonly unknown[] = [
  null,
  5,
  -1,
  Number.NaN,
  10n,
  'x',
  Symbol('s'),
  true,
  {},
  [],
  [null],
  () => 3,
];

const LOOK_AT = { position: [0, 0, 5], target: [0, 0, 0], aspect: 1, near: 0.1, far: 100 } as const;
const SIZE = { widthPx: 32, heightPx: 32 };
const PRECISION = { geometryPrecision: 'packed', shPrecision: 'u8' } as const;

let device: GPUDevice;
let engine: core.SplatEngine;
let view: core.SplatView;
let embedded: core.EmbeddedView;
let cloud: core.SplatCloud;
let tree: core.RayTree;
let hostPass: core.HostPass;

beforeAll(async () => {
  device = await shareTestDevice();
  engine = await core.SplatEngine.create({ device });
  const set = randomSplats({ count: 20 });
  cloud = engine.add(set);
  view = engine.createView();
  embedded = engine.createEmbeddedView();
  view.render({ camera: CAMERA, clouds: [{ cloud }], ...SIZE });
  await view.whenDrawn();
  tree = await core.makeRayTree(cloud);
  const usage = GPUTextureUsage.TEXTURE_BINDING | GPUTextureUsage.COPY_SRC;
  const color = device.createTexture({ size: [SIZE.widthPx, SIZE.heightPx], format: 'rgba16float', usage });
  hostPass = { color, depth: null, xPx: 0, yPx: 0 };
  const request = { camera: CAMERA, clouds: [{ cloud }], ...SIZE };
  await vi.waitUntil(() => embedded.prepare(request), 120_000);
});

const SET = randomSplats({ count: 20 });
const CAMERA = core.perspectiveCamera({ ...LOOK_AT, fovYDegrees: 60 });
const PACKED = core.packCloud(SET, PRECISION);
const FILE = core.encodePly(SET);
const SKIN = { indices: [0, 0, 0, 0], weights: [1, 0, 0, 0] };
const EDITS = () => new ownData.SplatEdits(20);
const OVER = new AbortController();
OVER.abort(new core.DestroyedError('This call', 'its arguments were all that mattered'));
const WATCH = { signal: OVER.signal, onProgress: () => {} };

/** A call with right arguments. Functions of numbers alone, and those that are called for each splat, check nothing. */
interface Call {
  readonly args: () => readonly unknown[];
  readonly call: (...args: never[]) => unknown;
}

const CALLS: Record<string, Call> = {
  'SplatEngine.create': {
    args: () => [{ device, accuracy: 'high' }],
    call: async (options: never) => (await core.SplatEngine.create(options)).destroy(),
  },
  requestSplatDevice: {
    args: () => [{ adapter: null, powerPreference: 'low-power' }],
    call: core.requestSplatDevice,
  },
  'engine.setAccuracy': {
    args: () => ['balanced', WATCH],
    call: (...args) => engine.setAccuracy(...(args as [never])),
  },
  'engine.resolveAccuracy': {
    args: () => ['balanced'],
    call: (...args) => engine.resolveAccuracy(...(args as [never])),
  },
  'engine.load': {
    args: () => [
      FILE,
      {
        name: 'garden',
        precision: PRECISION,
        fit: 'auto',
        onPreview: () => {},
        maxBytes: 1e6,
        maxSplats: 100,
        request: {},
        ...WATCH,
      },
    ],
    call: async (...args) => (await engine.load(...(args as [never]))).destroy(),
  },
  'engine.add': {
    args: () => [SET, { name: 'garden' }],
    call: (...args) => engine.add(...(args as [never])).destroy(),
  },
  'engine.addPacked': {
    args: () => [PACKED, { name: 'garden', source: SET, sourceOptions: {} }],
    call: (...args) => engine.addPacked(...(args as [never])).destroy(),
  },
  'engine.addGpuSplats': {
    args: () => {
      const column = (values: number) => ({
        buffer: device.createBuffer({ size: 8 * values, usage: GPUBufferUsage.STORAGE }),
        offsetBytes: 0,
        strideBytes: 4 * values,
      });
      const bounds = { min: [-1, -1, -1], max: [1, 1, 1] };
      const needed = { count: 2, positions: column(3), scales: column(3), colors: column(3) };
      return [{ name: 'garden', ...needed, rotations: column(4), opacities: column(1), bounds }];
    },
    call: async (...args) => (await engine.addGpuSplats(...(args as [never]))).cloud.destroy(),
  },
  'engine.requestPrecision': {
    args: () => [cloud, PRECISION, WATCH],
    call: (...args) => engine.requestPrecision(...(args as unknown as [never, never])),
  },
  'engine.createView': {
    args: () => [{}],
    call: (...args) => engine.createView(...(args as [never])).destroy(),
  },
  'canvas of engine.createView': {
    args: () => ['canvas'],
    call: (canvas) => engine.createView({ canvas }).destroy(),
  },
  'view.render': {
    args: () => [
      {
        camera: CAMERA,
        clouds: [{ cloud, modelMatrix: identity4(), opacity: 1, shDegree: 3, effects: [] }],
        ...SIZE,
        background: [0, 0, 0],
        accuracy: 'high',
        sortBy: 'depth',
        force: true,
      },
    ],
    call: async (...args) => {
      view.render(...(args as [never]));
      await view.whenDrawn();
    },
  },
  'view.pick': { args: () => [5, 5], call: (...args) => view.pick(...(args as unknown as [number, number])) },
  'view.coverage': {
    args: () => [[{ point: [0, 0, 0], tolerance: 0 }]],
    call: (...args) => view.coverage(...(args as [never])),
  },
  'a point of view.coverage': {
    args: () => [{ point: [0, 0, 0], tolerance: 0 }],
    call: (point) => view.coverage([point]),
  },
  'view.chooseAccuracy': {
    args: () => [WATCH],
    call: (...args) => view.chooseAccuracy(...(args as [never])),
  },
  'embedded.prepare': {
    args: () => [
      {
        camera: CAMERA,
        clouds: [{ cloud }],
        ...SIZE,
        depth: { mapping: 'perspective', compare: 'less', clear: 1 },
        hasOccluders: true,
        writesDepth: false,
      },
    ],
    call: (...args) => embedded.prepare(...(args as [never])),
  },
  'embedded.draw': {
    args: () => [device.createCommandEncoder(), hostPass],
    call: (...args) => embedded.draw(...(args as unknown as [never, never])),
  },
  'embedded.makeImage': {
    args: () => [hostPass],
    call: (...args) => embedded.makeImage(...(args as unknown as [never])),
  },
  'cloud.hold': {
    args: () => [PRECISION, WATCH],
    call: async (...args) => {
      const lease = cloud.hold(...(args as [never]));
      await lease.met.finally(() => lease.release());
    },
  },
  'lease.change': {
    args: () => [PRECISION, WATCH],
    call: (...args) => cloud.ownLease.change(...(args as [never])),
  },
  'lease.add': {
    args: () => [PRECISION, WATCH],
    call: (...args) => cloud.ownLease.add(...(args as [never])),
  },
  'cloud.pagesFor': { args: () => [PRECISION], call: (...args) => cloud.pagesFor(...(args as [never])) },
  makeRayTree: { args: () => [cloud, WATCH], call: (...args) => core.makeRayTree(...(args as [never])) },
  frameScene: {
    args: () => [[{ cloud }], { aspect: 1, fovYDegrees: 50, up: [0, 1, 0], kind: 'object', ...WATCH }],
    call: (...args) => core.frameScene(...(args as unknown as [never])),
  },
  'a cloud of frameScene': {
    args: () => [{ cloud, modelMatrix: identity4(), instances: { modelMatrices: identity4() }, opacity: 1 }],
    call: (instance) => core.frameScene([instance]),
  },
  fileUp: { args: () => [cloud.facts], call: core.fileUp },
  'tree.cast': {
    args: () => [
      [0, 0, 5],
      [0, 0, -1],
      {
        view: { camera: CAMERA, modelMatrix: identity4(), heightPx: 100 },
        near: 0,
        far: 100,
        minOpacity: 0.5,
        opacity: 1,
        shownAt: () => 1,
      },
    ],
    call: (...args) => tree.cast(...(args as unknown as [never, never])),
  },
  resolveAccuracy: { args: () => [{ preset: 'high' }], call: core.resolveAccuracy },
  checkAccuracy: { args: () => ['high'], call: core.checkAccuracy },
  isAccuracyTarget: { args: () => [{ minPsnrDb: 40 }], call: core.isAccuracyTarget },
  combineAccuracies: { args: () => ['high', 'fast'], call: core.combineAccuracies },
  mostExact: { args: () => [['high', 'fast']], call: core.mostExact },
  cameraFromMatrices: {
    args: () => [identity4(), CAMERA.projectionMatrix, { near: 0.1, far: 10 }],
    call: core.cameraFromMatrices,
  },
  cameraPosition: { args: () => [CAMERA.viewMatrix], call: core.cameraPosition },
  perspectiveCamera: {
    args: () => [{ ...LOOK_AT, fovYDegrees: 60, up: [0, 1, 0] }],
    call: core.perspectiveCamera,
  },
  orthographicCamera: { args: () => [{ ...LOOK_AT, height: 3 }], call: core.orthographicCamera },
  cloudFacts: { args: () => [SET], call: core.cloudFacts },
  packCloud: { args: () => [SET, PRECISION], call: core.packCloud },
  transferablesOf: { args: () => [PACKED], call: core.transferablesOf },
  encodePly: { args: () => [SET], call: core.encodePly },
  lastingSource: { args: () => [FILE], call: core.lastingSource },
  loadSplats: {
    args: () => [FILE, { ...PRECISION, name: 'x', maxBytes: 1e6, maxSplats: 100, request: {}, ...WATCH }],
    call: core.loadSplats,
  },
  readSplats: {
    args: () => [
      FILE,
      { shPrecision: 'f32', name: 'x', maxBytes: 1e6, maxSplats: 100, request: {}, ...WATCH },
    ],
    call: core.readSplats,
  },
  adapterLabel: { args: () => [device.adapterInfo], call: core.adapterLabel },
  isSoftwareAdapter: { args: () => [device.adapterInfo], call: core.isSoftwareAdapter },
  isPlausible: { args: () => [core.wallClockTimings(1)], call: core.isPlausible as never },
  splatsFromArrays: {
    args: () => [{ positions: [0, 0, 0], scales: [1, 1, 1] }],
    call: ownData.splatsFromArrays,
  },
  packSet: { args: () => [SET, PRECISION], call: ownData.packSet },
  followEdits: { args: () => [cloud, EDITS(), PACKED], call: ownData.followEdits },
  flushEdits: { args: () => [cloud], call: ownData.flushEdits },
  'new SplatMorph': {
    args: () => [SET, SET, PRECISION],
    call: (...args) => new ownData.SplatMorph(...(args as unknown as [never, never, never])),
  },
  followMorph: {
    args: () => [cloud, new ownData.SplatMorph(SET, SET, PRECISION)],
    call: ownData.followMorph,
  },
  'new SplatSkin': {
    args: () => [SKIN, 1],
    call: (...args) => new ownData.SplatSkin(...(args as unknown as [never, never])),
  },
  'skin.setPose': {
    args: () => [new Float64Array(16)],
    call: (matrices) => new ownData.SplatSkin(SKIN, 1).setPose(matrices),
  },
  followSkin: { args: () => [cloud, new ownData.SplatSkin(SKIN, 1)], call: ownData.followSkin },
  'new SplatEdits': { args: () => [20], call: (rows) => new ownData.SplatEdits(rows) },
  'edits.set': {
    args: () => [{ first: 0, count: 1 }, { visible: true }],
    call: (...args) => EDITS().set(...(args as unknown as [never, never])),
  },
  'edits.follow': {
    args: () => [{ rowsChanged: () => {} }],
    call: (follower) => {
      const edits = EDITS();
      edits.follow(follower)();
    },
  },
  cropSplats: { args: () => [SET, { min: [-1, -1, -1], max: [1, 1, 1] }], call: write.cropSplats },
  filterSplats: { args: () => [SET, () => true], call: write.filterSplats },
  limitDegree: { args: () => [SET, 1], call: write.limitDegree },
  mergeSplats: { args: () => [[SET, SET]], call: write.mergeSplats },
  transformSplats: {
    args: () => [SET, { translation: [1, 2, 3], rotation: [0, 0, 0, 1], scale: 2 }],
    call: write.transformSplats,
  },
  writeSplats: { args: () => [SET, 'spz', { ...WATCH }], call: write.writeSplats },
  writableByName: { args: () => ['x.ply'], call: write.writableByName },
  rotationByDegrees: { args: () => [[1, 2, 3]], call: write.rotationByDegrees as never },
  makeColliderMesh: { args: () => [cloud, { cellSize: 0.5, ...WATCH }], call: makeColliderMesh as never },
  measureFrames: {
    args: () => [engine, { cameras: [CAMERA], clouds: [{ cloud }], ...SIZE, ...WATCH }],
    call: measure.measureFrames as never,
  },
  measureAccuracy: {
    args: () => [
      engine,
      { cameras: [CAMERA], clouds: [{ cloud }], ...SIZE, frames: 1, details: [], ...WATCH },
    ],
    call: measure.measureAccuracy as never,
  },
  measureEffects: {
    args: () => [engine, { camera: CAMERA, clouds: [{ cloud }], ...SIZE }, { frames: 1, ...WATCH }],
    call: measure.measureEffects as never,
  },
  orbitCameras: {
    args: () => [CAMERA, PACKED.bounds, { count: 3, sweepDegrees: 90 }],
    call: measure.orbitCameras as never,
  },
  sampleCameras: { args: () => [CAMERA, PACKED.bounds, 3], call: measure.sampleCameras as never },
  cameraAtDistance: { args: () => [CAMERA, [{ cloud }], 2], call: measure.cameraAtDistance as never },
  timeSpread: { args: () => [[1, 2]], call: measure.timeSpread as never },
};

/** The arguments with each of them, and each member of those that are plain objects, replaced in turn by a wrong value. */
function* wrongArguments({ args }: Call): Generator<{ readonly name: string; readonly given: unknown[] }> {
  const right = args();
  for (const [i, argument] of right.entries()) {
    for (const [w, wrong] of WRONG.entries()) {
      yield { name: `${i} is WRONG[${w}]`, given: args().with(i, wrong) };
      if (Object.getPrototypeOf(Object(argument)) !== Object.prototype) continue;
      for (const member of Object.keys(argument as object))
        yield {
          name: `${i}.${member} is WRONG[${w}]`,
          given: args().with(i, { ...(args()[i] as object), [member]: wrong }),
        };
    }
  }
}

/**
 * @fault Arguments: any argument of 65 functions, or a member of one, has the wrong type
 * @consequence accepted, or an `InvalidArgumentError` that names it
 */
describe('wrong arguments are taken or refused by a typed error', () => {
  for (const [name, call] of Object.entries(CALLS))
    gpuTest(name, async () => {
      const bare: string[] = [];
      for (const { name: what, given } of wrongArguments(call)) {
        try {
          await (call.call as (...args: unknown[]) => unknown)(...given);
        } catch (error) {
          if (!(error instanceof WebSplatterError)) bare.push(`${what}: ${error}`);
        }
      }
      expect(bare).toEqual([]);
    });
});
