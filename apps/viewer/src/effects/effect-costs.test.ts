import type { MeasureEffectsOptions } from '@websplatter/core/measure';
import { describe, expect, it, vi } from 'vitest';
import { RestMeasurement } from '../accuracy/measure-at-rest.ts';
import type { Viewer } from '../engine/viewer.ts';
import { createViewerStore } from '../state/store.ts';
import { describeCost, formatCost, measureEffectCosts, measureSwitchedOn } from './effect-costs.ts';

const measured: MeasureEffectsOptions[] = [];

vi.mock('@websplatter/core/measure', () => ({
  measureEffects: async (_engine: unknown, _frame: unknown, options: MeasureEffectsOptions) => {
    measured.push(options);
    return [];
  },
}));

describe('the cost of an effect', () => {
  it.each([
    [{ median: 0.42, low: 0.38, high: 0.5 }, '0.42 ms', 'Costs 0.42 ms of each frame (0.38 to 0.50 ms).'],
    [{ median: -3, low: -4, high: -2 }, '−3.0 ms', 'Saves 3.0 ms of each frame (−4.0 to −2.0 ms).'],
    [
      { median: 0.2, low: -0.1, high: 1 },
      'too small to measure here',
      'Too small to measure here: times of frames vary by ±1.0 ms.',
    ],
  ])('is written for %o', (costMs, figure, sentence) => {
    expect(formatCost(costMs)).toBe(figure);
    expect(describeCost(costMs)).toBe(sentence);
  });
});

describe('an effect that is switched on', () => {
  function viewerOn(adapterInfo: object) {
    const store = createViewerStore();
    const drawn = { shownFrame: { engine: { device: { adapterInfo } }, frame: {} }, isAtRest: true };
    return { store, drawn, measurement: new RestMeasurement(drawn as unknown as Viewer, store) };
  }
  const GPU = { architecture: 'hopper', vendor: 'nvidia' };
  const SOFTWARE = { architecture: 'swiftshader', vendor: 'google' };

  function draw({ store }: ReturnType<typeof viewerOn>, fogIsOn: boolean): void {
    store.setState(({ requested, imageId }) => ({
      requested: { ...requested, choices: { fog: { isOn: fogIsOn, values: {} } } },
      imageId: imageId + 1,
    }));
  }

  it('is measured alone, once it is on the screen', async () => {
    const on = viewerOn(GPU);
    measureSwitchedOn(on.store, on.measurement, 'fog');
    on.store.setState({ notice: null });
    expect(measured).toHaveLength(0);
    draw(on, true);
    await expect.poll(() => measured).toMatchObject([{ names: ['fog'] }]);
    draw(on, true);
    await expect.poll(() => on.store.getState().effectCosts).not.toBeNull();
    expect(measured.splice(0)).toHaveLength(1);
  });

  it('is waited for while it compiles, so that its cost is that of the picture on the screen', async () => {
    const { store, drawn, measurement } = viewerOn(GPU);
    drawn.isAtRest = false;
    const done = measureEffectCosts(store, measurement);
    // There is a sign at once.
    expect(store.getState().measuring).toMatchObject({ of: 'effects', label: 'Preparing' });
    await new Promise((resolve) => setTimeout(resolve));
    expect(measured).toHaveLength(0);
    drawn.isAtRest = true;
    store.setState({ imageId: 7 });
    await done;
    expect(measured.splice(0)).toHaveLength(1);
    expect(store.getState()).toMatchObject({ effectCosts: { imageId: 7 }, measuring: null });
  });

  it('is waited for until its measurement is cancelled', async () => {
    const { store, drawn, measurement } = viewerOn(GPU);
    drawn.isAtRest = false;
    const done = measureEffectCosts(store, measurement);
    measurement.stop();
    await done;
    expect(measured).toHaveLength(0);
    expect(store.getState()).toMatchObject({ measuring: null, failedMeasurement: null });
  });

  it('is not measured where it went off at once, nor where a CPU draws', async () => {
    for (const [adapter, isOn] of [
      [GPU, false],
      [SOFTWARE, true],
    ] as const) {
      const off = viewerOn(adapter);
      measureSwitchedOn(off.store, off.measurement, 'fog');
      draw(off, isOn);
      expect(off.store.getState().measuring).toBeNull();
    }
    expect(measured).toHaveLength(0);
  });
});
