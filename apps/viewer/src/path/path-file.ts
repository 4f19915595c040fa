import { type CameraAxes, poseOfAxes } from '../camera/rotation.ts';
import type { OrbitPose } from '../state/orbit-pose.ts';
import type { Passing, SavedView } from '../state/saved-view.ts';
import { upVector } from '../state/up-axis.ts';
import { dot, subtract, type Vec3 } from '../state/vec3.ts';

/** A file of a camera path that cannot be used. */
export class PathFileError extends Error {
  override readonly name = 'PathFileError';

  /** @param fileName of the file that is at fault. */
  constructor(fileName: string, why: string) {
    super(`${fileName} has no camera path that can be read: ${why}`);
  }
}

/** The scene that a path is read for or written from. */
export interface PathScene {
  /** Whether the drawn scene is turned by half a circle around x against its file. */
  readonly isFlipped: boolean;
  /** Whether z points up in the drawn scene, not y. */
  readonly isZUp: boolean;
  /** Whether y points down in the scene's file. */
  readonly isUpsideDown: boolean;
  /** Width by height of the picture. */
  readonly aspect: number;
  /** Middle and radius of what the scene is about, as drawn. */
  readonly center: Vec3;
  readonly radius: number;
  /** Field of view of cameras that have none, degrees over the shorter side. */
  readonly fovDegrees: number;
}

/** A camera of a file at a time. */
export interface FileKey {
  readonly atMs: number;
  readonly pose: OrbitPose;
  /** Degrees over the shorter side. */
  readonly fovDegrees: number;
  readonly name?: string;
  readonly passing?: Passing;
}

/** A path as a file has it. */
export interface FilePath {
  /** At least one, by time. */
  readonly keys: readonly FileKey[];
  /** With the way from the last camera to the first if it is looped. */
  readonly durationMs: number;
  readonly isLooped: boolean;
  /** Sentences about what is not as in the file. */
  readonly notes: readonly string[];
}

/** Nearest target of a camera, in radii of the scene: closer ones could hardly be orbited. */
const LEAST_TARGET_RADII = 0.05;

/** The orbit of a camera of the drawn scene, around what lies in front of it as deep as the middle. */
export function poseInScene(position: Vec3, axes: CameraAxes, scene: PathScene): OrbitPose {
  const depth = -dot(subtract(scene.center, position), axes.back);
  const distance = depth > LEAST_TARGET_RADII * scene.radius ? depth : scene.radius;
  return poseOfAxes(position, axes, distance, upVector(scene));
}

/**
 * Saved views with the cameras of a path.
 *
 * @param most number of views; of more, some at even distances are taken.
 */
export function viewsOfPath(
  { keys, durationMs }: FilePath,
  { isFlipped, isZUp }: Pick<PathScene, 'isFlipped' | 'isZUp'>,
  { most, leastStepMs }: { readonly most: number; readonly leastStepMs: number },
): readonly SavedView[] {
  const apart: FileKey[] = [];
  // Half a millisecond less, for times that are rounded.
  for (const key of keys)
    if (key.atMs - (apart.at(-1)?.atMs ?? -Infinity) >= leastStepMs - 0.5) apart.push(key);
  const count = Math.min(most, apart.length);
  const kept = Array.from({ length: count }, (_, i) =>
    count === 1 ? apart[0] : apart[Math.round((i * (apart.length - 1)) / (count - 1))],
  );
  return kept.map(({ pose, fovDegrees, name = '', passing, atMs }, i) => ({
    ...{ pose, fovDegrees, isOrthographic: false, isFlipped, isZUp, name, thumbnail: null },
    toNextMs: Math.max(leastStepMs, Math.round((kept[i + 1]?.atMs ?? durationMs) - atMs)),
    ...(passing && { passing }),
  }));
}
