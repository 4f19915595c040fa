import type { Levels } from '../clouds/levels/levels.ts';
import type { SplatCloud } from '../clouds/splat-cloud.ts';
import { CHUNK_SPLATS } from '../data/layout/constants.ts';
import { ChunkLinks, LEVEL_CONSTANTS } from '../data/layout/level-structs.ts';
import { readBack } from '../gpu/read-back.ts';

const { CELL_ROOTS, ERROR_BOUNDLESS } = LEVEL_CONSTANTS;
const LINKS_BYTES = 4 * ChunkLinks.words;
/** Words of a `ChunkLinks` before its links. */
const HEAD_WORDS = ChunkLinks.words - CHUNK_SPLATS;

const parentErrorOf = (link: number) => (link >>> 12) & 0xfff;
const parentSlotOf = (link: number) => link >>> 24;

/** A blob; or a leaf of an upper cell, which is a blob of the level below. */
interface Node {
  readonly cell: number;
  readonly slot: number;
  readonly isLeaf: boolean;
}

/**
 * Finds the first splat, in storage order, that was merged into a blob. Descends from cell to cell
 * and reads back their links.
 *
 * @returns its index in storage; null if it is not on the GPU, or if cloud or levels have been
 *   destroyed meanwhile.
 */
export async function firstSplatOf(
  device: GPUDevice,
  cloud: SplatCloud,
  levels: Levels,
  { page, chunk, slot }: { readonly page: number; readonly chunk: number; readonly slot: number },
): Promise<number | null> {
  const { chunkCells: chunkCount, splatLinks, blobPages } = levels;
  const isUpper = page >= splatLinks.length;
  const before = blobPages.slice(0, page).reduce((sum, each) => sum + each.chunkCount, 0);
  let node: Node = isUpper
    ? { cell: chunkCount + Math.floor(chunk / 2), slot, isLeaf: chunk % 2 === 0 }
    : { cell: before + chunk, slot, isLeaf: false };
  for (;;) {
    if (node.isLeaf && node.cell < chunkCount) return node.cell * CHUNK_SPLATS + node.slot;
    const cell = node.isLeaf ? levels.childCell(node.cell, node.slot) : node.cell;
    if (cell === null || cloud.isDestroyed || cloud.levels !== levels) return null;
    const { leaves, blobs } = await readLinks(device, levels, cell);
    const blob: number = node.isLeaf ? rootSlots(blobs)[node.slot % CELL_ROOTS] : node.slot;
    node = { cell, slot: firstLeafOf(leaves, blobs, blob), isLeaf: true };
  }
}

function rootSlots(blobs: Uint32Array): number[] {
  return Array.from(blobs.keys()).filter((slot) => parentErrorOf(blobs[slot]) === ERROR_BOUNDLESS);
}

/** The first leaf below blob `slot` of a cell. */
function firstLeafOf(leaves: Uint32Array, blobs: Uint32Array, slot: number): number {
  return leaves.findIndex((link) => {
    if (link === 0) return false;
    let above = parentSlotOf(link);
    // Parents have larger slots than their children.
    while (above < slot && parentErrorOf(blobs[above]) !== ERROR_BOUNDLESS)
      above = parentSlotOf(blobs[above]);
    return above === slot;
  });
}

/** Reads the links of a cell's leaves and blobs. */
async function readLinks(device: GPUDevice, levels: Levels, cell: number) {
  const { chunkCells: chunkCount, splatLinks, blobPages } = levels;
  let [page, chunk] = [0, cell];
  if (cell < chunkCount) while (chunk >= blobPages[page].chunkCount) chunk -= blobPages[page++].chunkCount;
  else [page, chunk] = [blobPages.length - 1, 2 * (cell - chunkCount)];
  const isUpper = cell >= chunkCount;
  const bytes = await readBack(device, 2 * LINKS_BYTES, (encoder, target) => {
    const { links } = blobPages[page];
    const ofLeaves = isUpper ? links : splatLinks[page];
    encoder.copyBufferToBuffer(ofLeaves, chunk * LINKS_BYTES, target, 0, LINKS_BYTES);
    const blobChunk = isUpper ? chunk + 1 : chunk;
    encoder.copyBufferToBuffer(links, blobChunk * LINKS_BYTES, target, LINKS_BYTES, LINKS_BYTES);
  });
  const words = new Uint32Array(bytes);
  return {
    leaves: words.subarray(HEAD_WORDS, ChunkLinks.words),
    blobs: words.subarray(ChunkLinks.words + HEAD_WORDS),
  };
}
