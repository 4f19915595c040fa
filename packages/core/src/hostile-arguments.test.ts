// Proves: any argument of the public interface is accepted or refused by name.
import { inspect } from 'node:util';
import { describe, expect, test, vi } from 'vitest';
import { SplatEngine } from './create-engine.ts';
import { internAccuracy, resolveAccuracy } from './data/accuracy/accuracy.ts';
import { internTarget } from './data/accuracy/accuracy-target.ts';
import {
  cameraFromMatrices,
  orthographicCamera,
  perspectiveCamera,
  projectionOf,
} from './data/camera/camera.ts';
import { type SplatArrays, splatsFromArrays } from './data/editing/splats-from-arrays.ts';
import { InvalidArgumentError, SplatFileError } from './data/errors.ts';
import { identity4 } from './data/math/mat4.ts';
import type { EngineOptions, LoadOptions } from './engine.ts';
import { type EditedRows, type EditedValues, SplatEdits } from './features/edits/splat-edits.data.ts';
import { planCloud } from './frame/plan/cloud-plan.ts';
import { checkRequest } from './frame/plan/frame-request.ts';
import { planFraming } from './framing/frame-clouds.ts';
import * as effects from './gpu/effects/index.ts';
import { encodePly } from './io/formats/ply/write-ply.ts';
import { hostileVersions } from './testing/hostile-values.ts';
import { randomSplats } from './testing/random-splats.ts';

const CAMERA = { position: [1, 2, 3], target: [0, 0, 0], up: [0, 1, 0], aspect: 1.5, near: 0.1, far: 100 };
const SELECTION = new effects.SplatSelection();
SELECTION.add([1, 2]);

vi.stubGlobal('GPUBufferUsage', {});
/** Draws nothing; has any memory. */
const device = {
  features: new Set(),
  limits: {
    maxComputeWorkgroupsPerDimension: 65_535,
    maxBufferSize: 2 ** 28,
    maxStorageBufferBindingSize: 2 ** 27,
  },
  adapterInfo: { vendor: 'acme', isFallbackAdapter: true },
  lost: new Promise(() => {}),
  queue: { writeBuffer: () => {} },
  createBuffer: ({ size }: GPUBufferDescriptor) => ({
    getMappedRange: () => new ArrayBuffer(size),
    unmap: () => {},
    destroy: () => {},
  }),
  pushErrorScope: () => {},
  popErrorScope: async () => null,
} as unknown as GPUDevice;
const FILE = encodePly(randomSplats({ count: 3 }));
const engine = await SplatEngine.create({ device });
/** Neither plain objects, so that they are replaced as a whole. */
const cloud = Object.assign(Object.create({}), {
  name: 'garden',
  device,
  checkUsable: () => {},
  origin: [0, 0, 0],
  facts: {},
});
const EFFECTS = [effects.tint([1, 0, 0]), effects.brightness(2)].map((use) => Object.setPrototypeOf(use, {}));

interface Call {
  readonly good: readonly unknown[];
  /** Returns the values that must be finite. */
  readonly call: (...given: never[]) => unknown;
  /** Arguments that an error may name besides the names in `good`. */
  readonly others?: readonly string[];
}

/** Names by which errors call an argument without one of its own. */
const NAMELESS = ['options', 'accuracy'];
/** Results of a camera's options. */
const MATRICES = ['viewMatrix', 'projectionMatrix'];

const CALLS: Record<string, Call> = {
  resolveAccuracy: { good: [{ preset: 'high', sortKeyBits: 24, alphaCutoff: 0.01 }], call: resolveAccuracy },
  internAccuracy: { good: [{ preset: 'fast', resolutionScale: 0.5 }], call: internAccuracy },
  internTarget: { good: [{ minPsnrDb: 40 }], call: (request) => internTarget(request)?.toString() },
  perspectiveCamera: { good: [{ ...CAMERA, fovYDegrees: 60 }], call: perspectiveCamera, others: MATRICES },
  orthographicCamera: { good: [{ ...CAMERA, height: 3 }], call: orthographicCamera, others: MATRICES },
  cameraFromMatrices: {
    good: [
      identity4(),
      perspectiveCamera({ ...CAMERA, fovYDegrees: 60 } as never).projectionMatrix,
      { near: 0.1, far: 10 },
    ],
    call: cameraFromMatrices,
    others: MATRICES,
  },
  'an engine': {
    good: [
      {
        accuracy: { preset: 'high', sortKeyBits: 24 },
        tileBudgetBytes: 2 ** 20,
        submissionBudgetMs: 100,
        memoryBudgetBytes: 2 ** 20,
        streamBudgetBytes: 2 ** 20,
      },
    ],
    call: async (options: EngineOptions) => {
      const made = await SplatEngine.create({ ...options, device });
      made.destroy();
      return [made.accuracy.sortKeyBits];
    },
  },
  'a load': {
    good: [
      {
        name: 'garden',
        maxBytes: 1e6,
        maxSplats: 100,
        precision: { geometryPrecision: 'packed', shPrecision: 'f16' },
        fit: 'auto',
      },
    ],
    call: async (options: LoadOptions) => {
      const { maxBytes, maxSplats } = options ?? {};
      try {
        const loaded = await engine.load(FILE, options);
        loaded.destroy();
      } catch (error) {
        // A limit that is one, but too low for the file.
        if (!(error instanceof SplatFileError && error.code === 'too-large')) throw error;
        expect(Math.min(maxBytes!, maxSplats!)).toBeGreaterThan(0);
      }
      expect(engine.memory().totalBytes).toBe(0);
    },
  },
  splatsFromArrays: {
    good: [
      {
        positions: [1, 2, 3, 4, 5, 6],
        scales: [1, 2, 3, 1, 2, 3],
        rotations: [0, 0, 0, 1, 1, 0, 0, 0],
        opacities: [0.5, 0.25],
        sh: Float32Array.from({ length: 24 }, (_, i) => i),
        isAntialiased: true,
      },
    ],
    call: (arrays: SplatArrays) => {
      const { positions, logScales, rotations, colorDc, harmonics } = splatsFromArrays(arrays);
      return [positions, logScales, rotations, colorDc, harmonics.coefficients];
    },
    others: ['arrays', 'colors', 'covariances'],
  },
  edits: {
    good: [
      { first: 3, count: 2 },
      { positions: [1, 2, 3], scales: [1, 2, 3, 1, 2, 3], rotations: [0, 0, 0, 1], colors: [1, 0, 0] },
    ],
    call: (rows: EditedRows, values: EditedValues) => new SplatEdits(100).set(rows, values),
    others: ['rows', 'values', 'opacities', 'visible'],
  },
  'rows that are edited': {
    good: [[1, 2, 3], { visible: false }],
    call: (rows: EditedRows, values: EditedValues) => new SplatEdits(100).set(rows, values),
    others: ['rows', 'values', 'positions', 'scales', 'rotations', 'colors', 'opacities'],
  },
  'a frame request': {
    good: [
      {
        camera: perspectiveCamera({ ...CAMERA, fovYDegrees: 60 } as never),
        clouds: [{ cloud, modelMatrix: identity4(), opacity: 0.5, shDegree: 2, effects: EFFECTS }],
        widthPx: 64,
        heightPx: 48,
        background: [0, 0.5, 1],
        sortBy: 'distance',
      },
    ],
    call: (request: Parameters<typeof checkRequest>[0]) => {
      checkRequest(request, device);
      const projection = projectionOf(request.camera, 64, 48);
      return request.clouds.map((each) => {
        const { parameters, view } = planCloud(each, request.camera, projection, resolveAccuracy());
        return [new Float32Array(parameters.slice().buffer), view];
      });
    },
  },
  'a framing': {
    good: [
      [{ cloud, modelMatrix: identity4(), opacity: 0.5 }],
      { aspect: 1.5, fovYDegrees: 60, up: [0, 0, 1], kind: 'surrounded' },
    ],
    call: (...args: Parameters<typeof planFraming>) => planFraming(...args)?.wishes,
    others: ['clouds', 'instances'],
  },
  ...Object.fromEntries(
    Object.entries({
      tint: [[1, 0.5, 0]],
      brightness: [2],
      grade: [{ exposure: 1, saturation: 1.2, temperature: 0.5, tint: 0.1 }],
      opacity: [0.5],
      antialias: [true],
      volumes: [
        [
          { shape: 'box', mode: 'hide', center: [0, 0, 0], size: [1, 2, 3], rotation: [0, 0, 0, 1] },
          { shape: 'sphere', mode: 'keep', center: [0, 1, 0], radius: 2, softEdge: 0.1 },
          {
            shape: 'plane',
            mode: 'tint',
            tint: [1, 0, 2],
            point: [0, 0, 1],
            normal: [0, 1, 0],
            invert: true,
          },
          { shape: 'ellipsoid', mode: 'fade', opacity: 0.5, size: [1, 2, 3], matrix: [...identity4()] },
          {
            shape: 'capsule',
            mode: 'displace',
            offset: [1, 2, 3],
            radius: 1,
            height: 2,
            rotation: [0, 0, 1, 1],
          },
          { shape: 'plane', mode: 'hide', matrix: [...identity4()] },
        ],
      ],
      fog: [{ color: [0.5, 0.5, 0.5], near: 1, far: 10 }],
      reveal: [{ from: [0, 0, 0], radius: 3, softEdge: 0.5, grow: true }],
      highlight: [{ selection: SELECTION, color: [1, 0, 0], strength: 0.5 }],
    } satisfies Partial<Record<keyof typeof effects, unknown[]>>).map(([name, good]) => {
      const effect = new Map(Object.entries(effects)).get(name) as typeof effects.tint;
      const place = {
        modelMatrix: identity4(),
        origin: [0, 0, 0] as const,
        viewMatrix: identity4(),
        projection: { isOrthographic: false, focalPx: [1, 1] as const },
      };
      const call = (...options: never[]) => {
        const use = effect(...(options as unknown as [never]));
        return [use.reason === null ? null : use.valuesAt(place), use.reach];
      };
      return [name, { good, call }];
    }),
  ),
};

/** Names of all members of `value`, at any depth. */
function namesIn(value: unknown): string[] {
  if (typeof value !== 'object' || value === null || ArrayBuffer.isView(value)) return [];
  return Object.entries(value).flatMap(([name, part]) => [name, ...namesIn(part)]);
}

/** Throws for numbers beyond float32 at any level, but `near` and `far`, which draw all or none. */
function expectFinite(value: unknown, name = 'result'): void {
  if (typeof value === 'number') {
    if (!Number.isFinite(Math.fround(value)) && !/\.(near|far)$/.test(name))
      throw new Error(`${name} is ${value}`);
  } else if (Array.isArray(value) || ArrayBuffer.isView(value)) {
    for (const [i, part] of Array.from(value as ArrayLike<unknown>).entries())
      expectFinite(part, `${name}.${i}`);
  } else if (typeof value === 'object' && value !== null) {
    for (const [key, part] of Object.entries(value)) expectFinite(part, `${name}.${key}`);
  }
}

describe('any argument is taken or refused by name', () => {
  /**
   * @fault Arguments: any value for a camera, frame, effect or accuracy; any number, precision or mode for
   *   an engine or a load
   * @consequence accepted, or an `InvalidArgumentError` that names it; nothing changes
   */
  test.each(Object.entries(CALLS))('%s', { timeout: 600_000 }, async (name, { good, call, others = [] }) => {
    expectFinite(await call(...(good as never[])));
    const known = new Set([name, ...NAMELESS, ...others, ...namesIn(good)]);
    let refused = 0;
    for (const [which, argument] of good.entries())
      for (const version of hostileVersions(argument)) {
        const given = good.with(which, version);
        try {
          expectFinite(await call(...(given as never[])));
        } catch (error) {
          if (!(error instanceof InvalidArgumentError))
            throw new Error(`Given ${shown(given)}`, { cause: error });
          const named = error.argument.replace(/\[\d+\]$/, '').replace(/^.*\./, '');
          const isNamed = known.has(named) || namesIn(given).includes(named);
          if (!isNamed || error.message.length > 1000)
            throw new Error(`Of ${error.argument}, a bad message: ${error.message.slice(0, 200)}`);
          refused++;
        }
      }
    expect(refused, name).toBeGreaterThan(20);
  });
});

/** `given` in a failure's words. */
function shown(given: readonly unknown[]): string {
  return inspect(given, { depth: 6, maxArrayLength: 20, maxStringLength: 40 });
}

/**
 * @fault Arguments: a budget of no time, a limit that is not a number, an unknown mode
 * @consequence `InvalidArgumentError`
 */
test.each<[string, () => Promise<unknown>]>([
  ...[0, -1, Number.NaN].map((submissionBudgetMs): [string, () => Promise<unknown>] => [
    'submissionBudgetMs',
    () => SplatEngine.create({ device, submissionBudgetMs }),
  ]),
  ['memoryBudgetBytes', () => SplatEngine.create({ device, memoryBudgetBytes: Number.NaN })],
  ['streamBudgetBytes', () => SplatEngine.create({ device, streamBudgetBytes: -1 })],
  ['tileBudgetBytes', () => SplatEngine.create({ device, tileBudgetBytes: '1e6' as never })],
  ['maxBytes', () => engine.load(FILE, { maxBytes: Number.NaN })],
  ['fit', () => engine.load(FILE, { fit: 'Auto' as never })],
  ['precision', () => engine.load(FILE, { precision: 'f32' as never })],
  [
    'shPrecision',
    () => engine.load(FILE, { precision: { geometryPrecision: 'f32', shPrecision: 'f64' as never } }),
  ],
])('a %s that is none is refused', async (argument, call) => {
  await expect(call()).rejects.toMatchObject({ name: 'InvalidArgumentError', argument });
});
