import type { SceneFraming, Vec3 } from '@websplatter/core';
import {
  AXIS_NAMES,
  multiplyQuaternions,
  type Quaternion,
  SplatFramer,
  uprightRotation,
} from '@websplatter/core/write';
import { directionName, SURE } from './choose-camera.ts';

/** Up as `convert --up auto` found it. */
export interface FoundUp {
  /** Unit vector in the axes of the scenes. */
  readonly direction: Vec3;
  /** 0…1. */
  readonly confidence: number;
}

/** The rotation that makes scenes upright, and the line that says how it was found. */
export interface Upright {
  readonly rotation: Quaternion;
  /** Null if nothing was looked for, or no splat can be seen. */
  readonly found: FoundUp | null;
  readonly notes: readonly string[];
}

/** Finds up in what `add` adds, and the rotation that turns it to +y. */
export async function findUpright(add: (framer: SplatFramer) => Promise<void>): Promise<Upright> {
  const framer = new SplatFramer();
  await add(framer);
  const framing = framer.frame();
  if (!framing) {
    const note = 'no splat can be seen that would tell which way is up; nothing was turned upright';
    return { rotation: uprightRotation('y'), found: null, notes: [note] };
  }
  const { up, confidence } = framing;
  return {
    rotation: rotationToY(up),
    found: { direction: up, confidence: confidence.up },
    notes: [noteOf(framing)],
  };
}

/** Shortest rotation from `up` to +y. A direction that points down is rotated as if from −y first. */
function rotationToY(up: Vec3): Quaternion {
  const name = directionName(up);
  if (AXIS_NAMES.includes(name)) return uprightRotation(name);
  const half = uprightRotation(up[1] < 0 ? '-y' : 'y');
  const [x, y, z] = up[1] < 0 ? [up[0], -up[1], -up[2]] : up;
  return multiplyQuaternions([1 + y, -z, 0, x], half);
}

function noteOf({ up, confidence }: SceneFraming): string {
  const sureness = `confidence ${confidence.up.toFixed(2)} of 1`;
  if (confidence.up >= SURE) return `${directionName(up)} was found to be up (${sureness})`;
  return `it is uncertain which way is up: ${directionName(up)} was taken (${sureness}); --up with x, y, z, -x, -y or -z decides it`;
}
