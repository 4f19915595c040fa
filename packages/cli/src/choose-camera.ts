import type { Camera, FrameSceneOptions, SceneFraming, Vec3 } from '@websplatter/core';
import { parseCamera, readCameraFile } from './camera-file.ts';
import { UsageError } from './input-error.ts';
import { AUTO, type CameraOptions } from './options.ts';

/** A camera that was found, as a camera file has it. */
export interface FoundCamera {
  readonly position: Vec3;
  readonly target: Vec3;
  readonly up: Vec3;
  readonly fovYDegrees: number;
  readonly near: number;
  readonly far: number;
}

/** The camera of a command. */
export interface ChosenCamera {
  readonly camera: Camera;
  /** Null for the camera of a file. */
  readonly found: FoundCamera | null;
  /** Doubts about the camera, each with advice. */
  readonly notes: readonly string[];
}

/** Frames the scenes of a command; null if no splat can be seen. */
export type FrameScenes = (options: FrameSceneOptions) => Promise<SceneFraming | null> | SceneFraming | null;

/** How a command gets its camera. */
export interface CameraChoice {
  /** Null if it is to be found. */
  readonly given: Camera | null;
  /** @throws UsageError if no splat can be seen. */
  choose(frame: FrameScenes): Promise<ChosenCamera>;
}

const FOV_Y_DEGREES = 50;
/** Less confidence is a guess: see `SceneFraming`. */
export const SURE = 0.5;
/** Near plane, as a part of the camera's distance: nothing of a subject is nearer. */
const NEAR_PART = 1 / 1000;
/** Skies are as far as a thousand times the subject's radius. */
const FAR_PART = 10_000;
/** Places are rounded to this part of the distance. */
const PLACE_DIGITS = 6;

/**
 * Reads the camera file, if there is one; the camera is found later, when the scenes have been read.
 *
 * @param aspect width of the image divided by its height.
 */
export async function prepareCamera({ camera, up }: CameraOptions, aspect: number): Promise<CameraChoice> {
  if (camera !== AUTO) {
    const given = await readCameraFile(camera, aspect);
    return { given, choose: async () => ({ camera: given, found: null, notes: [] }) };
  }
  return {
    given: null,
    choose: async (frame) => {
      const framing = await frame({ aspect, fovYDegrees: FOV_Y_DEGREES, up });
      if (!framing) {
        const message = 'no splat can be seen, so no camera was found; give one with --camera CAM.json';
        throw new UsageError('--camera', message);
      }
      const found = foundCamera(framing);
      return { camera: parseCamera(found, '--camera auto', aspect), found, notes: notesOf(framing) };
    },
  };
}

/** The line of a report that can be saved as a camera file. */
export function cameraLine(found: FoundCamera | null): string {
  return found ? `camera: ${JSON.stringify(found)}\n` : '';
}

function foundCamera({ position, target, up, fovYDegrees, radius }: SceneFraming): FoundCamera {
  const distance = Math.hypot(...position.map((value, axis) => value - target[axis]));
  const digits = Math.min(15, Math.max(0, PLACE_DIGITS - Math.floor(Math.log10(distance))));
  const rounded = ([x, y, z]: Vec3, decimals: number): Vec3 => [
    Number(x.toFixed(decimals)),
    Number(y.toFixed(decimals)),
    Number(z.toFixed(decimals)),
  ];
  return {
    position: rounded(position, digits),
    target: rounded(target, digits),
    up: rounded(up, PLACE_DIGITS),
    fovYDegrees,
    near: Number((NEAR_PART * distance).toPrecision(2)),
    far: Number((FAR_PART * Math.max(distance, radius)).toPrecision(2)),
  };
}

function notesOf({ up, kind, confidence }: SceneFraming): string[] {
  const notes: string[] = [];
  if (confidence.up < SURE)
    notes.push(
      `it is uncertain which way is up: ${directionName(up)} was taken; --up with x, y, z, -x, -y or -z decides it`,
    );
  if (confidence.kind < SURE) {
    const looked = kind === 'enclosed' ? 'it is seen from within' : 'it is seen from outside';
    notes.push(
      `it is uncertain how the scene is best looked at: ${looked}; save the printed camera, change it and pass it with --camera`,
    );
  }
  return notes;
}

/** Names a direction: an axis, or its three numbers. */
export function directionName(direction: Vec3): string {
  const axis = direction.findIndex((value) => Math.abs(value) > 0.999999);
  if (axis >= 0) return `${direction[axis] < 0 ? '-' : ''}${'xyz'[axis]}`;
  return direction.map((value) => Number(value.toFixed(3))).join(',');
}
