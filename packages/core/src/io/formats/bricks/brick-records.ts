import { InvalidArgumentError } from '../../../data/errors.ts';
import { shBandReach } from '../../../data/packing/band-reach.ts';
import { centerBounds } from '../../../data/packing/center-bounds.ts';
import { trueShDegree } from '../../../data/packing/cloud-facts.ts';
import { dropNonFinite } from '../../../data/packing/drop-non-finite.ts';
import {
  type Harmonics,
  isPacked,
  isPalette,
  type PackedHarmonics,
  packCoefficients,
  readCoefficients,
  shWordsPerSplat,
} from '../../../data/packing/harmonics.ts';
import type { Bounds } from '../../../data/packing/packed-cloud.ts';
import { BLOB_PRECISION } from '../../../data/packing/precision.ts';
import {
  packHarmonics,
  packPalette,
  repackHarmonics,
  truncateHarmonics,
} from '../../../data/packing/repack-harmonics.ts';
import type { ShDegree, SplatColumns, SplatSet } from '../../../data/splats/splat-set.ts';

/**
 * Offsets in a splat's record, in 32-bit words; the words of its harmonics follow. Splats are
 * stored as records between reading and sorting.
 */
const RECORD = { position: 0, logScale: 3, colorDc: 6, rotation: 9, opacity: 13, harmonics: 14 } as const;
const { shPrecision } = BLOB_PRECISION;

/** Words of a record with packed harmonics of this degree. */
export function recordWords(degree: ShDegree): number {
  return RECORD.harmonics + shWordsPerSplat(degree, shPrecision);
}

/** The layout shared by records of splats that were read together. */
export interface RecordRun {
  readonly count: number;
  /** Words per record. */
  readonly words: number;
  /** Origin to which their positions are relative. */
  readonly origin: SplatColumns['origin'];
  /** Packing of their harmonics; the final brick packing if their degree is certain to be kept. */
  readonly harmonics: Omit<PackedHarmonics, 'words'>;
}

export interface Records {
  readonly run: RecordRun;
  readonly words: Uint32Array<ArrayBuffer>;
}

/**
 * Makes records of splats.
 *
 * @throws InvalidArgumentError 'set' if some are not finite.
 */
export function recordsOf(set: SplatSet<Harmonics>): Records & { readonly bounds: Bounds } {
  const { count, origin, positions } = set;
  const finite = dropNonFinite(set).count;
  if (finite < count) {
    const message = `${count - finite} of ${count} splats have values that are not finite. Leave them out.`;
    throw new InvalidArgumentError('set', message);
  }
  const bandReach = shBandReach(set.harmonics, count);
  const own = { ...ownHarmonics(set.harmonics, count), bandReach };
  // Other splats decide whether bands that are invisible here are kept or left out.
  const isCertain = trueShDegree(bandReach) === own.degree;
  const { words: shWords, ...harmonics } = isCertain ? repackHarmonics(own, count, shPrecision) : own;
  const width = RECORD.harmonics + harmonics.wordsPerSplat;
  const words = new Uint32Array(count * width);
  const floats = new Float32Array(words.buffer);
  for (let i = 0; i < count; i++) {
    const at = i * width;
    for (let axis = 0; axis < 3; axis++) {
      floats[at + RECORD.position + axis] = positions[3 * i + axis];
      floats[at + RECORD.logScale + axis] = set.logScales[3 * i + axis];
      floats[at + RECORD.colorDc + axis] = set.colorDc[3 * i + axis];
    }
    for (let k = 0; k < 4; k++) floats[at + RECORD.rotation + k] = set.rotations[4 * i + k];
    floats[at + RECORD.opacity] = set.opacityLogits[i];
    for (let k = 0; k < harmonics.wordsPerSplat; k++)
      words[at + RECORD.harmonics + k] = shWords[i * harmonics.wordsPerSplat + k];
  }
  const run = { count, words: width, origin, harmonics };
  return { run, words, bounds: centerBounds(positions, count) };
}

/** Harmonics with separate coefficients for every splat; a palette is expanded. */
function ownHarmonics(harmonics: Harmonics, count: number): PackedHarmonics {
  if (isPacked(harmonics)) return harmonics;
  if (!isPalette(harmonics)) return packHarmonics(harmonics);
  const { degree } = harmonics;
  const palette = packPalette(harmonics, degree);
  const wordsPerSplat = shWordsPerSplat(degree, 'f32');
  const words = new Uint32Array(count * wordsPerSplat);
  const values = new Float32Array(wordsPerSplat);
  for (let i = 0; i < count; i++) {
    readCoefficients(palette, i, values);
    packCoefficients(degree, 'f32', values, words, i * wordsPerSplat);
  }
  return { degree, precision: 'f32', wordsPerSplat, words };
}

/** Facts about all splats, needed to convert the records of a run to their final form. */
export interface RecordFacts {
  readonly origin: SplatColumns['origin'];
  readonly degree: ShDegree;
}

/**
 * A coordinate moved to another origin, rounded to float32 as readers do; unchanged if the origins
 * are equal.
 */
export function movedCoordinate(value: number, from: number, to: number): number {
  if (from === to) return value;
  // −0 would become +0 if 0 were added.
  return Math.fround((from === 0 ? value : value + from) - to);
}

/**
 * Joins records of the same layout, in order; a single run that already has it is returned without
 * a copy.
 */
export function joinRecords(parts: readonly Records[], facts: RecordFacts): Uint32Array<ArrayBuffer> {
  const { degree, origin } = facts;
  const words = recordWords(degree);
  const isDone = ({ run }: Records) =>
    run.words === words &&
    run.harmonics.precision === shPrecision &&
    run.harmonics.degree === degree &&
    run.origin.every((value, axis) => value === origin[axis]);
  if (parts.length === 1 && isDone(parts[0])) return parts[0].words;
  const joined = new Uint32Array(parts.reduce((sum, { run }) => sum + run.count, 0) * words);
  const floats = new Float32Array(joined.buffer);
  let at = 0;
  for (const part of parts) {
    const { run } = part;
    if (isDone(part)) joined.set(part.words, at);
    else {
      const harmonics = harmonicsOf(part, degree);
      for (let i = 0; i < run.count; i++) {
        const from = i * run.words;
        const to = at + i * words;
        for (let k = 0; k < RECORD.harmonics; k++) joined[to + k] = part.words[from + k];
        for (let axis = 0; axis < 3; axis++)
          floats[to + axis] = movedCoordinate(floats[to + axis], run.origin[axis], origin[axis]);
        // Bands that this run lacks stay 0.
        for (let k = 0; k < harmonics.wordsPerSplat; k++)
          joined[to + RECORD.harmonics + k] = harmonics.words[i * harmonics.wordsPerSplat + k];
      }
    }
    at += run.count * words;
  }
  return joined;
}

/** Harmonics of a run, up to this degree, packed for bricks. */
function harmonicsOf({ run, words }: Records, degree: ShDegree): PackedHarmonics {
  const { wordsPerSplat } = run.harmonics;
  const own = new Uint32Array(run.count * wordsPerSplat);
  for (let i = 0; i < run.count; i++)
    for (let k = 0; k < wordsPerSplat; k++)
      own[i * wordsPerSplat + k] = words[i * run.words + RECORD.harmonics + k];
  const kept = truncateHarmonics({ ...run.harmonics, words: own }, run.count, degree);
  return repackHarmonics(kept, run.count, shPrecision);
}

/** Decodes splats from records of the same layout, in the given order. */
export function splatsOfRecords(
  records: Uint32Array<ArrayBuffer>,
  order: Uint32Array,
  { degree, origin }: RecordFacts,
): SplatSet<PackedHarmonics> {
  const count = order.length;
  const words = recordWords(degree);
  const floats = new Float32Array(records.buffer, records.byteOffset, records.length);
  const column = (place: number, width: number) => {
    const values = new Float32Array(count * width);
    for (let i = 0; i < count; i++)
      for (let k = 0; k < width; k++) values[i * width + k] = floats[order[i] * words + place + k];
    return values;
  };
  const wordsPerSplat = words - RECORD.harmonics;
  const shWords = new Uint32Array(count * wordsPerSplat);
  for (let i = 0; i < count; i++)
    for (let k = 0; k < wordsPerSplat; k++)
      shWords[i * wordsPerSplat + k] = records[order[i] * words + RECORD.harmonics + k];
  return {
    count,
    origin,
    positions: column(RECORD.position, 3),
    logScales: column(RECORD.logScale, 3),
    rotations: column(RECORD.rotation, 4),
    opacityLogits: column(RECORD.opacity, 1),
    colorDc: column(RECORD.colorDc, 3),
    harmonics: { degree, precision: shPrecision, wordsPerSplat, words: shWords },
    fileIndices: new Uint32Array(0),
    dropped: {},
  };
}
