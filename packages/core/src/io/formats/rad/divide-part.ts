import type { Vec3 } from '../../../data/math/mat4.ts';
import { emptyBounds } from '../../../data/packing/center-bounds.ts';
import type { Bounds } from '../../../data/packing/packed-cloud.ts';
import type { Turns } from '../../../data/turns.ts';
import { LastResults } from '../last-results.ts';
import {
  type DecodedChunk,
  decodedChunk,
  type PackedChunk,
  type RadFacts,
  stackIn,
} from './decoded-chunk.ts';
import { type DividedPart, dividePart, type TreePart, type TreeShape } from './tree-parts.ts';

/** Divided parts that a worker keeps, bytes: a few of all nodes of a chunk. */
const KEPT_BYTES = 4 << 20;
/** Least error of a level above the finest, so that splats of size 0 are refined, too. */
const LEAST_ERROR = 1e-9;

/** The chunks of a part, and facts about their scene. Can be posted. */
export interface RadChunks {
  /** Consecutive. */
  readonly chunks: readonly PackedChunk[];
  readonly facts: RadFacts;
  readonly tree: TreeShape;
}

/** A part with a key that tells it apart in all scenes of a thread. Can be posted. */
export interface KeyedPart extends TreePart {
  readonly key: number;
}

/** Nodes whose children lie in the same other chunks. */
interface InnerNodes {
  /** The part of their children. */
  readonly below: TreePart;
  readonly bounds: Bounds;
  /** Distance from their children, in scene units. */
  readonly error: number;
  /** Splats that draw the nodes. */
  readonly splatCount: number;
}

/** Facts about a divided part. The lists of its nodes stay in the worker. Can be posted. */
export interface PartFacts extends Pick<DividedPart, 'contained'> {
  /** Number of nodes without children. */
  readonly leafCount: number;
  readonly inner: readonly InnerNodes[];
  /** Of the scene. */
  readonly origin: Vec3;
}

/**
 * Divides a part of a tree.
 *
 * Rejects as `decodedPart`.
 */
export async function divideRadPart(
  { chunks, part }: { readonly chunks: RadChunks; readonly part: KeyedPart },
  turns: Turns,
): Promise<PartFacts> {
  const { divided, decoded } = await decodedPart(chunks, part, turns);
  const { leaves, inner, contained } = divided;
  return {
    leafCount: leaves.length,
    inner: inner.map(({ nodes, below }) => ({
      below: { ...below, starts: below.starts.slice(), counts: below.counts.slice() },
      ...factsOf(nodes, decoded, chunks.chunks),
    })),
    // Copies, because the result is transferred and the part is kept.
    contained: contained.slice(),
    origin: decoded[0].origin,
  };
}

const DIVIDED = new LastResults<DividedPart>(KEPT_BYTES, bytesOf);

/**
 * Divides a part, and keeps it for a while.
 *
 * Rejects as `decodedChunk` and `dividePart`.
 */
export async function decodedPart(
  { chunks, facts, tree }: RadChunks,
  part: KeyedPart,
  turns: Turns,
): Promise<{ readonly divided: DividedPart; readonly decoded: readonly DecodedChunk[] }> {
  const decoded: DecodedChunk[] = [];
  for (const chunk of chunks) decoded.push(await decodedChunk(chunk, facts, turns));
  const nodes = chunks.map(({ place: { base, count } }, i) => {
    const { childCounts, childStarts } = decoded[i];
    return { base, count, childCounts, childStarts };
  });
  const divided = await DIVIDED.get(part.key, async () => dividePart(part, nodes, tree));
  return { divided, decoded };
}

/** Bounding box of nodes, their error against their children, and their number of splats. */
function factsOf(
  nodes: Uint32Array,
  decoded: readonly DecodedChunk[],
  chunks: readonly PackedChunk[],
): Omit<InnerNodes, 'below'> {
  const [{ place: first }] = chunks;
  const { min, max } = emptyBounds();
  let areas = 0;
  let weighted = 0;
  let splatCount = 0;
  for (const node of nodes) {
    const at = Math.floor((node - first.base) / first.count);
    const { rows } = decoded[at];
    const i = node - chunks[at].place.base;
    const center = [0, 1, 2].map((axis) => rows.center(i, axis));
    const scale = rows.largestScale(i);
    splatCount += stackIn(decoded[at], i).opacities.length;
    if (!center.every(Number.isFinite) || !Number.isFinite(scale)) continue;
    areas += scale ** 2;
    weighted += scale ** 4;
    for (let axis = 0; axis < 3; axis++) {
      min[axis] = Math.min(min[axis], center[axis] - scale);
      max[axis] = Math.max(max[axis], center[axis] + scale);
    }
  }
  const bounds: Bounds = areas > 0 ? { min, max } : { min: [0, 0, 0], max: [0, 0, 0] };
  const error = areas > 0 ? Math.max(LEAST_ERROR, Math.sqrt(weighted / areas)) : LEAST_ERROR;
  return { bounds, error, splatCount };
}

function bytesOf({ leaves, inner, contained }: DividedPart): number {
  const ofInner = inner.map(({ nodes, below }) => nodes.byteLength + 2 * below.starts.byteLength);
  return ofInner.reduce((sum, bytes) => sum + bytes, leaves.byteLength + contained.byteLength);
}
