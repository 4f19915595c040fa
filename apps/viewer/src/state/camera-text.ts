import { InvalidArgumentError } from '@websplatter/core';
import { namedParts, numberPart } from './address-parts.ts';
import { FIRST_LOOK } from './camera.ts';
import type { LinkedCamera } from './saved-view.ts';
import type { Vec3 } from './vec3.ts';

const USUAL_UP: Vec3 = [0, 1, 0];

/** How far the length of `up` may be from 1, so that people can write addresses too. */
const UNIT_TOLERANCE = 1e-3;

const FORM =
  'write camera=x,y,z,distance,azimuth,polar, then any of up:x:y:z, fov:50, parallel:1, flipped:1, zup:1 and own:0';

/**
 * For the address: the target, the distance from it, and both angles in radians, then by name what
 * is not as usual: `0,0.1,0,2.5,0.35,1.25,fov:40,flipped:1`. Numbers are the shortest that read
 * back as the same float64, so that the same picture is drawn, bit for bit.
 */
export function encodeCamera(camera: LinkedCamera): string {
  const { pose, fovDegrees, isOrthographic, cameraIndex, isFlipped, isZUp } = camera;
  const { target, distance, azimuth, polar, up } = pose;
  const parts: (number | string)[] = [...target, distance, azimuth, polar];
  if (up.some((value, axis) => value !== USUAL_UP[axis])) parts.push(`up:${up.join(':')}`);
  if (fovDegrees !== FIRST_LOOK.fovDegrees) parts.push(`fov:${fovDegrees}`);
  if (isOrthographic) parts.push('parallel:1');
  if (isFlipped) parts.push('flipped:1');
  if (isZUp) parts.push('zup:1');
  if (cameraIndex > 0) parts.push(`own:${cameraIndex}`);
  return parts.join(',');
}

/**
 * Reads the text of `encodeCamera`.
 *
 * @throws InvalidArgumentError naming the part that cannot be, and how a camera is written.
 */
export function decodeCamera(text: string): LinkedCamera {
  const parts = text.split(',').map((part) => part.trim());
  const [x, y, z, distance, azimuth, polar] = [0, 1, 2, 3, 4, 5].map((i) => numberIn(parts[i] ?? ''));
  if (distance <= 0) throw refused(`its distance, ${distance}, is not above 0`);
  if (polar <= 0 || polar >= Math.PI)
    throw refused(`its polar angle, ${polar}, does not lie between 0 and π`);
  const named = namedParts(parts.slice(6), NAMES, refused);
  return {
    pose: { target: [x, y, z], distance, azimuth, polar, up: upIn(named.up) },
    fovDegrees: fovIn(named.fov),
    cameraIndex: indexIn(named.own),
    isOrthographic: named.parallel === '1',
    isFlipped: named.flipped === '1',
    isZUp: named.zup === '1',
  };
}

const NAMES = ['up', 'fov', 'parallel', 'flipped', 'zup', 'own'];

function upIn(text: string | undefined): Vec3 {
  if (text === undefined) return USUAL_UP;
  const [x, y, z, ...others] = text.split(':').map(numberIn);
  const up: Vec3 = [x, y, z];
  // Not a number where one is missing, which no comparison holds for.
  const isUnit = Math.abs(Math.hypot(...up) - 1) < UNIT_TOLERANCE;
  if (!isUnit || others.length > 0) throw refused(`up:${text} is no direction of length 1`);
  return up;
}

function fovIn(text: string | undefined): number {
  const degrees = text === undefined ? FIRST_LOOK.fovDegrees : numberIn(text);
  if (degrees <= 0 || degrees >= 180) throw refused(`fov:${text} does not lie between 0 and 180 degrees`);
  return degrees;
}

function indexIn(text: string | undefined): number {
  const index = text === undefined ? 0 : numberIn(text);
  if (!Number.isInteger(index) || index < 0) throw refused(`own:${text} is not a whole number from 0`);
  return index;
}

const numberIn = (text: string) => numberPart(text, refused);

function refused(why: string): InvalidArgumentError {
  return new InvalidArgumentError('camera', `The camera cannot be read: ${why}; ${FORM}.`);
}
