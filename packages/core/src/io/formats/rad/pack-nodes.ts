import { NO_ROW, type SplatCells } from '../../../data/bricks/leaf-scene.ts';
import { packCoefficients } from '../../../data/packing/harmonics.ts';
import { mortonOrder } from '../../../data/packing/morton-order.ts';
import { logitOf } from '../../../data/splats/color-values.ts';
import { ROW_SLOT } from '../../../data/splats/splat-row.ts';
import { coefficientsPerSplat } from '../../../data/splats/splat-set.ts';
import type { Turns } from '../../../data/turns.ts';
import { packPieces } from '../rows/pack-pieces.ts';
import { type DecodedChunk, type PackedChunk, type RadFacts, stackIn } from './decoded-chunk.ts';
import { decodedPart, type KeyedPart, type RadChunks } from './divide-part.ts';

/** Nodes of a part that are packed together: either all that have no children, or one group of the others. */
export interface NodesOfPart {
  readonly part: KeyedPart;
  /** Index in `DividedPart.inner`; null for nodes without children. */
  readonly inner: number | null;
}

/**
 * Packs each list of nodes in Morton order; an inner node becomes a stack of several splats.
 *
 * Rejects as `decodedPart`.
 */
export async function packRadNodes(
  { chunks, lists }: { readonly chunks: RadChunks; readonly lists: readonly NodesOfPart[] },
  turns: Turns,
): Promise<SplatCells[][]> {
  const packed: SplatCells[][] = [];
  for (const { part, inner } of lists) {
    const { divided, decoded } = await decodedPart(chunks, part, turns);
    const nodes = inner === null ? divided.leaves : divided.inner[inner].nodes;
    packed.push(await packNodes(nodes, decoded, chunks.chunks, chunks.facts, turns));
  }
  return packed;
}

function packNodes(
  nodes: Uint32Array,
  decoded: readonly DecodedChunk[],
  chunks: readonly PackedChunk[],
  { shDegree }: RadFacts,
  turns: Turns,
): Promise<SplatCells[]> {
  const [{ place: first }] = chunks;
  const placeOf = (node: number): [chunk: DecodedChunk, i: number] => {
    const chunk = Math.floor((node - first.base) / first.count);
    return [decoded[chunk], node - chunks[chunk].place.base];
  };
  const finite = nodes.filter((node) => {
    const [{ rows }, i] = placeOf(node);
    return [0, 1, 2].every((axis) => Number.isFinite(rows.center(i, axis)));
  });
  const centers = new Float32Array(3 * finite.length);
  for (const [at, node] of finite.entries()) {
    const [{ rows }, i] = placeOf(node);
    for (let axis = 0; axis < 3; axis++) centers[3 * at + axis] = rows.center(i, axis);
  }
  const splats: { readonly node: number; readonly copy: number }[] = [];
  for (const at of mortonOrder(centers, finite.length)) {
    const [chunk, i] = placeOf(finite[at]);
    const copies = stackIn(chunk, i).opacities.length;
    for (let copy = 0; copy < copies; copy++) splats.push({ node: finite[at], copy });
  }
  const row = new Float64Array(ROW_SLOT.harmonics + coefficientsPerSplat(shDegree));
  const harmonics = row.subarray(ROW_SLOT.harmonics);
  const fill = (at: number, words: Uint32Array, wordOffset: number) => {
    const { node, copy } = splats[at];
    const [chunk, i] = placeOf(node);
    chunk.rows.fill(row, i);
    packCoefficients(shDegree, 'u8', harmonics, words, wordOffset);
    if (chunk.childCounts[i] === 0) return node;
    const { opacities, growth } = stackIn(chunk, i);
    row[ROW_SLOT.opacity] = logitOf(opacities[copy]);
    for (let axis = 0; axis < 3; axis++) row[ROW_SLOT.logScale + axis] += growth;
    return NO_ROW;
  };
  return packPieces(splats.length, shDegree, row, fill, turns);
}
