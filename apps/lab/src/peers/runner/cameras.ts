import { readFile } from 'node:fs/promises';
import type { SplatSet } from '@websplatter/core';
import type { SceneCamera } from '@websplatter/scenes';
import { turnedCamera } from '../turned-camera.ts';
import { BenchError } from './bench-error.ts';

type Point = SceneCamera['position'];
type Splats = Pick<SplatSet, 'count' | 'origin' | 'positions'>;

/**
 * Reads a list of cameras.
 *
 * @throws BenchError that names the file, the camera and the field.
 */
export async function readCameras(file: string): Promise<SceneCamera[]> {
  const text = await readFile(file, 'utf8').catch((error: Error) => {
    throw new BenchError(`${file}: ${error.message}`);
  });
  let json: unknown;
  try {
    json = JSON.parse(text);
  } catch (error) {
    throw new BenchError(`${file}: ${(error as Error).message}`);
  }
  return parseCameras(json, file);
}

/** @throws BenchError that names the file, the camera and the field. */
export function parseCameras(json: unknown, file: string): SceneCamera[] {
  if (!Array.isArray(json) || json.length === 0)
    throw new BenchError(`${file}: it takes a list of cameras, one at least.`);
  return json.map((camera, i) => {
    const wrong = (field: string, requirement: string) =>
      new BenchError(`${file}: ${field} of camera ${i} must be ${requirement}.`);
    const number = (field: string): number => {
      if (!Number.isFinite(camera?.[field])) throw wrong(field, 'a number');
      return camera[field];
    };
    const point = (field: string): Point => {
      const value = camera?.[field];
      if (!Array.isArray(value) || value.length !== 3 || !value.every(Number.isFinite))
        throw wrong(field, 'three numbers');
      return value as unknown as Point;
    };
    return {
      name: typeof camera?.name === 'string' ? camera.name : `camera-${i}`,
      position: point('position'),
      target: point('target'),
      up: point('up'),
      fovYDegrees: number('fovYDegrees'),
      near: number('near'),
      far: number('far'),
    };
  });
}

/** In units of the distance within which nine tenths of the splats are. */
const DISTANCE = 2;
const HEIGHT = 0.8;
const NEAR = 0.02;
const FAR = 50;
/** How many cameras stand around a scene. */
const VIEWS = 4;

/** Cameras for splats without any: y up, about the median, which few far splats do not move. */
export function camerasAround({ positions, count, origin }: Splats): SceneCamera[] {
  const target = [0, 1, 2].map((axis) => {
    const values = Float32Array.from({ length: count }, (_, i) => positions[3 * i + axis]).sort();
    return values[count >> 1];
  });
  const distances = Float32Array.from({ length: count }, (_, i) =>
    Math.hypot(...target.map((value, axis) => positions[3 * i + axis] - value)),
  ).sort();
  const reach = distances[Math.floor(0.9 * count)] || 1;
  const inWorld = (point: readonly number[]) => {
    const [x, y, z] = point.map((value, axis) => value + origin[axis]);
    return [x, y, z] as const;
  };
  const [x, y, z] = target;
  return viewsAround({
    name: 'view',
    position: inWorld([x, y + HEIGHT * reach, z + DISTANCE * reach]),
    target: inWorld(target),
    up: [0, 1, 0],
    fovYDegrees: 50,
    near: NEAR * reach,
    far: Math.max(FAR * reach, 4 * distances[count - 1]),
  });
}

/** `camera`, and others that see its target from the sides and from behind. */
export function viewsAround(camera: SceneCamera): SceneCamera[] {
  return Array.from({ length: VIEWS }, (_, view) => ({
    ...turnedCamera(camera, (2 * Math.PI * view) / VIEWS),
    name: `${camera.name}-${(360 * view) / VIEWS}`,
  }));
}
