import { expect, test, vi } from 'vitest';
import { GpuLimitError } from '../data/errors.ts';
import { packSet } from '../data/packing/pack-set.ts';
import { GpuMemory } from '../gpu/gpu-memory.ts';
import { BUFFER_USAGE, deviceWithoutGpu } from '../testing/device-without-gpu.ts';
import { randomSplats } from '../testing/random-splats.ts';
import { cloudBytes, coarserSettings, type FitMode, fitPacked } from './fit-settings.ts';

test('settings get coarser step by step, and every step takes fewer bytes', () => {
  const wanted = { geometryPrecision: 'f32', shPrecision: 'f32', shDegree: 3 } as const;
  const coarser = coarserSettings(wanted);
  expect(coarser.map(({ geometryPrecision, ...sh }) => [geometryPrecision, ...Object.values(sh)])).toEqual([
    ['f32', 'f16', 3],
    ['f32', 'u8', 3],
    ['packed', 'u8', 3],
    ['packed', 'u8', 2],
    ['packed', 'u8', 1],
    ['packed', 'u8', 0],
  ]);
  const bytes = [wanted, ...coarser].map((settings) => cloudBytes(1000, settings));
  expect(bytes).toEqual(bytes.toSorted((a, b) => b - a));
  expect(new Set(bytes).size).toBe(bytes.length);
});

test('a cloud without harmonics can only have its geometry packed', () => {
  expect(coarserSettings({ geometryPrecision: 'f32', shPrecision: 'f32', shDegree: 0 })).toEqual([
    { geometryPrecision: 'packed', shPrecision: 'f32', shDegree: 0 },
  ]);
  expect(coarserSettings({ geometryPrecision: 'packed', shPrecision: 'u8', shDegree: 0 })).toEqual([]);
});

vi.stubGlobal('GPUBufferUsage', BUFFER_USAGE);

const FINEST = { geometryPrecision: 'f32', shPrecision: 'f32' } as const;
const PACKED = packSet(randomSplats({ count: 1000, shDegree: 3 }), FINEST);

/** Fits a cloud packed on the CPU into so much memory. `onProbe` is called on each look for it. */
function fitInto(
  availableBytes: number,
  mode: FitMode,
  onProbe = () => {},
  signal = new AbortController().signal,
) {
  const device = deviceWithoutGpu(async () => onProbe());
  const memory = new GpuMemory(device, availableBytes);
  const failure = new GpuLimitError('memoryBudgetBytes', 1, 0, 'none');
  return fitPacked(PACKED, { memory, name: 'garden', failure, signal }, mode);
}

test('packed splats keep their geometry, which counts and is told', async () => {
  const taken = { geometryPrecision: 'f32', shPrecision: 'u8', shDegree: 2 } as const;
  const availableBytes = cloudBytes(1000, taken);
  const { packed, fit } = await fitInto(availableBytes, 'auto');
  expect(packed.geometry).toBe(PACKED.geometry);
  expect(packed.harmonics).toMatchObject({ precision: 'u8', degree: 2 });
  expect(fit).toMatchObject({ taken, takenBytes: availableBytes });
  expect(fit.why).toMatch(/it has f32 geometry and u8 harmonics of degree 2 instead/);
  await expect(fitInto(availableBytes, 'exact')).rejects.toMatchObject({
    fitting: {
      precision: { geometryPrecision: taken.geometryPrecision, shPrecision: taken.shPrecision },
      fit: 'auto',
    },
  });
});

test('a load that is called off looks for no more memory', async () => {
  const [caller, reason] = [new AbortController(), new Error('enough')];
  let probes = 0;
  const onProbe = () => {
    probes++;
    caller.abort(reason);
  };
  await expect(fitInto(Number.POSITIVE_INFINITY, 'auto', onProbe, caller.signal)).rejects.toBe(reason);
  // Before and after the allocation.
  expect(probes).toBe(2);
});
