import { type FileFinding, SplatFileError } from '../../../data/errors.ts';
import { shown } from '../../../data/printable.ts';
import { logitOf, tableOfBytes } from '../../../data/splats/color-values.ts';
import type { ShDegree } from '../../../data/splats/splat-set.ts';
import { JsonFields, parseJson } from '../file-json.ts';
import { UNREAD } from '../other-files.ts';
import { FLAT_LOG_SCALE } from '../rows/flat-scale.ts';

/** Most bytes of a metadata file; large streamed scenes have some millions. */
export const MAX_META_BYTES = 2 ** 26;
/** About as many named numbers as fit into this many bytes. */
const MOST_META_VALUES = 2 ** 23;

/** Decoded value of each byte, for one channel. */
export type ChannelCodebook = Float32Array;

/** Metadata of SOG, normalised over both versions. */
export interface SogMeta {
  readonly version: number;
  readonly count: number;
  /** Undefined if not stated. */
  readonly isAntialiased: boolean | undefined;
  /** Range per axis of sign(v) ln(|v| + 1). */
  readonly positions: { readonly mins: readonly number[]; readonly maxs: readonly number[] };
  /** Log scales of the three axes, by the bytes of red, green and blue. */
  readonly logScales: readonly ChannelCodebook[];
  /** Base colour by red, green and blue; opacity logit by alpha. */
  readonly colors: readonly ChannelCodebook[];
  readonly harmonics: SogHarmonics | null;
  readonly files: {
    readonly positionsLow: string;
    readonly positionsHigh: string;
    readonly rotations: string;
    readonly scales: string;
    readonly colors: string;
  };
}

export interface SogHarmonics {
  readonly values: ChannelCodebook;
  /** Undefined in version 1, where the palette image's width determines it. */
  readonly degree: ShDegree | undefined;
  /** Number of palette entries; undefined in version 1. */
  readonly paletteSize: number | undefined;
  readonly paletteFile: string;
  readonly labelsFile: string;
}

/**
 * Parses a metadata file of a SOG or of a streamed SOG.
 *
 * @param bytes the whole file; if it is too large, more than MAX_META_BYTES.
 * @throws SplatFileError 'too-large', 'bad-header'
 */
export function parseMeta(bytes: Uint8Array, file: string): unknown {
  if (bytes.length <= MAX_META_BYTES) return parseJson(bytes, file, MOST_META_VALUES);
  const message = `its metadata has more than ${MAX_META_BYTES} bytes, which no scene needs.`;
  throw new SplatFileError('too-large', file, message);
}

/**
 * Interprets the metadata of a SOG. Version 2 has a codebook per channel; version 1, which has no
 * version number, has ranges.
 *
 * @throws SplatFileError 'bad-header'; 'unknown-format' for other versions
 */
export function parseSogMeta(json: unknown, file: string): SogMeta {
  const meta = new JsonFields(json, '', file, 'metadata of SOG');
  const version = meta.get('version');
  if (version !== undefined && version !== 2) {
    const finding: FileFinding = [
      `is SOG of version ${shown(version)}`,
      'versions 1 and 2 are read. Export the scene again',
    ];
    throw new SplatFileError('unknown-format', file, finding, { property: 'version' });
  }
  const means = meta.fields('means');
  // The predecessor of SOG has fixed names for its files.
  if (version === undefined && !means.has('files') && means.has('dtype'))
    throw new SplatFileError('unknown-format', file, UNREAD.gsplatPng, { property: 'means' });
  const scales = meta.fields('scales');
  const sh0 = meta.fields('sh0');
  const shN = meta.has('shN') ? meta.fields('shN') : null;
  const [positionsLow, positionsHigh] = filesOf(means, 2);
  const common = {
    version: version ?? 1,
    positions: { mins: means.numbers('mins', 3), maxs: means.numbers('maxs', 3) },
    files: {
      positionsLow,
      positionsHigh,
      rotations: filesOf(meta.fields('quats'), 1)[0],
      scales: filesOf(scales, 1)[0],
      colors: filesOf(sh0, 1)[0],
    },
  };
  if (version === undefined) {
    return {
      ...common,
      count: shapeCount(means),
      isAntialiased: undefined,
      logScales: rangedValues(scales, 3),
      colors: rangedValues(sh0, 4),
      harmonics: shN && {
        values: valuesBetween(shN.number('mins'), shN.number('maxs')),
        degree: undefined,
        paletteSize: undefined,
        ...paletteFiles(shN),
      },
    };
  }
  const scaleValues = codebookOf(scales);
  const colorValues = codebookOf(sh0);
  return {
    ...common,
    count: meta.count('count'),
    isAntialiased: antialiasedBy(meta.get('model'), meta.get('antialias')),
    logScales: [scaleValues, scaleValues, meta.get('model') === '2dgs' ? FLAT_LOG_SCALES : scaleValues],
    colors: [colorValues, colorValues, colorValues, LOGITS],
    harmonics: shN && {
      values: codebookOf(shN),
      degree: degreeIn(shN),
      paletteSize: shN.count('count'),
      ...paletteFiles(shN),
    },
  };
}

function filesOf(fields: JsonFields, count: number): string[] {
  const names = fields.names('files');
  return names.length === count ? names : fields.fail('files', `a list of ${count} file names`);
}

/** In version 1, the shape of an array gives the number of splats. */
function shapeCount(means: JsonFields): number {
  const shape = means.get('shape');
  const count = Array.isArray(shape) ? shape[0] : undefined;
  return Number.isSafeInteger(count) && count >= 0
    ? count
    : means.fail('shape', 'a list that begins with a count');
}

/** 2DGS has no third scale: writers store an arbitrary tiny value instead. */
const FLAT_LOG_SCALES = tableOfBytes(() => FLAT_LOG_SCALE);

/** Logit of each 8-bit opacity. */
const LOGITS = tableOfBytes(logitOf);

/** Newer files have `model`, older ones `antialias`. */
function antialiasedBy(model: unknown, antialias: unknown): boolean | undefined {
  if (typeof model === 'string') return model === 'antialiased';
  return typeof antialias === 'boolean' ? antialias : undefined;
}

function paletteFiles(shN: JsonFields): Pick<SogHarmonics, 'paletteFile' | 'labelsFile'> {
  const [paletteFile, labelsFile] = filesOf(shN, 2);
  return { paletteFile, labelsFile };
}

function rangedValues(fields: JsonFields, channels: number): ChannelCodebook[] {
  const mins = fields.numbers('mins', channels);
  const maxs = fields.numbers('maxs', channels);
  return mins.map((min, channel) => valuesBetween(min, maxs[channel]));
}

function valuesBetween(min: number, max: number): ChannelCodebook {
  return Float32Array.from({ length: 256 }, (_, byte) => min + (max - min) * (byte / 255));
}

function degreeIn(shN: JsonFields): ShDegree {
  const bands = shN.count('bands');
  return bands === 1 || bands === 2 || bands === 3 ? bands : shN.fail('bands', '1, 2 or 3');
}

/** Value of each byte, from a codebook of version 2. */
function codebookOf(fields: JsonFields): ChannelCodebook {
  const values = fields.get('codebook');
  // Some writers omitted the first value; readers extrapolate it from the next ones.
  const isRight = (value: unknown, i: number) => Number.isFinite(value) || (i === 0 && value === null);
  if (!Array.isArray(values) || values.length !== 256 || !values.every(isRight))
    return fields.fail('codebook', 'a list of 256 numbers');
  const all = Float32Array.from(values);
  if (values[0] === null) all[0] = values[1] + (values[1] - values[255]) / 255;
  return all;
}
