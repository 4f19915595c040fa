import { InvalidArgumentError } from '../../../data/errors.ts';
import { entryCountOf, type Harmonics, isPalette } from '../../../data/packing/harmonics.ts';
import { type HarmonicsPalette, MAX_PALETTE_ENTRIES } from '../../../data/packing/harmonics-palette.ts';
import { clampLogScale } from '../../../data/packing/log-scale.ts';
import { mortonOrderInTurns } from '../../../data/packing/morton-order.ts';
import { largestComponent, normalizedRotation } from '../../../data/packing/rotation.ts';
import { ROWS_AT_ONCE } from '../../../data/packing/split-rows.ts';
import { opacityOf } from '../../../data/splats/color-values.ts';
import { coefficientsPerSplat, SH_REST_COEFFICIENTS, type SplatSet } from '../../../data/splats/splat-set.ts';
import { Turns } from '../../../data/turns.ts';
import { encodeVp8l, MAX_SIDE_PX } from '../../containers/write-vp8l.ts';
import { zipFiles } from '../../containers/write-zip.ts';
import { medianSizeOf, type RoundingAdvice, RoundingMeter } from '../rows/rounding-meter.ts';
import { partOfProgress, type WriteFormat } from '../write-format.ts';
import { clusterHarmonics } from './cluster-harmonics.ts';
import { type Codebook, findCodebook } from './codebook.ts';
import { FIRST_MODE, PALETTE_COLUMNS, POSITION_STEPS } from './sog-layout.ts';

/** Image sides are multiples of 4 pixels, the block size of GPU texture compression. */
const SIDE_UNIT_PX = 4;
const ADVICE: RoundingAdvice = {
  title: 'SOG',
  positions: 'Crop splats far outside of the others, move the scene to 0, or write PLY or glTF',
};
/** Progress when the palette, the codebooks and the order are found. */
const PROGRESS = { palette: 0.7, codebooks: 0.78, order: 0.8 } as const;

/**
 * Writes SOG, version 2, as a zip archive of images, in Morton order of the centres. Equal sets
 * give equal bytes.
 *
 * Rounding:
 * - positions: 65,536 steps of sign(v) ln(|v| + 1) per axis
 * - rotation components: 255 steps from −√½ to √½
 * - opacities: 255 steps
 * - log scales and base colours: codebooks of 256 values
 * - harmonics: a palette of at most 65,536 entries, whose coefficients share a codebook of 256
 *   values
 *
 * Rejects with InvalidArgumentError 'set' if there are no splats, more than 2²⁸, or any that is not
 * finite. A log scale of −∞ is accepted and means flat.
 */
export const write: WriteFormat = async (set, { signal, onProgress, onNote }) => {
  const turns = new Turns(signal);
  const { count } = set;
  const { width, height } = sizeOf(count);
  await checkFinite(set, turns);
  const palette = await paletteOf(set, turns, {
    signal,
    onProgress: (fraction) => onProgress?.(PROGRESS.palette * fraction),
  });
  onProgress?.(PROGRESS.palette);
  const scales = await findCodebook(set.logScales.subarray(0, 3 * count).map(clampLogScale), turns);
  const colors = await findCodebook(set.colorDc.slice(0, 3 * count), turns);
  const coefficients = palette && (await findCodebook(palette.entries.slice(), turns));
  onProgress?.(PROGRESS.codebooks);

  const { onProgress: onOrdering } = partOfProgress({ onProgress }, PROGRESS.codebooks, PROGRESS.order);
  const order = await mortonOrderInTurns(set.positions, count, turns, onOrdering);
  const { mins, maxs } = await rangeOf(set, turns);
  const meter = new RoundingMeter(medianSizeOf(set));
  /** Splats whose coefficients are written otherwise than with an entry of their own. */
  let sharing = 0;
  for (let i = 0; i < count; i++) {
    if (i % ROWS_AT_ONCE === 0) await turns.give();
    let step = 0;
    for (let axis = 0; axis < 3; axis++) {
      const value = Math.abs(set.positions[3 * i + axis] + set.origin[axis]);
      step = Math.max(step, ((1 + value) * (maxs[axis] - mins[axis])) / POSITION_STEPS);
    }
    meter.position(set, i, step);
    meter.float32Position(set, i);
    meter.scales(set, i, (axis) => scales.rounded(set.logScales[3 * i + axis]));
    meter.color(set, i, (k) => colors.rounded(set.colorDc[3 * i + k]));
    if (palette && coefficients) {
      const entry = palette.indices[i] * coefficientsPerSplat(palette.degree);
      let isOwn = true;
      meter.harmonics(set, i, (value, k) => {
        const written = coefficients.rounded(palette.entries[entry + k]);
        isOwn &&= palette === set.harmonics || written === coefficients.rounded(value);
        return written;
      });
      if (!isOwn) sharing++;
    }
  }
  if (sharing > 0) {
    const found = `${sharing.toLocaleString('en')} of ${count.toLocaleString('en')} splats share sets of harmonics that differ from theirs`;
    onNote?.(
      `${found}: SOG has ${MAX_PALETTE_ENTRIES.toLocaleString('en')} sets at most. Write PLY or glTF to keep all`,
    );
  }
  for (const note of meter.notes(ADVICE)) onNote?.(note);
  const images: Record<string, Uint8Array> = {};
  const imageCount = palette ? 7 : 5;
  const addImage = async (name: string, pixels: Uint8Array, imageWidth = width, imageHeight = height) => {
    images[name] = await encodeWebp(imageWidth, imageHeight, pixels, turns);
    const done = Object.keys(images).length / imageCount;
    onProgress?.(PROGRESS.order + (1 - PROGRESS.order) * done);
    return name;
  };
  /** Adds an image with a pixel per splat. */
  const addSplats = async (name: string, put: (splat: number, pixels: Uint8Array, at: number) => void) => {
    const pixels = new Uint8Array(4 * width * height).fill(255);
    for (let i = 0; i < count; i++) {
      put(order[i], pixels, 4 * i);
      if (i % ROWS_AT_ONCE === 0) await turns.give();
    }
    // Padding pixels repeat the last splat, which compresses to nothing.
    for (let at = 4 * count; at < pixels.length; at++) pixels[at] = pixels[at - 4];
    return addImage(name, pixels);
  };

  const stepOf = (splat: number, axis: number) => {
    const range = maxs[axis] - mins[axis];
    if (range === 0) return 0;
    return Math.round((POSITION_STEPS * (coordinateOf(set, splat, axis) - mins[axis])) / range);
  };
  const meansFiles = [
    await addSplats('means_l.webp', (splat, pixels, at) => {
      for (let axis = 0; axis < 3; axis++) pixels[at + axis] = stepOf(splat, axis) & 255;
    }),
    await addSplats('means_u.webp', (splat, pixels, at) => {
      for (let axis = 0; axis < 3; axis++) pixels[at + axis] = stepOf(splat, axis) >> 8;
    }),
  ];
  const rotation = new Float64Array(4);
  const quatsFiles = [
    await addSplats('quats.webp', (splat, pixels, at) => {
      normalizedRotation(set.rotations, 4 * splat, rotation);
      putRotation(rotation, pixels, at);
    }),
  ];
  const scalesFiles = [
    await addSplats('scales.webp', (splat, pixels, at) => {
      for (let axis = 0; axis < 3; axis++)
        pixels[at + axis] = scales.nearest(clampLogScale(set.logScales[3 * splat + axis]));
    }),
  ];
  const sh0Files = [
    await addSplats('sh0.webp', (splat, pixels, at) => {
      for (let channel = 0; channel < 3; channel++)
        pixels[at + channel] = colors.nearest(set.colorDc[3 * splat + channel]);
      pixels[at + 3] = Math.round(255 * opacityOf(set.opacityLogits[splat]));
    }),
  ];
  const meta = {
    version: 2,
    asset: { generator: 'WebSplatter' },
    count,
    ...(set.isAntialiased !== undefined && { model: set.isAntialiased ? 'antialiased' : 'default' }),
    means: { mins, maxs, files: meansFiles },
    scales: { codebook: listOf(scales), files: scalesFiles },
    quats: { files: quatsFiles },
    sh0: { codebook: listOf(colors), files: sh0Files },
    ...(palette &&
      coefficients && {
        shN: {
          count: entryCountOf(palette),
          bands: palette.degree,
          codebook: listOf(coefficients),
          files: [
            await addPalette(palette, coefficients, addImage, turns),
            await addSplats('shN_labels.webp', (splat, pixels, at) => {
              pixels[at] = palette.indices[splat] & 255;
              pixels[at + 1] = palette.indices[splat] >> 8;
              pixels[at + 2] = 0;
            }),
          ],
        },
      }),
  };
  return zipFiles({ 'meta.json': new TextEncoder().encode(JSON.stringify(meta)), ...images });
};

/** Dimensions of images with a pixel per splat. */
function sizeOf(count: number): { width: number; height: number } {
  if (count === 0) throw new InvalidArgumentError('set', 'There are no splats to write.');
  const rounded = (size: number) => SIDE_UNIT_PX * Math.ceil(size / SIDE_UNIT_PX);
  const width = rounded(Math.sqrt(count));
  if (width > MAX_SIDE_PX) {
    const message = `There are ${count} splats; a SOG has at most ${MAX_SIDE_PX ** 2}. Crop the scene, or write another format.`;
    throw new InvalidArgumentError('set', message);
  }
  return { width, height: rounded(count / width) };
}

/** Rejects with InvalidArgumentError, and with the reason of the turns' signal. */
async function checkFinite(
  { count, origin, positions, logScales, colorDc, rotations }: SplatSet<Harmonics>,
  turns: Turns,
): Promise<void> {
  const check = async (values: ArrayLike<number>, width: number, what: string) => {
    for (let i = 0; i < width * count; i++) {
      if (i % ROWS_AT_ONCE === 0) await turns.give();
      // A flat splat has a log scale of −Infinity.
      if (Number.isFinite(values[i]) || (values === logScales && values[i] === Number.NEGATIVE_INFINITY))
        continue;
      const message = `Splat ${Math.floor(i / width)} has a ${what} that is not finite (${values[i]}). Leave it out.`;
      throw new InvalidArgumentError('set', message);
    }
  };
  if (!origin.every(Number.isFinite)) throw new InvalidArgumentError('set', 'Its origin is not finite.');
  await check(positions, 3, 'position');
  await check(logScales, 3, 'scale');
  await check(rotations, 4, 'rotation');
  await check(colorDc, 3, 'colour');
}

/** The set's own palette, or a new one, in which each splat has an entry of its own if there is room. */
async function paletteOf(
  { harmonics, count }: SplatSet<Harmonics>,
  turns: Turns,
  options: { signal?: AbortSignal; onProgress: (fraction: number) => void },
): Promise<HarmonicsPalette | null> {
  await turns.give();
  if (harmonics.degree === 0) return null;
  if (isPalette(harmonics)) return harmonics;
  const entryCount = Math.min(MAX_PALETTE_ENTRIES, count);
  return clusterHarmonics(harmonics, count, { ...options, entryCount });
}

async function addPalette(
  palette: HarmonicsPalette,
  codebook: Codebook,
  addImage: (name: string, pixels: Uint8Array, width: number, height: number) => Promise<string>,
  turns: Turns,
): Promise<string> {
  const width = PALETTE_COLUMNS * SH_REST_COEFFICIENTS[palette.degree];
  const height = Math.ceil(entryCountOf(palette) / PALETTE_COLUMNS);
  const pixels = new Uint8Array(4 * width * height).fill(255);
  const { entries } = palette;
  for (let i = 0; i < entries.length; i++) {
    pixels[4 * Math.floor(i / 3) + (i % 3)] = codebook.nearest(entries[i]);
    if (i % ROWS_AT_ONCE === 0) await turns.give();
  }
  return addImage('shN_centroids.webp', pixels, width, height);
}

/** A coordinate as stored: sign(v) ln(|v| + 1). */
function coordinateOf({ positions, origin }: SplatSet<Harmonics>, splat: number, axis: number): number {
  const value = positions[3 * splat + axis] + origin[axis];
  return Math.sign(value) * Math.log1p(Math.abs(value));
}

/** Least and largest stored coordinate per axis. */
async function rangeOf(set: SplatSet<Harmonics>, turns: Turns): Promise<{ mins: number[]; maxs: number[] }> {
  const mins = [0, 1, 2].map((axis) => coordinateOf(set, 0, axis));
  const maxs = [...mins];
  for (let i = 1; i < set.count; i++) {
    if (i % ROWS_AT_ONCE === 0) await turns.give();
    for (let axis = 0; axis < 3; axis++) {
      const value = coordinateOf(set, i, axis);
      if (value < mins[axis]) mins[axis] = value;
      if (value > maxs[axis]) maxs[axis] = value;
    }
  }
  return { mins, maxs };
}

/**
 * Stores three components of a unit quaternion, and the index of the omitted largest one, made
 * positive.
 */
function putRotation(rotation: Float64Array, pixels: Uint8Array, at: number): void {
  const largest = largestComponent(rotation);
  const sign = rotation[largest] < 0 ? -1 : 1;
  let to = at;
  for (let k = 0; k < 4; k++) {
    if (k === largest) continue;
    pixels[to++] = Math.max(0, Math.min(255, Math.round(255 * ((sign * rotation[k]) / Math.SQRT2 + 0.5))));
  }
  pixels[at + 3] = FIRST_MODE + largest;
}

/** Nine digits distinguish all float32 numbers. */
function listOf({ values }: Codebook): number[] {
  return Array.from(values, (value) => Number(value.toPrecision(9)));
}

const HEADER_BYTES = 20;

/** Writes a lossless WebP file (RFC 9649); see `encodeVp8l`. */
export async function encodeWebp(
  width: number,
  height: number,
  rgba: Uint8Array,
  turns: Turns,
): Promise<Uint8Array<ArrayBuffer>> {
  const image = await encodeVp8l(width, height, rgba, turns);
  // Chunks begin at even offsets.
  const bytes = new Uint8Array(HEADER_BYTES + image.length + (image.length & 1));
  const view = new DataView(bytes.buffer);
  bytes.set(new TextEncoder().encode('RIFF'), 0);
  view.setUint32(4, bytes.length - 8, true);
  bytes.set(new TextEncoder().encode('WEBPVP8L'), 8);
  view.setUint32(16, image.length, true);
  bytes.set(image, HEADER_BYTES);
  return bytes;
}
