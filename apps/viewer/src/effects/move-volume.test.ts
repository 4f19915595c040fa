import { perspectiveCamera } from '@websplatter/core';
import type { VolumeValues } from '@websplatter/core/effect-options';
import { describe, expect, it } from 'vitest';
import { firstValues } from '../state/effect-values.ts';
import { movedVolume, stepOfKey } from './volume-gizmo.tsx';

const camera = perspectiveCamera({
  ...{ position: [0, 0, 5], target: [0, 0, 0], up: [0, 1, 0] },
  ...{ fovYDegrees: 90, aspect: 1, near: 0.1, far: 100 },
});
const space = { camera, width: 200, height: 200 };
const place = { center: [0, 0, 0], radius: 1, viewDepth: 5 } as const;
const values = firstValues('volumes', place) as unknown as VolumeValues;

describe('a volume that is moved', () => {
  it('goes with the pointer, and away', () => {
    const sphere = { ...values, shape: 'sphere' } as const;
    expect(movedVolume(space, sphere, [20, -10, 0], 1).center).toEqual([1, 0.5, 0]);
    expect(movedVolume(space, sphere, [0, 0, 20], 1).center).toEqual([0, 0, -1]);
  });

  it('goes along the normal if it is a plane', () => {
    expect(movedVolume(space, values, [20, -10, 0], 1).center).toEqual([0, 0.5, 0]);
  });

  it('has a place that is short to write', () => {
    const sphere = { ...values, shape: 'sphere' } as const;
    expect(movedVolume(space, sphere, [1.2345, 0, 0], 1).center).toEqual([0.0615, 0, 0]);
  });

  it('is moved by keys, farther with Shift', () => {
    expect(stepOfKey('ArrowUp', false)).toEqual([0, -8, 0]);
    expect(stepOfKey('PageDown', true)).toEqual([0, 0, -40]);
    expect(stepOfKey('a', false)).toBeNull();
  });
});
