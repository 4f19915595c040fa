import { type FileFinding, SplatFileError } from '../../../data/errors.ts';
import { shown } from '../../../data/printable.ts';
import type { ShDegree } from '../../../data/splats/splat-set.ts';
import { JsonFields, parseJson } from '../file-json.ts';
import { CHUNK_MAGIC, latin1 } from '../first-bytes.ts';
import { checkCount } from '../rows/splat-counts.ts';

/** Signature and length of the JSON, for a scene or a chunk. */
export const PREFIX_BYTES = 8;
/** Parts begin at multiples of this many bytes. */
const ALIGNMENT = 8;
/** A chunk of 65,536 nodes takes about 60 bytes of JSON, a comment some hundred. */
const MOST_JSON_BYTES = 2 ** 24;
const MOST_JSON_VALUES = 2 ** 21;
const VERSION = 1;

/** Location of a chunk, and its range of nodes. */
export interface ChunkPlace {
  /** Byte offset from the end of the scene's header; 0 in a separate file. */
  readonly offset: number;
  readonly bytes: number;
  /** Number of nodes before the chunk, and in it. */
  readonly base: number;
  readonly count: number;
  /** Path of a separate file, relative to the scene's folder; null if the chunk is in the scene's file. */
  readonly path: string | null;
}

export interface RadHeader {
  /** Bytes of the header, before the chunks. */
  readonly bytes: number;
  /** Number of nodes, over all levels of detail. */
  readonly count: number;
  readonly shDegree: ShDegree;
  /** Whether nodes have children; if not, all nodes are splats of the finest level. */
  readonly isTree: boolean;
  /** Number of palette entries of harmonics; undefined if nodes have separate harmonics. */
  readonly paletteSize: number | undefined;
  readonly chunks: readonly ChunkPlace[];
}

/** Aligned size: `size` plus padding. */
export function padded(size: number): number {
  return Math.ceil(size / ALIGNMENT) * ALIGNMENT;
}

/** Reads exactly the next bytes of a file. @param what `the header`, for messages. */
export type ReadNext = (byteCount: number, what: string) => Promise<Uint8Array<ArrayBuffer>>;

/**
 * Reads the header before the chunks.
 *
 * Rejects with SplatFileError: 'unknown-format' for other versions and for a chunk without its
 * scene; 'bad-header', 'damaged', 'too-large', 'empty'; and as `next`.
 *
 * @param file file name in messages.
 */
export async function readRadHeader(file: string, next: ReadNext): Promise<RadHeader> {
  const prefix = await next(PREFIX_BYTES, 'the header');
  if (latin1(prefix.subarray(0, 4)) === CHUNK_MAGIC) {
    const finding: FileFinding = [
      'is one chunk of a scene',
      'open the .rad file that it belongs to, with all of them',
    ];
    throw new SplatFileError('unknown-format', file, finding, { byte: 0 });
  }
  const length = new DataView(prefix.buffer, prefix.byteOffset).getUint32(4, true);
  if (length > MOST_JSON_BYTES) {
    const message = `its header has ${length} bytes; at most ${MOST_JSON_BYTES} are read. Export it in parts.`;
    throw new SplatFileError('too-large', file, message, { byte: 4 });
  }
  const bytes = await next(padded(length), 'the header');
  const fields = parseRadJson(bytes.subarray(0, length), file, 'header of a .rad');
  return { ...headerOf(fields, file), bytes: PREFIX_BYTES + padded(length) };
}

/**
 * Parses the JSON of a scene or of a chunk.
 *
 * @param what `header of a .rad`, for messages.
 * @throws SplatFileError 'bad-header', 'too-large'; 'unknown-format' for other versions
 */
export function parseRadJson(bytes: Uint8Array, file: string, what: string): JsonFields {
  const fields = new JsonFields(parseJson(bytes, file, MOST_JSON_VALUES), '', file, what);
  const version = fields.count('version');
  if (version === VERSION) return fields;
  const finding: FileFinding = [
    `is a .rad of version ${version}`,
    `version ${VERSION} is read. Export it by Spark 2`,
  ];
  throw new SplatFileError('unknown-format', file, finding, { property: 'version' });
}

function headerOf(fields: JsonFields, file: string): Omit<RadHeader, 'bytes'> {
  const type = fields.get('type');
  if (type !== 'gsplat') {
    const finding: FileFinding = [`is a .rad of ${shown(type)}`, 'those of gsplat are read'];
    throw new SplatFileError('unknown-format', file, finding, { property: 'type' });
  }
  const count = fields.count('count');
  checkCount(count, file, Number.POSITIVE_INFINITY, { property: 'count' });
  const isTree = fields.get('lodTree') ?? false;
  if (typeof isTree !== 'boolean') return fields.fail('lodTree', 'true or false');
  const shDegree = fields.has('maxSh') ? fields.count('maxSh') : 0;
  if (shDegree > 3) return fields.fail('maxSh', 'a degree from 0 to 3');
  return {
    count,
    shDegree: shDegree as ShDegree,
    isTree,
    paletteSize: fields.has('shCodeCount') ? fields.count('shCodeCount') : undefined,
    chunks: chunksOf(fields, count, file),
  };
}

/** Throws unless the chunks hold all nodes, in order and without gaps. */
function chunksOf(fields: JsonFields, count: number, file: string): ChunkPlace[] {
  const damaged = (message: string) =>
    new SplatFileError('damaged', file, `${message} Export it again.`, { property: 'chunks' });
  const chunkSize = fields.has('chunkSize') ? fields.count('chunkSize') : count;
  const chunks = fields.list('chunks');
  if (Math.ceil(count / chunkSize) !== chunks.length)
    throw damaged(`its ${count} nodes are in ${chunks.length} chunks of ${chunkSize}.`);
  let end = 0;
  return chunks.map((chunk, i) => {
    const path = chunk.get('filename') ?? null;
    if (typeof path !== 'string' && path !== null) return chunk.fail('filename', 'the path of a file');
    const [offset, bytes] = [chunk.count('offset'), chunk.count('bytes')];
    const start = path === null ? end : 0;
    if (offset !== start) throw damaged(`chunk ${i} begins at ${offset}, where ${start} follows.`);
    if (path === null) end += bytes;
    const base = i * chunkSize;
    return { offset, bytes, path, base, count: Math.min(chunkSize, count - base) };
  });
}
