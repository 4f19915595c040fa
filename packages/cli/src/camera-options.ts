import type { Vec3 } from '@websplatter/core';
import { UsageError, wrongValue } from './input-error.ts';

/** `--camera` and `--up`. */
export interface CameraOptions {
  /** Path of a camera file, or `auto`: a camera is found for the scenes. */
  readonly camera: string;
  /** Up for a camera that is found; undefined: found, too. */
  readonly up: Vec3 | undefined;
}

export const AUTO = 'auto';

const AXES: Readonly<Record<string, Vec3>> = {
  x: [1, 0, 0],
  '-x': [-1, 0, 0],
  y: [0, 1, 0],
  '-y': [0, -1, 0],
  z: [0, 0, 1],
  '-z': [0, 0, -1],
};

/** @throws UsageError that names the argument. */
export function parseCameraOptions({
  camera = AUTO,
  up = AUTO,
}: {
  readonly camera?: string;
  readonly up?: string;
}): CameraOptions {
  if (up === AUTO) return { camera, up: undefined };
  if (!Object.hasOwn(AXES, up))
    throw wrongValue('--up', up, `auto or one of ${Object.keys(AXES).join(', ')}`);
  if (camera !== AUTO)
    throw new UsageError('--up', `--up is for --camera auto; ${camera} has an up of its own`);
  return { camera, up: AXES[up] };
}

/** Names a direction: an axis, or its three numbers. */
export function directionName(direction: Vec3): string {
  const axis = direction.findIndex((value) => Math.abs(value) > 0.999999);
  if (axis >= 0) return `${direction[axis] < 0 ? '-' : ''}${'xyz'[axis]}`;
  return direction.map((value) => Number(value.toFixed(3))).join(',');
}
