import type { EffectCost } from '@websplatter/core/measure';
import { formatMs } from '@websplatter/kit/format';
import type { RestMeasurement } from '../accuracy/measure-at-rest.ts';
import type { ViewerStore } from '../state/store.ts';

/**
 * The fewest frames for a 95 % interval: a software rasterizer is a hundred times slower than a
 * GPU.
 */
const SOFTWARE_FRAMES = 6;

/** Measures the cost of each effect, or of one, for the current frame. */
export async function measureEffectCosts(
  store: ViewerStore,
  measurement: RestMeasurement,
  name?: string,
): Promise<void> {
  const { accuracy } = store.getState();
  await measurement.run('effects', async ({ engine, frame }, { image, ...options }) => {
    const { measureEffects } = await import('@websplatter/core/measure');
    const costs = await measureEffects(
      engine,
      { ...frame, accuracy },
      { ...options, ...(image.isSoftware && { frames: SOFTWARE_FRAMES }), ...(name && { names: [name] }) },
    );
    if (!options.signal.aborted) store.setState({ effectCosts: { ...image, costs, accuracy } });
  });
}

/**
 * Measures an effect's cost when it is switched on, after its first frame. Skipped on software
 * adapters, which would take seconds.
 */
export function measureSwitchedOn(store: ViewerStore, measurement: RestMeasurement, name: string): void {
  if (measurement.isOnSoftware) return;
  const measure = () => {
    stop();
    if (store.getState().requested.choices[name]?.isOn) void measureEffectCosts(store, measurement, name);
  };
  const stop = store.subscribe(({ imageId }) => imageId, measure);
}

type CostMs = EffectCost['costMs'];

/** `0.42 ms`, `−1.3 ms`, or `too small to measure here`. */
export function formatCost({ median, low, high }: CostMs): string {
  return isUncertain(low, high) ? 'too small to measure here' : `${signedMs(median)} ms`;
}

/** The cost as a sentence, with its interval. */
export function describeCost({ median, low, high }: CostMs): string {
  if (isUncertain(low, high))
    return `Too small to measure here: times of frames vary by ±${formatMs(Math.max(-low, high))} ms.`;
  const interval = `${signedMs(low)} to ${signedMs(high)} ms`;
  if (median < 0) return `Saves ${formatMs(-median)} ms of each frame (${interval}).`;
  return `Costs ${formatMs(median)} ms of each frame (${interval}).`;
}

function isUncertain(low: number, high: number): boolean {
  return low <= 0 && high >= 0;
}

function signedMs(ms: number): string {
  return ms < 0 ? `−${formatMs(-ms)}` : formatMs(ms);
}
