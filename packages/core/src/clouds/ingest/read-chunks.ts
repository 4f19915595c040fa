import { Chunk } from '../../data/layout/structs.ts';
import { chunkCountOf } from '../../data/packing/chunks.ts';
import { readWords } from '../../gpu/read-buffer.ts';
import type { MadePlanes } from '../cloud-planes.ts';

/** Reads the `Chunk` structs of all pages, one after another. */
export async function readChunks(
  device: GPUDevice,
  { chunks, ranges }: Pick<MadePlanes, 'chunks' | 'ranges'>,
): Promise<ArrayBuffer> {
  const pages = await Promise.all(chunks.map((page) => readWords(device, page)));
  const wordCounts = ranges.map(({ start, end }) => (Chunk.bytes / 4) * chunkCountOf(end - start));
  const words = new Uint32Array(wordCounts.reduce((sum, count) => sum + count, 0));
  let at = 0;
  for (const [page, count] of wordCounts.entries()) {
    // A page may have room for chunks that have not arrived.
    words.set(pages[page].subarray(0, count), at);
    at += count;
  }
  return words.buffer;
}
