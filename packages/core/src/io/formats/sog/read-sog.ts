import { SplatFileError } from '../../../data/errors.ts';
import type { PackedHarmonics, ReadHarmonics } from '../../../data/packing/harmonics.ts';
import { coefficientsPerSplat, type ShDegree, type SplatSet } from '../../../data/splats/splat-set.ts';
import { folderOf } from '../../sources/inner-path.ts';
import { readAll } from '../../sources/read-all.ts';
import type { SplatFormatOptions, SplatInput } from '../read-format.ts';
import { type DecodedRows, deliverRows } from '../rows/decoded-rows.ts';
import { joinedRows } from '../rows/joined-rows.ts';
import { ReadProgress } from '../rows/progress.ts';
import type { Passed, RowsTo } from '../rows/row-sink.ts';
import { checkCount } from '../rows/splat-counts.ts';
import { SceneFileReader } from '../scene-file-reader.ts';
import { isStreamedMeta, type LeafRun, type Run, readTree, splatsOf } from './scene-tree.ts';
import {
  ImageBudget,
  imageNames,
  imagesOfRuns,
  type OpenedImages,
  openSogImages,
  type SogImages,
} from './sog-images.ts';
import { MAX_META_BYTES, parseMeta, parseSogMeta, type SogMeta } from './sog-meta.ts';
import { joinPalettes, paletteEntries, type SogUnit } from './sog-palette.ts';
import { originOfSogs, sogRows, sogRowsOfPalette } from './sog-rows.ts';

/** A SOG whose images are being decoded. */
interface OpenedUnit extends OpenedImages {
  readonly file: string;
  readonly meta: SogMeta;
}

/**
 * Reads SOG (Spatially Ordered Gaussians, by PlayCanvas), version 2 or 1: metadata in JSON, and
 * images whose pixels are the splats. For streamed SOG, it reads the finest available level of
 * every part, and the environment. If requested, harmonics stay a palette, unless the parts of a
 * streamed scene have too many entries.
 *
 * Rejects with `SplatFileError`, `SplatSourceError`, or the signal's reason.
 */
export async function read(
  input: SplatInput,
  options: SplatFormatOptions,
  rowsTo?: RowsTo,
): Promise<SplatSet<ReadHarmonics> | Passed> {
  const stop = new AbortController();
  // One failure aborts all other reads.
  const signal = options.signal ? AbortSignal.any([options.signal, stop.signal]) : stop.signal;
  try {
    const progress = new ReadProgress(input, options.onProgress);
    const { units, notes } = await openUnits(input, { ...options, signal }, progress);
    const shDegree = units.reduce<ShDegree>((most, unit) => (unit.shDegree > most ? unit.shDegree : most), 0);
    const palette = options.keepsPalette
      ? joinPalettes(await Promise.all(units.map(decodedUnit)), shDegree)
      : null;
    const rows = joinUnits(units, palette ? 0 : shDegree, notes);
    if (!palette) return await deliverRows(rows, input, options, rowsTo, progress);
    const delivered = await deliverRows(rows, input, options, undefined, progress);
    // Without a sink, the result is always a set.
    const set = delivered as SplatSet<PackedHarmonics>;
    const indices = Uint16Array.from(set.fileIndices, (row) => palette.indices[row]);
    return { ...set, harmonics: { ...palette, indices } };
  } finally {
    stop.abort();
  }
}

async function openUnits(
  input: SplatInput,
  options: SplatFormatOptions,
  progress: ReadProgress,
): Promise<{ units: OpenedUnit[]; notes: readonly string[] }> {
  const { name } = input;
  const parts = new SceneFileReader(input, options, progress);
  const json = parseMeta(await readAll(input.reader, MAX_META_BYTES + 1), name);
  const budget = new ImageBudget(options.maxBytes ?? Number.POSITIVE_INFINITY);
  const unitOf = async (
    file: string,
    folder: string,
    unitJson: unknown,
    count?: number,
  ): Promise<OpenedUnit> => {
    const meta = parseSogMeta(unitJson, file);
    if (count !== undefined && meta.count !== count) {
      const message = `it has ${meta.count} splats, where the scene says ${count}. Export the scene again.`;
      throw new SplatFileError('damaged', file, message);
    }
    checkCount(meta.count, file, options.maxSplats);
    // The number of images of a streamed scene is unknown until all its metadata has been read.
    if (unitJson === json) parts.expect(imageNames(meta).length);
    return { file, meta, ...(await openSogImages(parts, folder, meta, budget)) };
  };
  if (!isStreamedMeta(json)) return { units: [await unitOf(name, '', json)], notes: [] };
  const { files, notes } = finestLevel(json, name);
  const total = files.reduce((sum, { count = 0, runs }) => sum + (runs ? splatsOf(runs) : count), 0);
  // Checked before everything is fetched. A scene may consist of the environment alone.
  if (total > 0 || files.length === 0) checkCount(total, name, options.maxSplats);
  const units: OpenedUnit[] = [];
  for (const { path, count, runs } of files) {
    const unitJson = parseMeta(await parts.read(path), path);
    const unit = await unitOf(path, folderOf(path), unitJson, count);
    // Damage is detected before the next file is fetched.
    const images = await unit.decoded;
    units.push(runs ? unitOfRuns(unit, images, runs) : unit);
  }
  return { units, notes };
}

function unitOfRuns(unit: OpenedUnit, images: SogImages, runs: readonly Run[]): OpenedUnit {
  const meta = { ...unit.meta, count: splatsOf(runs) };
  return { ...unit, meta, decoded: Promise.resolve(imagesOfRuns(images, runs)) };
}

async function decodedUnit({ file, meta, decoded }: OpenedUnit): Promise<SogUnit> {
  return { file, meta, images: await decoded };
}

/** The splats of several SOGs, in order, once their images are decoded; see `sogRows`. */
function joinUnits(units: readonly OpenedUnit[], shDegree: ShDegree, notes: readonly string[]): DecodedRows {
  const decoded: SogUnit[] = [];
  const keepDecoded = async (unit: OpenedUnit, i: number) => {
    decoded[i] = await decodedUnit(unit);
  };
  const whenDecoded = Promise.all(units.map(keepDecoded));
  // `arrive` reports the error; this prevents an unhandled rejection.
  whenDecoded.catch(() => {});
  const origin = originOfSogs(units.map(({ meta }) => meta));
  const parts = units.map(({ meta: { count, isAntialiased } }, i) => ({
    count,
    shDegree,
    isAntialiased,
    decode: madeLater(() => sogRows(decoded[i], shDegree, origin)),
  }));
  const rows = joinedRows(parts);
  const [{ meta, paletteSize }] = units;
  // A scene with several palettes would exceed the size of one.
  const isShared = units.length === 1 && shDegree > 0 && paletteSize > 0 && paletteSize < rows.count;
  return {
    ...rows,
    // Positions near 0 keep the file's coordinates. Several files may still share an origin.
    ...(origin.some((value) => value !== 0) && { origin }),
    fileFacts: { format: 'sog', variant: String(meta.version), ...(notes.length > 0 && { notes }) },
    // The sink allocates memory while images are decoded.
    arrive: async () => {
      await whenDecoded;
    },
    ...(isShared && {
      palette: {
        entryCount: paletteSize,
        entryValues: coefficientsPerSplat(shDegree),
        values: () => paletteEntries(decoded[0]),
        decode: madeLater(() => sogRowsOfPalette(decoded[0], origin)),
      },
    }),
  };
}

/** Creates the function on its first call. */
function madeLater(make: () => DecodedRows['decode']): DecodedRows['decode'] {
  let decode: DecodedRows['decode'] | undefined;
  return (rows, rowCount) => {
    decode ??= make();
    decode(rows, rowCount);
  };
}

/** A file of a streamed scene. */
interface LevelFile {
  /** Path of its metadata, relative to the scene's folder. */
  readonly path: string;
  /** Number of splats; undefined if the scene does not state it. */
  readonly count: number | undefined;
  /** The runs to read, in order; null for all splats. */
  readonly runs: readonly Run[] | null;
}

/** Most files per level; a scene of a billion splats has fewer. */
const MOST_FILES = 4096;

/**
 * Lists the files with the finest splats of every leaf of a streamed scene, then its environment,
 * which belongs to every level. A leaf of the tree has one run of splats per level. If a leaf lacks
 * the finest level, its finest available level is read, as PlayCanvas does. All runs of a file have
 * the same level and cover the file.
 *
 * @returns the files, and notes about them for `FileFacts`.
 * @throws SplatFileError 'bad-header', 'damaged', 'too-large'; 'unknown-format' for later versions
 */
function finestLevel(json: unknown, file: string): { files: LevelFile[]; notes: string[] } {
  const { names, leaves, runsOfFile, environment } = readTree(json, file);
  const finest = new Set(leaves.map(({ runs }) => runs[0]));
  const files: LevelFile[] = [];
  for (const [index, runs] of [...runsOfFile].sort(([a], [b]) => a - b)) {
    const read = runs.filter((run) => finest.has(run));
    const path = names[index];
    if (read.length > 0)
      files.push({ path, count: splatsOf(runs), runs: read.length === runs.length ? null : read });
  }
  if (environment !== null) files.push({ path: environment, count: undefined, runs: null });
  if (files.length > MOST_FILES) {
    const message = `its finest level has ${files.length} files, more than ${MOST_FILES}. Open a part of the scene.`;
    throw new SplatFileError('too-large', file, message);
  }
  return { files, notes: notesOf([...finest]) };
}

/** Notes about parts that lack their finest level. */
function notesOf(runs: readonly LeafRun[]): string[] {
  const finest = runs.reduce((least, { level }) => Math.min(least, level), Number.POSITIVE_INFINITY);
  const coarser = runs.filter(({ level }) => level > finest).length;
  if (coarser === 0) return [];
  return [`${coarser} of ${runs.length} parts have no splats of level ${finest}; their next level is shown.`];
}
