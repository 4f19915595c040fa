import {
  multiplyQuaternions,
  type Quaternion,
  rotationByDegrees,
  rotationMatrixOf,
  type SplatTransform,
  uprightRotation,
} from '@websplatter/core/write';
import type { PartLook, Placement, ScenePartSummary } from '../../state/scene-part.ts';
import type { UpAxis } from '../../state/up-axis.ts';
import { add, scale, subtract, type Vec3 } from '../../state/vec3.ts';

/** Facts of a file that determine its default placement. */
export type PlacedFile = Pick<ScenePartSummary, 'ownUp' | 'middle'>;

/**
 * The default placement: as saved, or turned so that the file is upright where `sceneUp` points up.
 */
export function uprightPlacement({ ownUp, middle }: PlacedFile, sceneUp: UpAxis): Placement {
  const about = applied(rotationBetween(ownUp, sceneUp), middle);
  return { move: [0, 0, 0], turnDegrees: [0, 0, 0], scale: 1, about, up: ownUp, sceneUp };
}

/** A file's placement; the default placement if it has not been moved. */
export function placementOf(file: PlacedFile & Pick<ScenePartSummary, 'look'>): Placement {
  return file.look.placement ?? uprightPlacement(file, file.ownUp);
}

/** `look` with another placement; without one if the placement equals the default. */
export function placedLook(look: PartLook, placement: Placement, { ownUp }: PlacedFile): PartLook {
  const { isHidden, opacity } = look;
  if (placement.up === ownUp && isIdentity(placement)) return { isHidden, opacity, placement: null };
  return { isHidden, opacity, placement, modelMatrix: matrixOf(placement) };
}

/** `placement` with changes: the other way up, it turns about its new middle. */
export function changedPlacement(
  placement: Placement,
  change: Partial<Omit<Placement, 'about'>>,
  { middle }: PlacedFile,
): Placement {
  const changed = { ...placement, ...change };
  const isSameWayUp = changed.up === placement.up && changed.sceneUp === placement.sceneUp;
  if (isSameWayUp) return changed;
  return { ...changed, about: applied(rotationBetween(changed.up, changed.sceneUp), middle) };
}

/** Centre of a placed file's bounds, in scene coordinates. */
export function placedMiddle({ move, about }: Placement): Vec3 {
  return add(move, about);
}

/** The transform for `transformSplats`, which scales and rotates about 0, then translates. */
export function transformOf(placement: Placement): Required<SplatTransform> {
  const { move, turnDegrees, about, up, sceneUp } = placement;
  const turn = rotationByDegrees(turnDegrees);
  const rotation = multiplyQuaternions(turn, rotationBetween(up, sceneUp));
  const turned = scale(applied(turn, about), placement.scale);
  return { rotation, scale: placement.scale, translation: add(move, subtract(about, turned)) };
}

/** Column-major 4×4 matrix from the file's space to the scene's. */
export function matrixOf(placement: Placement): Float64Array {
  const { rotation, scale: by, translation } = transformOf(placement);
  const m = rotationMatrixOf(rotation).map((value) => by * value);
  return Float64Array.of(
    ...[m[0], m[1], m[2], 0],
    ...[m[3], m[4], m[5], 0],
    ...[m[6], m[7], m[8], 0],
    ...[...translation, 1],
  );
}

function isIdentity({ move, turnDegrees, scale: by, up, sceneUp }: Placement): boolean {
  const isTurned = turnDegrees.some((degrees) => degrees % 360 !== 0);
  return by === 1 && !isTurned && up === sceneUp && move.every((value) => value === 0);
}

/** The rotation that makes the axis `from` point along `to`. */
function rotationBetween(from: UpAxis, to: UpAxis): Quaternion {
  const [w, x, y, z] = uprightRotation(to);
  return multiplyQuaternions([w, -x, -y, -z], uprightRotation(from));
}

function applied(rotation: Quaternion, [x, y, z]: Vec3): Vec3 {
  const m = rotationMatrixOf(rotation);
  const row = (i: number) => m[i] * x + m[3 + i] * y + m[6 + i] * z;
  return [row(0), row(1), row(2)];
}
