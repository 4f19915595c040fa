import { SplatSourceError } from '../data/errors.ts';
import { CHUNK_WORDS } from '../data/layout/chunk-words.ts';
import { CHUNK_SPLATS, SHADER_CONSTANTS } from '../data/layout/constants.ts';
import { GEOMETRY_WORDS, type PackedGeometry } from '../data/packing/geometry.ts';
import type { PackedCloud } from '../data/packing/packed-cloud.ts';
import { type TimeRange, timeWithin } from '../features/motion/splat-motion.data.ts';
import { readWords } from '../gpu/read-buffer.ts';
import { flushFeatures, writerOf } from './cloud-feature.ts';
import type { SplatCloud } from './splat-cloud.ts';

/** Splats per piece, whole chunks: 1 MiB if packed. */
const PIECE_SPLATS = 1 << 15;

const { MOTION_WORDS } = SHADER_CONSTANTS;

/** Geometry of splats that are neighbours in storage order. */
export interface GeometryPiece extends PackedGeometry {
  /** The splats' motion, and the time that they are read at; null or absent if they stand still. */
  readonly motion?: {
    /** MOTION_WORDS per splat. */
    readonly floats: Float32Array;
    readonly time: number;
  } | null;
}

/**
 * Yields the geometry of all splats in storage order, in pieces of whole chunks; the last chunk of
 * a page may be partial. Geometry of a cloud on the GPU is copied; other geometry is a view that
 * must not be changed.
 *
 * @param time at which the splats of a moving cloud are read, within its range; default its first.
 * @throws SplatSourceError for a preview and for splats that the GPU makes; DestroyedError if the cloud ends before its last piece;
 *   GpuLimitError if the device lacks memory.
 */
export async function* geometryPieces(
  splats: SplatCloud | PackedCloud,
  time?: number,
): AsyncGenerator<GeometryPiece> {
  if ('geometry' in splats) yield* piecesInMemory(splats, time);
  else yield* piecesOnGpu(splats, time);
}

function* piecesInMemory({ geometry, motion }: PackedCloud, time?: number): Generator<GeometryPiece> {
  const { precision, words, chunks } = geometry;
  const stride = GEOMETRY_WORDS[precision];
  for (let at = 0; stride * at < words.length; at += PIECE_SPLATS) {
    const piece = words.subarray(stride * at, stride * (at + PIECE_SPLATS));
    // Copied like chunks.
    const moving = motion?.words.slice(MOTION_WORDS * at, MOTION_WORDS * (at + PIECE_SPLATS));
    yield {
      precision,
      words: piece,
      chunks: chunksFrom(chunks, at),
      motion: motion && motionOf(moving!, motion.range, time),
    };
  }
}

function motionOf(floats: Float32Array, range: TimeRange, time = range[0]): GeometryPiece['motion'] {
  return { floats, time: timeWithin({ time, range }) };
}

/**
 * The chunks of a piece that begins at splat `first`. A copy, because messages transfer whole
 * buffers.
 */
function chunksFrom(chunks: Float32Array, first: number): Float32Array<ArrayBuffer> {
  const [from, end] = [first, first + PIECE_SPLATS].map((at) => (CHUNK_WORDS.count * at) / CHUNK_SPLATS);
  return chunks.slice(from, end);
}

async function* piecesOnGpu(cloud: SplatCloud, time?: number): AsyncGenerator<GeometryPiece> {
  const { device, name, timeRange } = cloud;
  if (cloud.pool)
    throw new SplatSourceError(name, 'only parts of it are there: read its splats from another format.');
  if (cloud.isPreview)
    throw new SplatSourceError(name, 'it is still loading: its splats can be read once it is whole.');
  if (writerOf(cloud)?.readChunks)
    throw new SplatSourceError(
      name,
      'the GPU makes its splats anew, and only frames read them: read the buffers that they are made of.',
    );
  await cloud.uploaded;
  // Edits since the last frame may not be uploaded yet.
  flushFeatures(cloud);
  // Planes may be replaced between pieces. The precision nearest to packed has the least bytes.
  const planes = () => {
    cloud.checkUsable();
    return cloud.pagesFor({ geometryPrecision: 'packed', shPrecision: 'u8' });
  };
  for (const [page, { start, end }] of cloud.planes.ranges.entries()) {
    for (let at = start; at < end; at += PIECE_SPLATS) {
      const { pages, geometryPrecision: precision } = planes();
      const stride = GEOMETRY_WORDS[precision];
      const read = (buffer: GPUBuffer, wordsPerSplat: number) =>
        readWords(
          device,
          buffer,
          wordsPerSplat * Math.min(PIECE_SPLATS, end - at),
          wordsPerSplat * (at - start),
        );
      const { geometry, motion } = pages[page];
      // Requested at once: the cloud may end before the first has arrived.
      const [words, moving] = await Promise.all([
        read(geometry, stride),
        motion && read(motion.splats, MOTION_WORDS),
      ]);
      yield {
        precision,
        words,
        chunks: chunksFrom(new Float32Array(cloud.chunks), at),
        motion: moving && motionOf(new Float32Array(moving.buffer), timeRange!, time),
      };
    }
  }
}
