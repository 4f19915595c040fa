import { SplatFileError } from '../../../data/errors.ts';
import { shown } from '../../../data/printable.ts';
import type { ShDegree } from '../../../data/splats/splat-set.ts';
import { checkCount } from '../check-count.ts';
import { CHUNK_MAGIC, latin1 } from '../first-bytes.ts';
import { JsonFields } from '../json-fields.ts';
import { parseJson } from '../parse-json.ts';

/** Magic and length of the JSON, of a scene and of a chunk. */
export const PREFIX_BYTES = 8;
/** Parts begin at multiples of it. */
const ALIGNMENT = 8;
/** A chunk of 65,536 nodes takes about 60 bytes, and a comment of the writer some hundred. */
const MOST_JSON_BYTES = 2 ** 24;
const MOST_JSON_VALUES = 2 ** 21;
const VERSION = 1;

/** A part of a scene's nodes. */
export interface ChunkPlace {
  /** Bytes between those before the chunks and this one; 0 in a file of its own. */
  readonly offset: number;
  readonly bytes: number;
  /** Nodes before it, and in it. */
  readonly base: number;
  readonly count: number;
  /** Path of its own file, from the folder of the scene; null if it follows the chunk before. */
  readonly path: string | null;
}

export interface RadHeader {
  /** Bytes before the chunks. */
  readonly bytes: number;
  /** Nodes of all levels of detail. */
  readonly count: number;
  readonly shDegree: ShDegree;
  /** Whether nodes have children; else each is a splat of the finest level. */
  readonly isTree: boolean;
  /** Entries in the palette of harmonics; undefined if nodes have their own. */
  readonly paletteSize: number | undefined;
  readonly chunks: readonly ChunkPlace[];
}

/** `size` with the padding that follows so many bytes. */
export function padded(size: number): number {
  return Math.ceil(size / ALIGNMENT) * ALIGNMENT;
}

/** Reads the next bytes of a file, all of them. @param what they are, for messages. */
export type ReadNext = (byteCount: number, what: string) => Promise<Uint8Array<ArrayBuffer>>;

/**
 * Reads the header before the chunks.
 *
 * Rejects with SplatFileError: 'unknown-format' for other versions, and a chunk without its scene;
 * 'bad-header', 'damaged', 'too-large', 'empty'; and as `next`.
 *
 * @param file names it in messages.
 */
export async function readRadHeader(file: string, next: ReadNext): Promise<RadHeader> {
  const prefix = await next(PREFIX_BYTES, 'the header');
  if (latin1(prefix.subarray(0, 4)) === CHUNK_MAGIC) {
    const message = 'it is one chunk of a scene. Open the .rad file that it belongs to, with all of them.';
    throw new SplatFileError('unknown-format', file, message, { byte: 0 });
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
 * The JSON of a scene or of a chunk.
 *
 * @param what it is, for messages.
 * @throws SplatFileError 'bad-header', 'too-large'; 'unknown-format' for other versions
 */
export function parseRadJson(bytes: Uint8Array, file: string, what: string): JsonFields {
  const fields = new JsonFields(parseJson(bytes, file, MOST_JSON_VALUES), '', file, what);
  const version = fields.count('version');
  if (version === VERSION) return fields;
  const message = `it is a .rad of version ${version}; version ${VERSION} is read. Export it by Spark 2.`;
  throw new SplatFileError('unknown-format', file, message, { property: 'version' });
}

function headerOf(fields: JsonFields, file: string): Omit<RadHeader, 'bytes'> {
  const type = fields.get('type');
  if (type !== 'gsplat') {
    const message = `it is a .rad of ${shown(type)}; those of gsplat are read.`;
    throw new SplatFileError('unknown-format', file, message, { property: 'type' });
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

/** Throws unless chunks hold all nodes, one after another without gaps. */
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
