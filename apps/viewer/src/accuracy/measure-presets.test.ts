import type { AccuracyTable, MeasureAccuracyOptions } from '@websplatter/core/measure';
import { beforeEach, describe, expect, it, vi } from 'vitest';
import type { Viewer } from '../engine/viewer.ts';
import { createViewerStore, type ViewerStore } from '../state/store.ts';
import { RestMeasurement } from './measure-at-rest.ts';
import { AccuracyMeasurement } from './measure-presets.ts';

const started: { options: MeasureAccuracyOptions; finish: (table: AccuracyTable) => void }[] = [];

vi.mock('@websplatter/core/measure', () => ({
  countMeasureSteps: ({ settings }: MeasureAccuracyOptions) => (settings?.length === 0 ? 10 : 120),
  measureAccuracy: (_: unknown, options: MeasureAccuracyOptions) =>
    new Promise((finish, fail) => {
      started.push({ options, finish });
      options.signal?.addEventListener('abort', () => fail(options.signal?.reason));
    }),
}));

let store: ViewerStore;
let measurement: AccuracyMeasurement;

const tableOf = (points: number) =>
  ({ points: Array(points).fill({}), elapsedMs: 500 }) as unknown as AccuracyTable;

/** The store's state after a measurement that `act` ends. */
async function measured(sweep: 'presets' | 'settings', act: (run: (typeof started)[0]) => void) {
  const before = started.length;
  const done = measurement.measure(sweep);
  await expect.poll(() => started.length).toBe(before + 1);
  act(started[before]);
  await done;
  return store.getState().measured;
}

beforeEach(() => {
  store = createViewerStore();
  const engine = { device: { adapterInfo: { architecture: 'swiftshader', vendor: 'google' } } };
  const scenes = { newest: null };
  const viewer = { shownFrame: { engine, frame: {} }, isAtRest: true, scenes } as unknown as Viewer;
  measurement = new AccuracyMeasurement(viewer, store, new RestMeasurement(viewer, store));
});

describe('measuring accuracy', () => {
  it('tries the presets first, and tells from them how long every setting takes', async () => {
    const result = await measured('presets', ({ options, finish }) => {
      expect(options).toMatchObject({ settings: [], ablations: false, combinations: false });
      finish(tableOf(5));
    });
    expect(result).toMatchObject({ sweep: 'presets', isCutShort: false, allSettingsMs: 6000 });
  });

  it('tries every setting on demand', async () => {
    const result = await measured('settings', ({ options, finish }) => {
      expect(options.settings).toBeUndefined();
      finish(tableOf(30));
    });
    expect(result).toMatchObject({ sweep: 'settings', isCutShort: false, allSettingsMs: null });
  });

  it('shows what is measured as it comes, and keeps it where it is cancelled', async () => {
    const result = await measured('settings', ({ options }) => {
      for (const points of [1, 6]) {
        options.onTable?.(tableOf(points));
        expect(store.getState().measured?.table.points).toHaveLength(points);
      }
      measurement.cancel();
    });
    expect(result).toMatchObject({ isCutShort: true, table: { points: { length: 6 } } });
    expect(store.getState().measuring).toBeNull();
  });

  it('keeps what it knew before where that tells more', async () => {
    const presets = await measured('presets', ({ finish }) => finish(tableOf(5)));
    expect(await measured('settings', () => measurement.cancel())).toBe(presets);
    const fewer = await measured('settings', ({ options }) => {
      options.onTable?.(tableOf(4));
      measurement.cancel();
    });
    expect(fewer).toBe(presets);
  });

  it('takes nothing more after that', async () => {
    const result = await measured('settings', ({ options }) => {
      measurement.cancel();
      options.onTable?.(tableOf(6));
    });
    expect(result).toBeNull();
  });

  it('names what is measured in plain words', async () => {
    await measured('settings', ({ options, finish }) => {
      const name = 'colorTarget rgba8unorm';
      const settings = { ...store.getState().accuracy, colorTarget: 'rgba8unorm' } as const;
      const point = { name, settings, changed: ['colorTarget'] } as const;
      options.onProgress?.({ done: 3, total: 9, label: `2 of 3: ${name}`, point });
      expect(store.getState().measuring?.label).toBe('2 of 3: 8-bit blending');
      finish(tableOf(3));
    });
  });
});
