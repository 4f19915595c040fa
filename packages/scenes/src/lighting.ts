/**
 * The light that the scene is baked under: a warm low sun behind thin cloud (a large soft key light), a sky that is
 * cool above and warm at the horizon, and the ground. Radiance is linear, with 1 about the radiance of a white
 * surface in skylight plus sun at the exposure below.
 */
import { clamp01, mix, smoothstep } from './noise.ts';

export type Rgb = readonly [red: number, green: number, blue: number];

function normalize(x: number, y: number, z: number): readonly [number, number, number] {
  const length = Math.hypot(x, y, z);
  return [x / length, y / length, z / length];
}

/** Unit vector towards the key light: from the left, somewhat in front, 35° high. */
export const KEY_DIRECTION = normalize(-0.72, 0.6, 0.42);

/** Radiance that the key light alone gives a white diffuse surface facing it. */
export const KEY_RADIANCE: Rgb = [2.65, 2.05, 1.36];

const ZENITH: Rgb = [0.13, 0.27, 0.56];
const HORIZON: Rgb = [0.86, 0.75, 0.64];
const MEADOW: Rgb = [0.17, 0.16, 0.08];
const GLOW: Rgb = [1.0, 0.62, 0.3];

/** Half-extent of the key light as seen from the scene, as sines of angles: 15° × 18°. */
const KEY_HALF_WIDTH = 0.26;
const KEY_HALF_HEIGHT = 0.31;
/** Solid angle of the key light, in steradians. */
const KEY_SOLID_ANGLE = 4 * KEY_HALF_WIDTH * KEY_HALF_HEIGHT;
/** The disc that a mirror shows: the same light concentrated into its solid angle, and its heart twice as bright. */
const KEY_DISC_GAIN = (2 * Math.PI) / KEY_SOLID_ANGLE;

const KEY_RIGHT = normalize(KEY_DIRECTION[2], 0, -KEY_DIRECTION[0]);
const KEY_UP = [
  KEY_DIRECTION[1] * KEY_RIGHT[2] - KEY_DIRECTION[2] * KEY_RIGHT[1],
  KEY_DIRECTION[2] * KEY_RIGHT[0] - KEY_DIRECTION[0] * KEY_RIGHT[2],
  KEY_DIRECTION[0] * KEY_RIGHT[1] - KEY_DIRECTION[1] * KEY_RIGHT[0],
] as const;

/** Sky and ground, without the key light's disc, in the unit direction (x, y, z); `blur` 0 (mirror) to 1 (matte). */
export function skyRadiance(x: number, y: number, z: number, blur: number, out: Float64Array): void {
  const height = clamp01(y);
  const low = (1 - height) * (1 - height);
  const horizonWeight = low * low * (1 - 0.35 * blur);
  const cosine = x * KEY_DIRECTION[0] + y * KEY_DIRECTION[1] + z * KEY_DIRECTION[2];
  // A rational lobe instead of an exponential: this is evaluated a few million times.
  const wide = 1 / (1 + 5 * (1 - cosine));
  const glow = 0.55 * wide * wide * wide;
  const edge = 0.03 + 0.3 * blur;
  const sky = smoothstep(-edge, edge, y);
  for (let channel = 0; channel < 3; channel++) {
    const above = mix(ZENITH[channel], HORIZON[channel], horizonWeight) + glow * GLOW[channel];
    out[channel] = mix(MEADOW[channel], above, sky);
  }
}

/** How much of the key light's disc a reflection along (x, y, z) sees; its gain is {@link KEY_DISC_GAIN}. */
export function keyDisc(x: number, y: number, z: number, blur: number): number {
  const facing = x * KEY_DIRECTION[0] + y * KEY_DIRECTION[1] + z * KEY_DIRECTION[2];
  if (facing <= 0) return 0;
  const across = Math.abs(x * KEY_RIGHT[0] + y * KEY_RIGHT[1] + z * KEY_RIGHT[2]);
  const up = Math.abs(x * KEY_UP[0] + y * KEY_UP[1] + z * KEY_UP[2]);
  const edge = 0.05 + 0.75 * blur * blur;
  // Spreading the disc over a larger solid angle lowers it, so that the light in it stays the same.
  const spread = KEY_SOLID_ANGLE / (4 * (KEY_HALF_WIDTH + 0.5 * edge) * (KEY_HALF_HEIGHT + 0.5 * edge));
  const width = 1 - smoothstep(KEY_HALF_WIDTH - 0.5 * edge, KEY_HALF_WIDTH + edge, across);
  const height = 1 - smoothstep(KEY_HALF_HEIGHT - 0.5 * edge, KEY_HALF_HEIGHT + edge, up);
  return KEY_DISC_GAIN * spread * width * height;
}

/** Camera exposure applied before the tone curve. */
const EXPOSURE = 0.62;

/** Linear radiance to displayed value, by table: a filmic shoulder and toe, then the sRGB transfer function. */
const DISPLAY_TABLE_SIZE = 4096;
const displayTable = makeDisplayTable();

/** The rational curve that Narkowicz fitted to the ACES film response: a toe, a shoulder, white at 1. */
function filmic(x: number): number {
  return clamp01((x * (2.51 * x + 0.03)) / (x * (2.43 * x + 0.59) + 0.14));
}

function encodeSrgb(linear: number): number {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * linear ** (1 / 2.4) - 0.055;
}

function makeDisplayTable(): Float64Array {
  const table = new Float64Array(DISPLAY_TABLE_SIZE + 2);
  for (let i = 0; i < table.length; i++) {
    // The table's argument is sqrt(x/(1+x)): dense in the darks, where the transfer function is steep.
    const t = Math.min(i / DISPLAY_TABLE_SIZE, 0.9999) ** 2;
    table[i] = encodeSrgb(filmic((EXPOSURE * t) / (1 - t)));
  }
  return table;
}

/** Radiance from which a highlight is drawn brighter than the display's white. */
const OVERSHOOT_FROM = 1.1;
/** Displayed value added per natural logarithm of radiance above it. */
const OVERSHOOT_SLOPE = 0.3;

/**
 * Factor by which a highlight's sample is raised. Harmonics of degree 3 spread a highlight over 45°, which halves its peak;
 * with this the fitted peak reaches white again, as it does in trained scenes.
 */
export function highlightOvershoot(radiance: number): number {
  return radiance > OVERSHOOT_FROM ? OVERSHOOT_SLOPE * Math.log(radiance / OVERSHOOT_FROM) : 0;
}

/** Linear radiance to a displayed (sRGB-encoded) value in [0, 1]. */
export function displayValue(radiance: number): number {
  if (radiance <= 0) return 0;
  const place = Math.sqrt(radiance / (1 + radiance)) * DISPLAY_TABLE_SIZE;
  const index = place | 0;
  return displayTable[index] + (displayTable[index + 1] - displayTable[index]) * (place - index);
}
