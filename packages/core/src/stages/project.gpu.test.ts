import { createTestDevice, gpuTest } from '@websplatter/node/gpu-test';
import { afterAll, beforeAll, describe, expect } from 'vitest';
import { DILATION_PX2 } from '../accuracy.ts';
import { perspectiveCamera } from '../camera.ts';
import { FLOAT32_ROUNDING, projectionErrors } from '../inspect/error-bounds.ts';
import { type InspectedCloud, InspectedFrame, type InspectOptions } from '../inspect/inspected-frame.ts';
import { depthKey } from '../layout/depth-key.ts';
import { fromHalfBits } from '../layout/half.ts';
import { unpackShRest } from '../layout/sh-rest.ts';
import { ProjectedSplat, ProjectedSplatF32 } from '../layout/structs.ts';
import { screenAxes } from '../reference/covariance.ts';
import { cullSplat } from '../reference/cull-splats.ts';
import { splatColor } from '../reference/project.ts';
import { radixSort } from '../reference/radix-sort.ts';
import type { ShDegree } from '../scene/splat-set.ts';
import { randomSplats } from '../testing/random-splats.ts';
import { TEST_MODELS, testCameras } from '../testing/test-cameras.ts';

let device: GPUDevice;
beforeAll(async () => {
  device = await createTestDevice();
});
afterAll(() => device.destroy());

const SIZE = { widthPx: 48, heightPx: 32 };
const SPLATS = 1000;
const u = FLOAT32_ROUNDING;

interface Record {
  readonly centerPx: readonly number[];
  readonly majorPx: readonly number[];
  readonly minorLengthPx: number;
  readonly depthView: number;
  /** r, g, b and opacity. */
  readonly color: readonly number[];
}

async function readRecords(frame: InspectedFrame, count: number): Promise<Record[]> {
  const words = await frame.words('projected');
  const floats = new Float32Array(words.buffer);
  const { bytes, offsets } = frame.accuracy.recordPrecision === 'f32' ? ProjectedSplatF32 : ProjectedSplat;
  return Array.from({ length: count }, (_, i) => {
    const at = (field: keyof typeof offsets) => (i * bytes + offsets[field]) / 4;
    const vector = (field: keyof typeof offsets, length: number) =>
      Array.from(floats.subarray(at(field), at(field) + length));
    const color =
      frame.accuracy.recordPrecision === 'f32'
        ? vector('color', 4)
        : [0, 1].flatMap((k) => {
            const word = words[at('color') + k];
            return [fromHalfBits(word & 0xffff), fromHalfBits(word >>> 16)];
          });
    const [minorLengthPx] = vector('minorLengthPx', 1);
    const [depthView] = vector('depthView', 1);
    return {
      centerPx: vector('centerPx', 2),
      majorPx: vector('majorPx', 2),
      minorLengthPx,
      depthView,
      color,
    };
  });
}

/** Every field of one record with what it should be and how far it may be from it. */
function compareRecord(
  record: Record,
  frame: InspectedFrame,
  { stored, view }: InspectedCloud,
  index: number,
) {
  const { projection, accuracy } = frame;
  // Nothing but the splat's own values decides here: whatever the GPU kept must look as the twin says.
  const everywhere = { ...projection, near: Number.NEGATIVE_INFINITY, far: Number.POSITIVE_INFINITY };
  const wide = {
    ...everywhere,
    widthPx: 1e9,
    heightPx: 1e9,
    centerPx: [5e8, 5e8] as const,
  };
  const twin = cullSplat(stored, index, view, wide, { alphaCutoff: 1e-9, dilationPx2: DILATION_PX2 });
  if (!twin) throw new Error(`The twin drops splat ${index} altogether.`);
  const { a, b, c } = twin.covariance;
  const axes = screenAxes(twin.covariance);
  // LONGEST_AXIS_PX of shaders/lib/covariance.wgsl: beyond it the picture is the same.
  const [major, minor] = [axes.majorPx, axes.minorPx].map(([x, y]) => Math.min(1e18, Math.hypot(x, y)));
  const errors = projectionErrors(stored, index, view, projection);
  const centerOf = (axis: 0 | 1) => twin.centerPx[axis] - 5e8 + projection.centerPx[axis];

  // Axes may point either way, and anywhere for a circle: what they span is compared, Σ = ½(major·majorᵀ + minor·minorᵀ).
  const [x, y] = record.majorPx;
  const length = Math.hypot(x, y);
  const [minorX, minorY] = [(-y / length) * record.minorLengthPx, (x / length) * record.minorLengthPx];
  // By Weyl a singular value moves no more than the matrix does; 16u for the sums and roots after it. The minor length
  // comes through a cross product whose rounding is relative to both rows: the same as more error of the rows.
  const lengthError = Math.SQRT2 * errors.rowsPx + 16 * u * major;
  const isShortened = major === 1e18;
  const covarianceError = isShortened
    ? Number.POSITIVE_INFINITY
    : 2 * Math.sqrt(a + c) * errors.rowsPx + 32 * u * (a + c);

  const direction = errors.direction;
  const rest = new Float64Array(45);
  const degree = Math.min(stored.shRest.degree, accuracy.shDegree) as ShDegree;
  unpackShRest(stored.shRest, index, rest);
  const used = rest.subarray(0, 3 * [0, 3, 8, 15][degree]);
  const energy = used.reduce((sum, value) => sum + Math.abs(value), 0);
  const dc = Math.max(...stored.colorDc.subarray(3 * index, 3 * index + 3).map(Math.abs));
  // Basis functions are below 2.9 and change by less than 12 per unit of direction; sums of 16 terms.
  const colorError = 24 * u * (0.5 + dc + 2.9 * energy) + 12 * direction * energy;
  const isHalf = accuracy.recordPrecision === 'f16';
  // Rounding to binary16, of which some hardware truncates: 2^-10 of the value.
  const stored16 = (value: number) => (isHalf ? value * 2 ** -10 + 2 ** -24 : 0);
  const color = splatColor(stored, index, view, accuracy.shDegree);

  const fields: [string, number, number, number][] = [
    ['centerPx.x', record.centerPx[0], centerOf(0), errors.centerPx[0] + 1e-7],
    ['centerPx.y', record.centerPx[1], centerOf(1), errors.centerPx[1] + 1e-7],
    ['depthView', record.depthView, twin.depthView, errors.depthView],
    ['major length', length, major, lengthError],
    ['minor length', record.minorLengthPx, minor, lengthError],
    ['Σxx', (x * x + minorX * minorX) / 2, a, covarianceError],
    ['Σxy', (x * y + minorX * minorY) / 2, b, covarianceError],
    ['Σyy', (y * y + minorY * minorY) / 2, c, covarianceError],
    ['opacity', record.color[3], twin.opacity, 8 * u + stored16(twin.opacity)],
    ...color.map((value, k): [string, number, number, number] => [
      `color ${'rgb'[k]}`,
      record.color[k],
      value,
      colorError + stored16(value),
    ]),
  ];
  return fields;
}

async function check(options: Omit<InspectOptions, 'widthPx' | 'heightPx' | 'keyBits'>) {
  const frame = await InspectedFrame.draw(device, { ...options, ...SIZE, keyBits: 8 });
  const count = await frame.visibleCount();
  expect(count).toBeGreaterThan(SPLATS / 50);
  const survivors = await frame.words('survivors');
  const records = await readRecords(frame, count);
  for (const [i, record] of records.entries()) {
    const { cloud, index } = frame.locate(survivors[i]);
    // Dilation keeps every axis this long, so that whoever divides by one may.
    expect(record.minorLengthPx).toBeGreaterThanOrEqual(Math.sqrt(2 * DILATION_PX2) * (1 - 1e-5));
    for (const [field, actual, expected, bound] of compareRecord(record, frame, cloud, index)) {
      const isClose = Math.abs(actual - expected) <= bound;
      if (!isClose)
        expect.fail(
          `splat ${index}, ${field}: got ${actual}, expected ${expected} ± ${bound}\n${JSON.stringify(record)}`,
        );
    }
  }

  // Integers leave no room: keys are those of the depths written, and one pass of 8 bits sorts by their low digit.
  const [farthest] = await frame.words('depthRange');
  const keys = await frame.sorted('keys');
  expect(keys).toEqual(Uint32Array.from(records, ({ depthView }) => depthKey(depthView, farthest)));
  const lowDigits = keys.map((key) => key & 0xff);
  expect(await frame.sorted('order')).toEqual(
    radixSort(lowDigits, { digitBits: 8, passes: 1, tileKeys: 2048 }),
  );
  expect(await frame.words('drawArguments')).toEqual(Uint32Array.of(4, count, 0, 0));
  frame.destroy();
}

describe('project', () => {
  for (const [name, camera] of Object.entries(testCameras(1.5))) {
    gpuTest(`${name} camera, degree 3`, () =>
      check({ clouds: [{ set: randomSplats({ count: SPLATS, seed: 11 }) }], camera }),
    );
  }

  for (const [name, modelMatrix] of Object.entries(TEST_MODELS)) {
    gpuTest(`${name} model, packed geometry, u8 harmonics, f16 records, two pages and clouds`, () =>
      check({
        clouds: [
          { set: randomSplats({ count: SPLATS, seed: 12 }), modelMatrix, splatsPerPage: 512 },
          { set: randomSplats({ count: 100, seed: 13, shDegree: 1 }) },
        ],
        camera: testCameras(1.5).perspective,
        accuracy: { geometryPrecision: 'packed', shPrecision: 'u8', recordPrecision: 'f16' },
        dispatchRow: 1,
      }),
    );
  }

  for (const stored of [0, 1, 2, 3] as const) {
    for (const evaluated of [0, 1, 2, 3] as const) {
      if (evaluated > stored) continue;
      gpuTest(`degree ${evaluated} of ${stored} stored, f16 harmonics`, () =>
        check({
          clouds: [{ set: randomSplats({ count: SPLATS, seed: 14, shDegree: stored }) }],
          camera: testCameras(1.5).inside,
          accuracy: { shPrecision: 'f16', shDegree: evaluated },
        }),
      );
    }
  }

  gpuTest('needles, discs and points of every size', () =>
    check({
      clouds: [{ set: randomSplats({ count: SPLATS, seed: 15, shDegree: 0, logScales: [-18, 1] }) }],
      camera: testCameras(1.5).perspective,
    }),
  );

  gpuTest('the largest scales there are', () =>
    check({
      clouds: [{ set: randomSplats({ count: SPLATS, seed: 16, shDegree: 0, logScales: [-40, 40] }) }],
      camera: testCameras(1.5).perspective,
    }),
  );

  gpuTest('the largest scales right before the eye', () =>
    check({
      clouds: [
        {
          set: randomSplats({ count: SPLATS, seed: 17, shDegree: 0, halfExtent: 1e-4, logScales: [-40, 40] }),
        },
      ],
      camera: perspectiveCamera({
        position: [0, 0, 1e-4],
        target: [0, 0, 0],
        fovYDegrees: 20,
        aspect: 1.5,
        near: 1e-7,
      }),
    }),
  );
});
