import { InvalidArgumentError, type Vec3 } from '@websplatter/core';
import { defineEffect } from '@websplatter/core/effects';
import wgsl from './wind-sway.wgsl?raw';

/** Directions and lengths are in the cloud's own space. */
export interface WindSwayOptions {
  /** Distance by which the highest splats move to either side; 0: no wind. */
  readonly amplitude: number;
  /** Time of the frame, seconds. */
  readonly timeS: number;
  /** Duration of one oscillation, seconds; default 3. */
  readonly periodS?: number;
  /** Distance from one gust to the next, along `direction`; default 1. */
  readonly waveLength?: number;
  /** Direction towards which the wind blows, of any length except 0; default: along x. */
  readonly direction?: Vec3;
  /** Upward direction, of any length except 0; default along y. */
  readonly up?: Vec3;
  /** Height of the ground; splats below it do not move; default 0. */
  readonly ground?: number;
  /** Height above the ground from which splats sway fully; default 1. */
  readonly tall?: number;
}

/** An effect defined outside of the packages: see docs/effects.md. */
export const windSway = defineEffect<
  WindSwayOptions,
  { up: 'vec3f'; upOffset: 'f32'; wave: 'vec3f'; phase: 'f32'; push: 'vec3f'; tall: 'f32' }
>({
  name: 'wind-sway',
  label: 'Wind',
  about: 'Sways splats above the ground.',
  hooks: { splat: 'swaySplat' },
  wgsl,
  fields: { up: 'vec3f', upOffset: 'f32', wave: 'vec3f', phase: 'f32', push: 'vec3f', tall: 'f32' },
  check(options) {
    for (const name of ['amplitude', 'timeS'] as const) {
      const value = options[name];
      if (!(Number.isFinite(value) && value >= 0))
        throw new InvalidArgumentError(name, `${name} is ${value}; it is finite, 0 or more.`);
    }
    for (const name of ['periodS', 'waveLength', 'tall'] as const) {
      const value = options[name] ?? 1;
      if (!(Number.isFinite(value) && value > 0))
        throw new InvalidArgumentError(name, `${name} is ${value}; it is finite and above 0.`);
    }
  },
  calledFor: ({ amplitude }) => (amplitude === 0 ? null : `a wind moves it by up to ${amplitude}`),
  // Chunks are culled by their bounds plus this displacement: no splat may sway farther.
  reach: ({ amplitude }) => ({ displacement: amplitude, growth: 1 }),
  valuesAt(options, { origin }) {
    const { amplitude, timeS, periodS = 3, waveLength = 1, ground = 0, tall = 1 } = options;
    const up = unit(options.up ?? [0, 1, 0]);
    const direction = unit(options.direction ?? [1, 0, 0]);
    const turn = 2 * Math.PI;
    const wave = scaled(direction, turn / waveLength);
    return {
      up,
      // Positions in shaders are relative to the cloud's origin. Far from 0 they need float64.
      upOffset: dot(up, origin) - ground,
      wave,
      phase: (dot(wave, origin) - (turn * timeS) / periodS) % turn,
      push: scaled(direction, amplitude),
      tall,
    };
  },
});

function dot(a: Vec3, b: Vec3): number {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

function scaled([x, y, z]: Vec3, factor: number): Vec3 {
  return [x * factor, y * factor, z * factor];
}

function unit(direction: Vec3): Vec3 {
  return scaled(direction, 1 / Math.hypot(...direction));
}
