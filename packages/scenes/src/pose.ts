import type { SurfacePoint } from './surface-sampling.ts';

/** A rigid motion from an object's own frame into the scene: rotation (row by row), then translation in metres. */
export interface Pose {
  readonly rotation: readonly [number, number, number, number, number, number, number, number, number];
  readonly translation: readonly [number, number, number];
}

/** Turned by `yaw` about y, then tipped by `tilt` about x, then by `heading` about y again (degrees), then moved. */
export function pose(x: number, y: number, z: number, yaw = 0, tilt = 0, heading = 0): Pose {
  const [cy, sy] = cosSin(yaw);
  const [cx, sx] = cosSin(tilt);
  const [ch, sh] = cosSin(heading);
  // Ry(heading) · Rx(tilt) · Ry(yaw), multiplied out.
  return {
    rotation: [
      ch * cy - sh * cx * sy,
      sh * sx,
      ch * sy + sh * cx * cy,
      sx * sy,
      cx,
      -sx * cy,
      -sh * cy - ch * cx * sy,
      ch * sx,
      -sh * sy + ch * cx * cy,
    ],
    translation: [x, y, z],
  };
}

function cosSin(degrees: number): [number, number] {
  const radians = (degrees * Math.PI) / 180;
  return [Math.cos(radians), Math.sin(radians)];
}

/** Moves a point's position and normal; its local position stays. */
export function applyPose({ rotation: m, translation }: Pose, point: SurfacePoint): void {
  const { x, y, z, normalX, normalY, normalZ } = point;
  point.x = m[0] * x + m[1] * y + m[2] * z + translation[0];
  point.y = m[3] * x + m[4] * y + m[5] * z + translation[1];
  point.z = m[6] * x + m[7] * y + m[8] * z + translation[2];
  point.normalX = m[0] * normalX + m[1] * normalY + m[2] * normalZ;
  point.normalY = m[3] * normalX + m[4] * normalY + m[5] * normalZ;
  point.normalZ = m[6] * normalX + m[7] * normalY + m[8] * normalZ;
}
