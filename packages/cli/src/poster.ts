import { basename } from 'node:path';
import { type Camera, cameraPosition, type Vec3 } from '@websplatter/core';
import { InputFileError } from './input-error.ts';

/** Of the two sides of a pixel, beyond which pictures of a camera of three.js look otherwise. */
const MAX_STRETCH = 1e-6;

/**
 * Returns the JSX of a `<SplatCanvas>` that begins with the view of a poster at `path`.
 *
 * @param cameraFile for messages.
 * @param aspect width of the poster divided by its height.
 * @param background sRGB, 0…1.
 * @param up about which controls are to turn the camera; default +y.
 * @throws InputFileError that names the camera's file if react-three-fiber has no such camera.
 */
export function posterJsx(
  path: string,
  camera: Camera,
  {
    cameraFile,
    aspect,
    background,
    up = [0, 1, 0],
  }: {
    readonly cameraFile: string;
    readonly aspect: number;
    readonly background: Vec3;
    readonly up?: Vec3;
  },
): string {
  const { viewMatrix: v, projectionMatrix: p, near, far } = camera;
  const isCentred = [1, 4, 8, 9].every((i) => p[i] === 0) && p[5] > 0;
  if (p[11] !== -1 || !isCentred || Math.abs((p[0] * aspect) / p[5] - 1) > MAX_STRETCH)
    throw new InputFileError(
      cameraFile,
      '--poster needs a camera with which a <SplatCanvas> can begin: in perspective, with the middle of its view in the middle of the image, and square pixels',
    );
  const position = cameraPosition(v).map((value) => Number(value.toPrecision(8)));
  const rotation = anglesOf(v).map((angle) => Number(angle.toFixed(6)));
  const fov = Number(((2 * Math.atan(1 / p[5]) * 180) / Math.PI).toFixed(6));
  const list = (values: readonly number[]) => `[${values.map((value) => value + 0).join(', ')}]`;
  const isUsualUp = up[0] === 0 && up[1] > 0 && up[2] === 0;
  const upProp = isUsualUp ? '' : `up: ${list(up)}, `;
  const props = `${upProp}position: ${list(position)}, rotation: ${list(rotation)}, fov: ${fov}, near: ${near}, far: ${far}`;
  const color = background.map((value) => Math.round(255 * value)).join(' ');
  return `<SplatCanvas poster="/${encodeURIComponent(basename(path))}" camera={{ ${props} }} style={{ background: 'rgb(${color})' }} flat>`;
}

/** three's Euler angles about x, y and z, in this order, of a camera with this view matrix. */
function anglesOf(v: ArrayLike<number>): [number, number, number] {
  // The rotation of the camera is the inverse of the view's: its row i is column i of that.
  const y = Math.asin(Math.min(1, Math.max(-1, v[2])));
  // Looking along x, turns about x and z are the same.
  if (Math.abs(v[2]) > 0.9999999) return [Math.atan2(v[9], v[5]), y, 0];
  return [Math.atan2(-v[6], v[10]), y, Math.atan2(-v[1], v[0])];
}
