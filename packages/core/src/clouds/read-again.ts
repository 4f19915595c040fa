import { GpuLimitError, SplatSourceError } from '../data/errors.ts';
import { CHUNK_WORDS } from '../data/layout/chunk-words.ts';
import { entryCountOf, type Harmonics, isPalette } from '../data/packing/harmonics.ts';
import { packSet } from '../data/packing/pack-set.ts';
import type { PackedCloud } from '../data/packing/packed-cloud.ts';
import type { CloudPrecision } from '../data/packing/precision.ts';
import type { SplatSet } from '../data/splats/splat-set.ts';
import type { RowFiles, RowSink } from '../io/formats/rows/row-sink.ts';
import { loadOrPass } from '../io/loading/load-splats.ts';
import { knownSource } from '../io/sources/known-source.ts';
import type { MakeOptions } from './cloud-leases.ts';
import {
  type CloudPlanes,
  isGeometryAsFine,
  isShAsFine,
  type PageRange,
  type Plane,
  type PlanePlace,
  uploadGeometry,
  uploadHarmonics,
} from './cloud-planes.ts';
import type { CloudContents, CloudSource, SplatCloud } from './splat-cloud.ts';

/** Makes planes from a file's rows on the GPU. Call `finish` after the last row, or `destroy`. */
export interface PlaneSink extends RowSink {
  /** The caller owns the planes. */
  finish(): Promise<{ readonly contents: CloudContents; readonly planes: CloudPlanes }>;
  destroy(): void;
}

export interface RowPlanesOptions extends CloudPrecision {
  /** For labels and messages. */
  readonly name: string;
  /** Pages for the planes, used if they hold as many splats. */
  readonly pages: readonly PageRange[];
  /** Aborts the work. */
  readonly signal: AbortSignal;
}

/** Opens a sink for the rows of one file, and lists the files that it accepts. */
export type OpenRowPlanes = (options: RowPlanesOptions) => {
  readonly sink: PlaneSink;
  readonly files: RowFiles;
};

/** Planes that no cloud owns yet. `destroy` frees the planes that have not been taken. */
export interface FreshPlanes extends CloudPrecision {
  /** Entries of the palette; absent if harmonics are no palette. */
  readonly paletteEntries?: number;
  readonly takeGeometry: () => Plane;
  readonly takeHarmonics: () => Plane;
  readonly destroy: () => void;
}

/** Properties by which splats are compared with the loaded ones. */
type Identity = Pick<SplatCloud, 'count' | 'shDegree' | 'origin' | 'fileIndices' | 'chunks'>;

interface ReadSplats {
  readonly fresh: FreshPlanes;
  readonly identity: Identity;
}

/**
 * Reads the splats of `cloud` at least as finely as `wanted`, from the first source that has them.
 * Verifies that they are the same splats. Rows of files that `openRowPlanes` accepts become planes
 * on the GPU; other splats are packed in a worker.
 *
 * @throws GpuLimitError, SplatSourceError, SplatFileError; the signal's reason. Nothing is left
 *   allocated then.
 */
export async function readAgain(
  cloud: SplatCloud,
  wanted: CloudPrecision,
  openRowPlanes: OpenRowPlanes,
  options: MakeOptions,
): Promise<FreshPlanes> {
  const { sources, name } = cloud;
  const gone = `a finer precision (${describePrecision(wanted)}) must be read again, and the source is gone; load it from a URL, a File or a Blob, or pass its source when adding it.`;
  let problem: unknown = new SplatSourceError(name, gone);
  for (const source of sources) {
    try {
      return await readFrom(source, cloud, wanted, openRowPlanes, options);
    } catch (error) {
      options.signal.throwIfAborted();
      // Any other source would need as much memory.
      if (error instanceof GpuLimitError) throw error;
      problem = error;
    }
  }
  throw problem;
}

/** For messages. */
export function describePrecision({ geometryPrecision, shPrecision }: CloudPrecision): string {
  return `${geometryPrecision} geometry, ${shPrecision} harmonics`;
}

async function readFrom(
  source: CloudSource,
  cloud: SplatCloud,
  wanted: CloudPrecision,
  openRowPlanes: OpenRowPlanes,
  options: MakeOptions,
): Promise<FreshPlanes> {
  const { fresh, identity } = await splatsOf(source, cloud, wanted, openRowPlanes, options);
  try {
    checkFine(cloud, wanted, fresh);
    checkSame(cloud, identity);
    return fresh;
  } catch (error) {
    fresh.destroy();
    throw error;
  }
}

async function splatsOf(
  source: CloudSource,
  { name, planes, sourceOptions }: SplatCloud,
  wanted: CloudPrecision,
  openRowPlanes: OpenRowPlanes,
  options: MakeOptions,
): Promise<ReadSplats> {
  const { geometryPrecision, shPrecision } = wanted;
  const { signal, onProgress } = options;
  const precision = { geometryPrecision, shPrecision };
  if (isPackedCloud(source)) return fromPacked(source, planes.place);
  if (isSplatSet(source)) return fromPacked(packSet(source, precision), planes.place);
  const { sink, files } = openRowPlanes({ ...precision, name, pages: planes.ranges, signal });
  try {
    const loadOptions = { ...sourceOptions, ...precision, name, signal, onProgress };
    // Rows have no palette.
    const rowsTo = shPrecision === 'palette' ? undefined : { sink, files };
    const loaded = await loadOrPass(knownSource(source, loadOptions), loadOptions, rowsTo);
    if (loaded === 'passed') {
      const made = await sink.finish();
      return fromRows(made.contents, made.planes);
    }
    sink.destroy();
    return fromPacked(loaded, planes.place);
  } catch (error) {
    sink.destroy();
    throw error;
  }
}

function fromPacked(packed: PackedCloud, place: PlanePlace): ReadSplats {
  const { geometry, harmonics } = packed;
  const fresh: FreshPlanes = {
    geometryPrecision: geometry.precision,
    shPrecision: harmonics.precision,
    ...(isPalette(harmonics) && { paletteEntries: entryCountOf(harmonics) }),
    takeGeometry: () => uploadGeometry(place, geometry),
    takeHarmonics: () => uploadHarmonics(place, harmonics),
    destroy: () => {},
  };
  return { fresh, identity: { ...packed, shDegree: harmonics.degree } };
}

function fromRows(contents: CloudContents, planes: CloudPlanes): ReadSplats {
  const { geometryPrecision, shPrecision } = contents.precision;
  const taken: Plane[] = [];
  const take = (plane: Plane) => {
    taken.push(plane);
    return plane;
  };
  const fresh: FreshPlanes = {
    geometryPrecision,
    shPrecision,
    takeGeometry: () => take(planes.geometryPlane(geometryPrecision)!),
    takeHarmonics: () => take(planes.shPlane(shPrecision)!),
    destroy: () => planes.destroy(taken),
  };
  return { fresh, identity: { ...contents, shDegree: planes.shDegree } };
}

function isPackedCloud(source: CloudSource): source is PackedCloud {
  return typeof source === 'object' && 'geometry' in source;
}

function isSplatSet(source: CloudSource): source is SplatSet<Harmonics> {
  return typeof source === 'object' && 'logScales' in source;
}

/** @throws SplatSourceError if `fresh` is coarser than `wanted`. */
function checkFine({ name, shDegree, planes }: SplatCloud, wanted: CloudPrecision, fresh: FreshPlanes): void {
  const isFine =
    isGeometryAsFine(fresh.geometryPrecision, wanted.geometryPrecision) &&
    (shDegree === 0 ||
      planes.hasOwnPalette ||
      fresh.shPrecision === wanted.shPrecision ||
      (wanted.shPrecision !== 'palette' && isShAsFine(fresh.shPrecision, wanted.shPrecision)));
  if (isFine) return;
  const message = `its source has only ${describePrecision(fresh)}, not ${describePrecision(wanted)}; load it with that, or from a URL, a File or a Blob.`;
  throw new SplatSourceError(name, message);
}

/**
 * Compares the kept rows, their order, and each chunk's bounds of positions and sizes. Colours are
 * not compared, because the held ones are too coarse.
 *
 * @throws SplatSourceError if `read` are not the splats of `cloud`.
 */
function checkSame(cloud: SplatCloud, read: Identity): void {
  const { uploadedChunks: chunks } = cloud;
  const isSame =
    cloud.count === read.count &&
    cloud.shDegree === read.shDegree &&
    cloud.origin.every((value, axis) => value === read.origin[axis]) &&
    isSameWords(cloud.fileIndices, read.fileIndices) &&
    isSameChunks(new Float32Array(chunks), new Float32Array(read.chunks));
  if (isSame) return;
  const message = `its source has other splats than when it was loaded (${read.count}, then ${cloud.count}); it is unchanged. Load it again to see them.`;
  throw new SplatSourceError(cloud.name, message);
}

/** Log scales may differ by rounding, because the GPU computes logarithms differently. */
function isSameChunks(a: Float32Array, b: Float32Array): boolean {
  const { minLogScale, logScaleStep, count } = CHUNK_WORDS;
  const roundings: Record<number, number> = { [minLogScale]: 1e-4, [logScaleStep]: 1e-4 / 65535 };
  const isSameAt = (i: number) => Math.abs(a[i] - b[i]) <= (roundings[i % count] ?? 0);
  return a.length === b.length && a.every((_, i) => isSameAt(i));
}

function isSameWords(a: Uint32Array, b: Uint32Array): boolean {
  if (a.length !== b.length) return false;
  for (let i = 0; i < a.length; i++) if (a[i] !== b[i]) return false;
  return true;
}
