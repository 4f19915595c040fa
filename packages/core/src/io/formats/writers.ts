import { InvalidArgumentError } from '../../errors.ts';
import type { Harmonics } from '../../packing/harmonics.ts';
import { shown } from '../../printable.ts';
import type { SplatSet } from '../../splats/splat-set.ts';
import type { WriteFormat, WriteOptions } from './write-format.ts';

/** A format that can be written, for pickers and messages. */
export interface WritableFormat {
  /** As in `SplatFormat`. */
  readonly name: string;
  /** What people call it. */
  readonly title: string;
  /** Usual end of a file's name, e.g. `.ply`. */
  readonly extension: string;
  /** Whether a file can say that its splats were trained with an antialias filter. */
  readonly tellsAntialiased: boolean;
  /** Whether y points up in every file of this format; in others it mostly points down. */
  readonly hasYUp: boolean;
}

interface Writer extends WritableFormat {
  /** Fetches the code. */
  load(): Promise<WriteFormat>;
}

/** Every format that can be written. To add one, write `NAME/write-NAME.ts` and list it here. */
const WRITERS: readonly Writer[] = [
  {
    name: 'ply',
    title: 'PLY',
    extension: '.ply',
    tellsAntialiased: true,
    hasYUp: false,
    load: async () => (await import('./ply/write-ply.ts')).writePly,
  },
  {
    name: 'compressed-ply',
    title: 'Compressed PLY',
    extension: '.compressed.ply',
    tellsAntialiased: true,
    hasYUp: false,
    load: async () => (await import('./compressed-ply/write-compressed-ply.ts')).writeCompressedPly,
  },
  {
    name: 'spz',
    title: 'SPZ',
    extension: '.spz',
    tellsAntialiased: true,
    hasYUp: false,
    load: async () => (await import('./spz/write-spz.ts')).writeSpz,
  },
  {
    name: 'sog',
    title: 'SOG',
    extension: '.sog',
    tellsAntialiased: true,
    hasYUp: false,
    load: async () => (await import('./sog/write-sog.ts')).writeSog,
  },
  {
    name: 'gltf',
    title: 'glTF',
    extension: '.glb',
    tellsAntialiased: false,
    hasYUp: true,
    load: async () => (await import('./gltf/write-gltf.ts')).writeGltf,
  },
];

/** Every format that can be written. */
export const WRITABLE_FORMATS: readonly WritableFormat[] = WRITERS.map(({ load, ...facts }) => facts);

/** The format that files with this name are written in; undefined if the name does not tell. */
export function writableByName(fileName: string): WritableFormat | undefined {
  const lower = fileName.toLowerCase();
  // The longest end counts: `.compressed.ply` ends with `.ply`.
  return WRITABLE_FORMATS.filter(({ extension }) => lower.endsWith(extension)).sort(
    (a, b) => b.extension.length - a.extension.length,
  )[0];
}

/**
 * Writes splats as a file in the format of this name, one of `WRITABLE_FORMATS`, whose code is fetched first. Works in the calling
 * thread and gives its event loop turns.
 *
 * Rejects with `InvalidArgumentError` if there is no such format ('formatName'), or if it cannot hold these splats ('set'); or with the
 * signal's reason.
 */
export async function writeSplats(
  set: SplatSet<Harmonics>,
  formatName: string,
  options: WriteOptions = {},
): Promise<Uint8Array<ArrayBuffer>> {
  const writer = WRITERS.find(({ name }) => name === formatName);
  if (!writer) {
    const names = WRITERS.map(({ name }) => name).join(', ');
    const message = `${shown(formatName)} cannot be written; the format must be one of ${names}.`;
    throw new InvalidArgumentError('formatName', message);
  }
  if (set.count === 0) throw new InvalidArgumentError('set', 'There are no splats to write.');
  const write = await writer.load();
  return write(set, options);
}
