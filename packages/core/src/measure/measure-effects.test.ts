import { expect, test } from 'vitest';
import { perspectiveCamera } from '../data/camera/camera.ts';
import type { SplatEngine } from '../engine.ts';
import type { EffectEntry } from '../frame/ledger/ledger.ts';
import type { FrameRequest } from '../frame/plan/frame-request.ts';
import { brightness, tint } from '../gpu/effects/index.ts';
import type { SplatView } from '../views/splat-view.ts';
import { measureEffects } from './measure-effects.ts';

/** Cost of each effect, ms; round splats are faster. */
const COSTS_MS: Readonly<Record<string, number>> = {
  harmonics: 3,
  isotropic: -2,
  tint: 0.5,
};
const FRAME_MS = 10;
/** Additional time of each frame over the one before. */
const DRIFT_MS = 0.01;
/** Additional time of each view over the one before: its buffers lie elsewhere. */
const PLACE_MS = 5;
/** Additional time of the first frame with other effects. */
const CHANGE_MS = 7;

/** An engine whose frames take the time of their effects, and more that does not depend on them. */
function fakeEngine(): SplatEngine {
  let framesDrawn = 0;
  let viewsMade = 0;
  const createView = () => {
    const placeMs = PLACE_MS * viewsMade++;
    let on: readonly string[] = [];
    const view: Partial<SplatView> = {
      onStatistics: null,
      mayBeIsotropic: true,
      render: (frame) => {
        const before = on;
        on = effectsOf(frame).filter((name) => name !== 'isotropic' || view.mayBeIsotropic);
        const effectsMs = on.reduce((sum, name) => sum + COSTS_MS[name], 0);
        const changeMs = on.join() === before.join() ? 0 : CHANGE_MS;
        const totalMs = FRAME_MS + effectsMs + placeMs + changeMs + DRIFT_MS * framesDrawn++;
        const statistics = { tilePairs: null, quadsSampleMs: null, timing: { totalMs } };
        queueMicrotask(() => view.onStatistics?.(statistics as never));
        return true;
      },
      whenDrawn: () => Promise.resolve(),
      blended: () => ({}) as never,
      effects: () =>
        [...Object.keys(COSTS_MS), 'brightness'].map((name) => {
          const entry: Partial<EffectEntry> = { name, label: name, isOn: on.includes(name) };
          return entry as EffectEntry;
        }),
      destroy: () => {},
    };
    return view;
  };
  const device = { queue: { onSubmittedWorkDone: () => Promise.resolve() } };
  return { device, lost: new Promise(() => {}), accuracy: {}, createView } as unknown as SplatEngine;
}

function effectsOf({ clouds: [{ shDegree = 3, effects = [] }] }: FrameRequest): string[] {
  return [
    ...(shDegree > 0 ? ['harmonics'] : []),
    'isotropic',
    ...effects.filter(({ reason }) => reason !== null).map(({ effect }) => effect.name),
  ];
}

test('a cost is the time with an effect less the time without it, whatever drifts, whatever a view or a change adds', async () => {
  const camera = perspectiveCamera({ position: [0, 0, 3], target: [0, 0, 0], fovYDegrees: 50, aspect: 1 });
  const clouds = [
    { cloud: { facts: {}, checkUsable: () => {} } as never, effects: [tint([1, 0, 0]), brightness(1)] },
  ];
  const frame = { camera, clouds, widthPx: 8, heightPx: 8 };
  const costs = await measureEffects(fakeEngine(), frame, { frames: 8 });
  // Brightness is requested and changes nothing.
  expect(costs.map(({ name }) => name)).toEqual(Object.keys(COSTS_MS));
  // Between the two frames of a pair, one is drawn that is not counted.
  const pairDriftMs = 2 * DRIFT_MS;
  for (const { name, costMs } of costs) {
    expect(costMs.median, name).toBeCloseTo(COSTS_MS[name], 9);
    expect(costMs.low, name).toBeCloseTo(COSTS_MS[name] - pairDriftMs, 9);
    expect(costMs.high, name).toBeCloseTo(COSTS_MS[name] + pairDriftMs, 9);
  }
  // By name, as for all; brightness changes nothing, and there is no glitter.
  const some = await measureEffects(fakeEngine(), frame, {
    frames: 8,
    names: ['tint', 'brightness', 'glitter'],
  });
  expect(some.map(({ name }) => name)).toEqual(['tint']);
});
