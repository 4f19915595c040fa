import { SplatFileError } from '../../../data/errors.ts';
import type { PackedHarmonics, ReadHarmonics } from '../../../data/packing/harmonics.ts';
import { coefficientsPerSplat, type ShDegree, type SplatSet } from '../../../data/splats/splat-set.ts';
import { folderOf } from '../../sources/inner-path.ts';
import { readAll } from '../../sources/read-all.ts';
import { checkCount } from '../check-count.ts';
import { type DecodedRows, deliverRows } from '../decoded-rows.ts';
import { joinedRows } from '../joined-rows.ts';
import { PartReader } from '../part-reader.ts';
import { ReadProgress } from '../progress.ts';
import type { SplatFormatOptions, SplatInput } from '../read-format.ts';
import type { Passed, RowsTo } from '../row-sink.ts';
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
 * images beside it, whose pixels are the splats. Of streamed SOG, reads the finest level of the
 * whole scene, or of each part the finest that it has, and its environment. Harmonics stay the
 * palette that they are, if asked, unless those of a streamed scene have too many entries for one.
 *
 * Rejects with `SplatFileError`, `SplatSourceError`, or the signal's reason.
 */
export async function read(
  input: SplatInput,
  options: SplatFormatOptions,
  rowsTo?: RowsTo,
): Promise<SplatSet<ReadHarmonics> | Passed> {
  const stop = new AbortController();
  // One failure stops all other reading.
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
    // Without a sink there is always a set.
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
  const parts = new PartReader(input, options, progress);
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
    // Those of a streamed scene are known only when all of its metadata has been read.
    if (unitJson === json) parts.expect(imageNames(meta).length);
    return { file, meta, ...(await openSogImages(parts, folder, meta, budget)) };
  };
  if (!isStreamedMeta(json)) return { units: [await unitOf(name, '', json)], notes: [] };
  const { files, notes } = finestLevel(json, name);
  const total = files.reduce((sum, { count = 0, runs }) => sum + (runs ? splatsOf(runs) : count), 0);
  // Before all of it is fetched; an environment may be all there is.
  if (total > 0 || files.length === 0) checkCount(total, name, options.maxSplats);
  const units: OpenedUnit[] = [];
  for (const { path, count, runs } of files) {
    const unitJson = parseMeta(await parts.read(path), path);
    const unit = await unitOf(path, folderOf(path), unitJson, count);
    // Damage is known before the next is fetched.
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
  // Who asks for rows hears of it.
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
  // Several palettes would be too large to be one.
  const isShared = units.length === 1 && shDegree > 0 && paletteSize > 0 && paletteSize < rows.count;
  return {
    ...rows,
    // Rows near 0 are the file's own; those of several files may yet have an origin in common.
    ...(origin.some((value) => value !== 0) && { origin }),
    fileFacts: { format: 'sog', variant: String(meta.version), ...(notes.length > 0 && { notes }) },
    // The sink makes room for the rows while images are decoded.
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

/** Calls the function that `make` returns when it is first called. */
function madeLater(make: () => DecodedRows['decode']): DecodedRows['decode'] {
  let decode: DecodedRows['decode'] | undefined;
  return (rows, rowCount) => {
    decode ??= make();
    decode(rows, rowCount);
  };
}

/** A SOG of a streamed scene. */
interface LevelFile {
  /** Path of its metadata, from the folder of the scene's. */
  readonly path: string;
  /** Splats in it; undefined where the scene does not say it. */
  readonly count: number | undefined;
  /** Its runs to read, in order; null: all. */
  readonly runs: readonly Run[] | null;
}

/** Most files of a level: a scene of a billion splats has fewer. */
const MOST_FILES = 4096;

/**
 * The files that have the finest splats of each leaf of a streamed scene, which together are all of
 * it, and then its environment, which belongs to every level. A leaf of the tree has runs of splats
 * in files, one for each level; where it lacks the finest level, the next that it has is read, as
 * PlayCanvas shows it. A file has runs of one level, one behind another, and nothing else.
 *
 * @returns the files, and the notes of `FileFacts` on them.
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

/** Notes on parts that are shown otherwise than their finest level would have them. */
function notesOf(runs: readonly LeafRun[]): string[] {
  const finest = runs.reduce((least, { level }) => Math.min(least, level), Number.POSITIVE_INFINITY);
  const coarser = runs.filter(({ level }) => level > finest).length;
  if (coarser === 0) return [];
  return [`${coarser} of ${runs.length} parts have no splats of level ${finest}; their next level is shown.`];
}
