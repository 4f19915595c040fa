import { NO_ROW, type SplatCells } from '../../../data/bricks/leaf-scene.ts';
import { SplatFileError } from '../../../data/errors.ts';
import type { Vec3 } from '../../../data/math/mat4.ts';
import { packCoefficients, shWordsPerSplat } from '../../../data/packing/harmonics.ts';
import type { Bounds } from '../../../data/packing/packed-cloud.ts';
import { ROW_SLOT, reasonToDrop } from '../../../data/splats/splat-row.ts';
import { coefficientsPerSplat, type ShDegree } from '../../../data/splats/splat-set.ts';
import type { Turns } from '../../../data/turns.ts';
import { folderOf } from '../../sources/inner-path.ts';
import { LastResults } from '../last-results.ts';
import { LEFT_OUT, packPieces } from '../rows/pack-pieces.ts';
import type { Run } from './scene-tree.ts';
import { ImageBudget, openSogImages } from './sog-images.ts';
import type { SogMeta } from './sog-meta.ts';
import { labelsOf, type SogUnit } from './sog-palette.ts';
import { geometryOf } from './sog-rows.ts';

/**
 * Tolerance for centres outside of their leaf's bounds, relative to 1 + the distance from the
 * origin. Files round logarithms of coordinates to 16 bits.
 */
const POSITION_ROUNDING = 1e-3;
/** Decoded files that a worker keeps, bytes: two of half a million splats. */
const KEPT_BYTES = 40 << 20;

/** A fetched file of a streamed scene, with what a worker needs to pack its splats. Can be posted. */
export interface SogFile {
  /** Tells files apart, in all scenes of a thread. */
  readonly key: number;
  /** Path of its metadata, relative to the scene's folder. */
  readonly path: string;
  readonly meta: SogMeta;
  /** By path, relative to the scene's folder. */
  readonly images: ReadonlyMap<string, Blob>;
  /** Highest degree of harmonics for which there is room. */
  readonly shDegree: ShDegree;
  /** Origin of the scene, to which leaf bounds and cell positions are relative. */
  readonly origin: Vec3;
  /** See `ReadLimits`; undefined for the default. */
  readonly maxBytes: number | undefined;
}

/** One level of a leaf. */
export interface SogLeaf {
  readonly run: Run;
  /** Null if unknown. */
  readonly bounds: Bounds | null;
  /** Row of the first splat in a load of the finest levels; null for coarser levels. */
  readonly firstRow: number | null;
}

/**
 * Packs the splats of some leaves of a file. The file's images are decoded for its first leaves, and
 * kept for a while.
 *
 * Rejects with SplatFileError for a damaged file, and with the reason of the turns' signal.
 */
export async function packSogLeaves(
  { file, leaves }: { readonly file: SogFile; readonly leaves: readonly SogLeaf[] },
  turns: Turns,
): Promise<SplatCells[][]> {
  const splats = await DECODED.get(file.key, () => decodedSog(file, turns));
  const packed: SplatCells[][] = [];
  for (const leaf of leaves) packed.push(await packLeaf(file, leaf, splats, turns));
  return packed;
}

function packLeaf(
  { path, shDegree, origin }: SogFile,
  { run, bounds, firstRow }: SogLeaf,
  splats: DecodedSog,
  turns: Turns,
): Promise<SplatCells[]> {
  const row = new Float32Array(ROW_SLOT.harmonics);
  const fill = (i: number, words: Uint32Array, wordOffset: number) => {
    const splat = run.offset + i;
    splats.putGeometry(row, 0, splat);
    if (bounds && !isWithin(row, bounds, origin) && reasonToDrop(row) === undefined) {
      const message = 'a splat lies outside of its part of the scene. Export the scene again.';
      throw new SplatFileError('damaged', path, message, { row: splat });
    }
    if (!splats.putHarmonics(splat, words, wordOffset)) return LEFT_OUT;
    return firstRow === null ? NO_ROW : firstRow + i;
  };
  return packPieces(run.count, shDegree, row, fill, turns);
}

/** A decoded file. */
interface DecodedSog {
  readonly putGeometry: ReturnType<typeof geometryOf>;
  readonly putHarmonics: PutHarmonics;
  /** Of its images. */
  readonly bytes: number;
}

const DECODED = new LastResults<DecodedSog>(KEPT_BYTES, ({ bytes }) => bytes);

async function decodedSog({ path, meta, images, ...file }: SogFile, turns: Turns): Promise<DecodedSog> {
  const parts = {
    readUnchecked: async (image: string) => ({
      bytes: new Uint8Array(await images.get(image)!.arrayBuffer()),
      check: async () => {},
    }),
    pause: () => turns.give(),
  };
  const budget = new ImageBudget(file.maxBytes ?? Number.POSITIVE_INFINITY);
  const { shDegree, decoded } = await openSogImages(parts, folderOf(path), meta, budget);
  if (shDegree > file.shDegree) {
    const message = `its harmonics have degree ${shDegree}, those of the finest level ${file.shDegree}. Export the scene again.`;
    throw new SplatFileError('damaged', path, message);
  }
  const unit = { file: path, meta, images: await decoded };
  const { harmonics, ...others } = unit.images;
  const pixels = [...Object.values(others), ...(harmonics ? [harmonics.labels, harmonics.palette] : [])];
  return {
    putGeometry: geometryOf(unit, file.origin),
    putHarmonics: packedHarmonics(unit, file.shDegree),
    bytes: pixels.reduce((sum, { byteLength }) => sum + byteLength, 0),
  };
}

/** Writes the packed harmonics of a splat into words that are 0. False if they are not finite. */
type PutHarmonics = (splat: number, words: Uint32Array, wordOffset: number) => boolean;

/**
 * Packs each entry of the palette once, when a splat first needs it: packing the harmonics of every
 * splat would take most of a leaf's time.
 */
function packedHarmonics(unit: SogUnit, shDegree: ShDegree): PutHarmonics {
  const { harmonics } = unit.images;
  if (!harmonics) return () => true;
  const labels = labelsOf(unit);
  const { values } = unit.meta.harmonics!;
  const { palette, size } = harmonics;
  const ownPixels = coefficientsPerSplat(harmonics.degree) / 3;
  // Bands that the file lacks stay 0.
  const coefficients = new Float32Array(coefficientsPerSplat(shDegree));
  const wordCount = shWordsPerSplat(shDegree, 'u8');
  const packed = new Uint32Array(size * wordCount);
  const isPacked = new Uint8Array(size);
  const isDrawable = new Uint8Array(size);
  return (splat, words, wordOffset) => {
    const entry = labels[splat];
    if (isPacked[entry] === 0) {
      isPacked[entry] = 1;
      for (let pixel = 0; pixel < ownPixels; pixel++) {
        const at = 4 * (entry * ownPixels + pixel);
        for (let channel = 0; channel < 3; channel++)
          coefficients[3 * pixel + channel] = values[palette[at + channel]];
      }
      isDrawable[entry] = Number(coefficients.every(Number.isFinite));
      if (isDrawable[entry] === 1) packCoefficients(shDegree, 'u8', coefficients, packed, entry * wordCount);
    }
    for (let k = 0; k < wordCount; k++) words[wordOffset + k] = packed[entry * wordCount + k];
    return isDrawable[entry] === 1;
  };
}

/** Whether the centre of a row lies within bounds, with a tolerance. Both are relative to `origin`. */
function isWithin(row: Float32Array, { min, max }: Bounds, origin: Vec3): boolean {
  for (let axis = 0; axis < 3; axis++) {
    const value = row[ROW_SLOT.position + axis];
    const slack = POSITION_ROUNDING * (1 + Math.abs(value + origin[axis]));
    if (value < min[axis] - slack || value > max[axis] + slack) return false;
  }
  return true;
}
