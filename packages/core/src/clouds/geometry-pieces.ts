import { DestroyedError, SplatSourceError } from '../errors.ts';
import { readWords } from '../gpu/read-buffer.ts';
import { GEOMETRY_WORDS, type PackedGeometry } from '../packing/geometry.ts';
import type { PackedCloud } from '../packing/packed-cloud.ts';
import type { SplatCloud } from './splat-cloud.ts';

/** Splats of a piece, whole chunks: 1 MiB where they are packed. */
const PIECE_SPLATS = 1 << 15;

/**
 * Returns the geometry of all splats in storage order, piece by piece, each of whole chunks but the last of a page. That of a cloud
 * on the GPU is copied; that of others must not be changed.
 *
 * @throws SplatSourceError for a preview, DestroyedError if the cloud ends before its last piece, GpuLimitError if memory is
 *   lacking.
 */
export async function* geometryPieces(splats: SplatCloud | PackedCloud): AsyncGenerator<PackedGeometry> {
  if ('geometry' in splats) yield* piecesInMemory(splats.geometry);
  else yield* piecesOnGpu(splats);
}

function* piecesInMemory({ precision, words, logScaleRange }: PackedGeometry): Generator<PackedGeometry> {
  const size = GEOMETRY_WORDS[precision] * PIECE_SPLATS;
  for (let at = 0; at < words.length; at += size)
    yield { precision, words: words.subarray(at, at + size), logScaleRange };
}

async function* piecesOnGpu(cloud: SplatCloud): AsyncGenerator<PackedGeometry> {
  const { device, name } = cloud;
  if (cloud.isPreview)
    throw new SplatSourceError(name, 'it is still loading: its splats can be read once it is whole.');
  await cloud.uploaded;
  // What was drawn last may lack edits.
  cloud.editing?.flush();
  // Other planes may take their place while a piece is worked on; those nearest to packed are the smallest.
  const planes = () => {
    if (cloud.isDestroyed) throw new DestroyedError(`The cloud ${name}`, 'it was destroyed');
    return cloud.pagesFor({ geometryPrecision: 'packed', shPrecision: 'u8' });
  };
  for (const [page, { splatCount }] of planes().pages.entries()) {
    for (let at = 0; at < splatCount; at += PIECE_SPLATS) {
      const { pages, geometryPrecision: precision } = planes();
      const stride = GEOMETRY_WORDS[precision];
      const wordCount = stride * Math.min(PIECE_SPLATS, splatCount - at);
      const words = await readWords(device, pages[page].geometry, wordCount, stride * at);
      yield { precision, words, logScaleRange: cloud.logScaleRange };
    }
  }
}
