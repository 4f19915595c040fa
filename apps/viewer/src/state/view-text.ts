import { decodeCamera, encodeCamera } from './camera-text.ts';
import type { KeptView, SavedView } from './saved-view.ts';
import { clamp, type Vec3 } from './vec3.ts';

/** What begins the name, which is last: all that follows belongs to it. */
const NAME = ',name:';
/** Of an angle in radians: a hundredth of a pixel on a large screen. */
const ANGLE_DECIMALS = 5;
/** Of lengths, as far as the target is away. */
const LENGTH_DIGITS = 6;

/**
 * For the address, one saved view: as a camera, then its name if it has one,
 * `0,0.1,0,2.5,0.35,1.25,name:From the door`. Numbers are rounded to what can be seen, as an
 * address may have many views.
 */
export function encodeView(view: Pick<SavedView, 'name'> & KeptView): string {
  const name = view.name.trim();
  return name ? `${encodeKeptView(view)}${NAME}${name}` : encodeKeptView(view);
}

/**
 * Reads the text of `encodeView`.
 *
 * @throws InvalidArgumentError naming the part that cannot be.
 */
export function decodeView(text: string): SavedView {
  const end = text.indexOf(NAME);
  const [camera, name] = end < 0 ? [text, ''] : [text.slice(0, end), text.slice(end + NAME.length).trim()];
  return { ...decodeKeptView(camera), name, thumbnail: null };
}

/** The view alone, rounded; two views of the same text look the same. */
export function encodeKeptView(view: KeptView): string {
  const { target, distance, azimuth, polar, up } = view.pose;
  const far = Number(distance.toPrecision(LENGTH_DIGITS));
  return encodeCamera({
    ...view,
    pose: {
      target: roundedPoint(target, far),
      distance: far,
      azimuth: rounded(azimuth, ANGLE_DECIMALS),
      polar: rounded(polar, ANGLE_DECIMALS),
      up,
    },
    fovDegrees: rounded(view.fovDegrees, ANGLE_DECIMALS),
    cameraIndex: 0,
  });
}

/** Rounded to what can be seen from `distance`, in world units. */
export function roundedPoint([x, y, z]: Vec3, distance: number): Vec3 {
  const far = Number(distance.toPrecision(LENGTH_DIGITS));
  const decimals = clamp(LENGTH_DIGITS - 1 - Math.floor(Math.log10(far)), 0, 100);
  return [rounded(x, decimals), rounded(y, decimals), rounded(z, decimals)];
}

/** @throws InvalidArgumentError as `decodeCamera`. */
export function decodeKeptView(text: string): KeptView {
  const { pose, fovDegrees, isOrthographic, isFlipped, isZUp } = decodeCamera(text);
  return { pose, fovDegrees, isOrthographic, isFlipped, isZUp };
}

/** −0 is written as 0. */
function rounded(value: number, decimals: number): number {
  return Number(value.toFixed(decimals)) + 0;
}
