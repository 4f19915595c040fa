import { effectFunction } from '../../gpu/effects/effect.ts';
import wgsl from './motion.wgsl?raw';
import { timeIntervalOf } from './pack-motion.data.ts';
import { type TimeRange, timeWithin } from './splat-motion.data.ts';

/** Options of `motion`. */
export interface MotionOptions {
  /** Time that the scene is shown at. Outside of `range`, its first or last time. */
  readonly time: number;
  readonly range: TimeRange;
}

/**
 * Shows a moving scene at a time. Clouds whose file has a motion are drawn with it; see
 * `CloudInstance.time`.
 */
export const motion = /* @__PURE__ */ effectFunction<MotionOptions, { time: 'f32'; interval: 'u32' }>({
  name: 'motion',
  label: 'Motion',
  about: 'Shows a moving scene at a time.',
  hooks: { splat: 'moveSplat', bounds: 'moveBounds' },
  wgsl,
  fields: { time: 'f32', interval: 'u32' },
  calledFor: (options) => `its splats move, and are shown at ${Number(timeWithin(options).toFixed(3))}`,
  valuesAt(options) {
    const time = timeWithin(options);
    return { time, interval: timeIntervalOf(options.range, time) };
  },
});
