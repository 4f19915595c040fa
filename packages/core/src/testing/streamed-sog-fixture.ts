// Writes streamed SOG for tests: coarser levels have every fourth splat, twice as large.
import { mortonOrder, permuteSplats } from '../data/packing/morton-order.ts';
import type { SplatSet } from '../data/splats/splat-set.ts';
import { openZipEntry, readZipDirectory } from '../io/containers/zip.ts';
import { write } from '../io/formats/sog/write-sog.ts';
import { readSplats } from '../io/loading/read-splats.ts';

export interface StreamedSogFixture {
  /** The finest level. */
  readonly set: SplatSet;
  /** Files of each level, the finest first. Each has as many leaves, as equal as can be. */
  readonly filesOfLevel: readonly number[];
  /** A multiple of each number of files. */
  readonly leafCount: number;
  readonly environment?: SplatSet;
  /** Error of each leaf: see `errors` of the format; default none. */
  readonly errors?: readonly number[];
}

/** A streamed SOG: its metadata, to be changed, and its other files by path. */
export interface StreamedSog {
  // biome-ignore lint/suspicious/noExplicitAny: tests change whatever they like
  readonly meta: any;
  readonly files: Record<string, Uint8Array<ArrayBuffer>>;
}

const LEVEL_FACTOR = 4;

export async function streamedSog(fixture: StreamedSogFixture): Promise<StreamedSog> {
  const { set, filesOfLevel, leafCount, environment, errors } = fixture;
  const files: StreamedSog['files'] = {};
  const filenames: string[] = [];
  const leaves = Array.from({ length: leafCount }, () => ({
    bound: { min: [Infinity, Infinity, Infinity], max: [-Infinity, -Infinity, -Infinity] },
    lods: {} as Record<number, { file: number; offset: number; count: number }>,
    ...(errors && { errors }),
  }));
  const counts: number[] = [];
  let level = permuteSplats(set, mortonOrder(set.positions as Float32Array, set.count));
  for (const [number, fileCount] of filesOfLevel.entries()) {
    counts.push(level.count);
    const leavesOfFile = leafCount / fileCount;
    for (let file = 0; file < fileCount; file++) {
      const folder = `${number}_${file}/`;
      const part = partOf(level, file / fileCount, (file + 1) / fileCount);
      const written = await addFile(files, folder, part);
      for (let k = 0; k < leavesOfFile; k++) {
        const [from, to] = [k, k + 1].map((i) => Math.floor((i * written.count) / leavesOfFile));
        const { bound, lods } = leaves[file * leavesOfFile + k];
        lods[number] = { file: filenames.length, offset: from, count: to - from };
        widen(bound, written, from, to);
      }
      filenames.push(`${folder}meta.json`);
    }
    level = coarserOf(level);
  }
  if (environment) await addFile(files, 'env/', environment);
  const bound = { min: [-1, -1, -1], max: [1, 1, 1] };
  const half = Math.ceil(leafCount / 2);
  const children = [
    { bound, children: leaves.slice(0, half) },
    { bound, children: leaves.slice(half) },
  ];
  const meta = {
    version: 1,
    count: counts.reduce((sum, count) => sum + count, 0),
    counts,
    lodLevels: filesOfLevel.length,
    filenames,
    ...(environment && { environment: 'env/meta.json' }),
    tree: { bound, children },
  };
  return { meta, files };
}

/** All files of a streamed SOG, below a folder. */
export function streamedSogFiles({ meta, files }: StreamedSog, folder = ''): StreamedSog['files'] {
  const all = { 'lod-meta.json': new TextEncoder().encode(JSON.stringify(meta)), ...files };
  return Object.fromEntries(Object.entries(all).map(([path, bytes]) => [folder + path, bytes]));
}

/** Writes a SOG, and reads it as it is. */
async function addFile(files: StreamedSog['files'], folder: string, set: SplatSet): Promise<SplatSet> {
  const archive = (await write(set, {})) as Uint8Array<ArrayBuffer>;
  for (const entry of readZipDirectory(archive, folder)) {
    const { stream } = openZipEntry(archive, entry, entry.path);
    files[folder + entry.path] = new Uint8Array(await new Response(stream as BodyInit).arrayBuffer());
  }
  return (await readSplats(archive, { name: 'part.sog', shPrecision: 'f32' })) as unknown as SplatSet;
}

function partOf(set: SplatSet, from: number, to: number): SplatSet {
  const [first, end] = [from, to].map((part) => Math.round(part * set.count));
  return permuteSplats(
    set,
    Uint32Array.from({ length: end - first }, (_, i) => first + i),
  );
}

function coarserOf(set: SplatSet): SplatSet {
  const count = Math.floor(set.count / LEVEL_FACTOR);
  const some = permuteSplats(
    set,
    Uint32Array.from({ length: count }, (_, i) => LEVEL_FACTOR * i),
  );
  return { ...some, logScales: some.logScales.map((value) => value + Math.log(2)) };
}

/** As splat-transform has them: of the splats as far as one standard deviation. */
function widen(
  { min, max }: { min: number[]; max: number[] },
  { origin, positions, logScales }: SplatSet,
  from: number,
  to: number,
): void {
  for (let i = 3 * from; i < 3 * to; i++) {
    const axis = i % 3;
    const scale = Math.exp(Math.max(...logScales.subarray(i - axis, i - axis + 3)));
    min[axis] = Math.min(min[axis], positions[i] + origin[axis] - scale);
    max[axis] = Math.max(max[axis], positions[i] + origin[axis] + scale);
  }
}
