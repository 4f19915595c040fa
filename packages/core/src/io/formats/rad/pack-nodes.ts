import { NO_ROW, type SplatCells } from '../../../data/bricks/leaf-scene.ts';
import { SplatFileError } from '../../../data/errors.ts';
import type { Vec3 } from '../../../data/math/mat4.ts';
import { packCoefficients } from '../../../data/packing/harmonics.ts';
import { mortonOrder } from '../../../data/packing/morton-order.ts';
import { originOfSamples } from '../../../data/packing/origin.ts';
import { logitOf } from '../../../data/splats/color-values.ts';
import { ROW_SLOT } from '../../../data/splats/splat-row.ts';
import { coefficientsPerSplat } from '../../../data/splats/splat-set.ts';
import type { Turns } from '../../../data/turns.ts';
import { unpackedLimit } from '../../sources/read-limits.ts';
import { LastResults } from '../last-results.ts';
import { packPieces } from '../pack-pieces.ts';
import { type HarmonicsColumns, NodeRows, readPalette } from './node-rows.ts';
import { RadChunk } from './rad-chunk.ts';
import type { ChunkPlace, RadHeader } from './rad-header.ts';
import type { TreeNodes } from './tree-parts.ts';

/** Decoded chunks that a worker keeps, bytes: two chunks of degree 3. */
const KEPT_BYTES = 32 << 20;

/** A fetched chunk. Can be posted. */
export interface PackedChunk {
  /** Tells chunks apart, in all scenes of a thread. */
  readonly key: number;
  readonly bytes: Blob;
  readonly place: ChunkPlace;
  /** Name in messages. */
  readonly file: string;
}

/** Facts about a scene with which each of its chunks is decoded. Can be posted. */
export interface RadFacts extends Pick<RadHeader, 'shDegree' | 'paletteSize'> {
  /** The first chunk, which has the palette if there is one. */
  readonly first: PackedChunk;
  /** Null for the first chunk, which determines it. */
  readonly origin: Vec3 | null;
  /** See `ReadLimits`; undefined for the default. */
  readonly maxBytes: number | undefined;
}

/** Those values of a chunk's nodes by which the tree is divided into leaves. */
export interface ChunkNodes extends TreeNodes {
  readonly childCounts: Float32Array | Uint32Array;
  readonly childStarts: Float32Array | Uint32Array;
  /** x, y, z per node, relative to `origin`. */
  readonly centers: Float32Array;
  /** Largest standard deviation per node. */
  readonly scales: Float32Array;
  /** Splats that draw each node. */
  readonly copies: Uint8Array;
  /** Of the scene. */
  readonly origin: Vec3;
}

/**
 * Decodes a chunk, and keeps it for a while.
 *
 * Rejects with SplatFileError, and with the reason of the turns' signal.
 */
export async function readRadChunk(
  { chunk, facts }: { readonly chunk: PackedChunk; readonly facts: RadFacts },
  turns: Turns,
): Promise<ChunkNodes> {
  const decoded = await decodedChunk(chunk, facts, turns);
  const { childCounts, childStarts, rows, origin } = decoded;
  const { base, count } = chunk.place;
  const centers = new Float32Array(3 * count);
  const scales = new Float32Array(count);
  const copies = new Uint8Array(count);
  for (let i = 0; i < count; i++) {
    for (let axis = 0; axis < 3; axis++) centers[3 * i + axis] = rows.center(i, axis);
    scales[i] = rows.largestScale(i);
    copies[i] = stackIn(decoded, i).opacities.length;
  }
  // Copies, because the result is transferred.
  const tree = { base, count, childCounts: childCounts.slice(), childStarts: childStarts.slice() };
  return { ...tree, centers, scales, copies, origin };
}

/** Nodes of some consecutive chunks. Can be posted. */
export interface NodesToPack {
  readonly chunks: readonly PackedChunk[];
  readonly facts: RadFacts;
  /** Indices in the scene, of nodes to be packed together. */
  readonly lists: readonly Uint32Array[];
}

/**
 * Packs each list of nodes in Morton order; an inner node becomes a stack of several splats.
 *
 * Rejects as `readRadChunk`.
 */
export async function packRadNodes(
  { chunks, facts, lists }: NodesToPack,
  turns: Turns,
): Promise<SplatCells[][]> {
  const decoded: DecodedChunk[] = [];
  for (const chunk of chunks) decoded.push(await decodedChunk(chunk, facts, turns));
  const packed: SplatCells[][] = [];
  for (const nodes of lists) packed.push(await packNodes(nodes, decoded, chunks, facts, turns));
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

interface DecodedChunk {
  readonly childCounts: Float32Array | Uint32Array;
  readonly childStarts: Float32Array | Uint32Array;
  readonly rows: NodeRows;
  readonly origin: Vec3;
  readonly bytes: number;
}

const DECODED = new LastResults<DecodedChunk>(KEPT_BYTES, ({ bytes }) => bytes);
/** Of the last scene. */
const PALETTES = new LastResults<HarmonicsColumns | undefined>(0, () => 1);

function decodedChunk(chunk: PackedChunk, facts: RadFacts, turns: Turns): Promise<DecodedChunk> {
  return DECODED.get(chunk.key, async () => {
    const unpacked = await openChunk(chunk, facts, turns);
    const { count } = chunk.place;
    const childCounts = await unpacked.column('child_count', count);
    const childStarts = await unpacked.column('child_start', count);
    const palette = await paletteOf(facts, turns);
    const rows = await NodeRows.read(unpacked, count, facts.shDegree, palette, chunk.file);
    // The uppermost nodes approximate the whole scene.
    const origin = facts.origin ?? originOfSamples(rows.centers);
    rows.moveTo(origin);
    const bytes = rows.bytes + childCounts.byteLength + childStarts.byteLength;
    return { childCounts, childStarts, rows, origin, bytes };
  });
}

async function paletteOf(facts: RadFacts, turns: Turns): Promise<HarmonicsColumns | undefined> {
  const { first, paletteSize } = facts;
  if (paletteSize === undefined) return undefined;
  return PALETTES.get(first.key, async () => readPalette(await openChunk(first, facts, turns), facts));
}

async function openChunk(
  { bytes, place, file }: PackedChunk,
  { maxBytes }: RadFacts,
  turns: Turns,
): Promise<RadChunk> {
  const packed = new Uint8Array(await bytes.arrayBuffer());
  await turns.give();
  const limit = unpackedLimit({ maxBytes }, { totalBytes: packed.length });
  let unpackedBytes = 0;
  return new RadChunk(packed, place, file, (byteCount) => {
    unpackedBytes += byteCount;
    if (unpackedBytes <= limit) return;
    const message = `it unpacks to ${unpackedBytes} bytes or more, and ${limit} are the limit. Pass a larger maxBytes if that is right.`;
    throw new SplatFileError('too-large', file, message);
  });
}

/** Splats that draw a node: one for a node without children. */
function stackIn({ rows, childCounts }: DecodedChunk, i: number) {
  return stackOf(childCounts[i] > 0 ? rows.alpha(i) : Math.min(1, rows.alpha(i)));
}

/** Most splats per node. */
const MOST_COPIES = 4;

/** Coincident splats that draw an inner node. */
interface Stack {
  /** Opacities, from 0 to 1. */
  readonly opacities: readonly number[];
  /** Log of a factor on the scales. */
  readonly growth: number;
}

/**
 * Splats for a node with a stored opacity above 1, up to 2. Spark draws the opacity 1 − (1 − g)ⁿ,
 * where g is the node's Gaussian and n = exp(((4 · opacity − 3)² − 1) / e). This equals n stacked
 * splats of opacity 1; here, the last copy has the fractional part of n as opacity. Above four
 * copies, four larger ones cover the same area: n copies cover harmonic number of n times the area
 * of one.
 */
export function stackOf(opacity: number): Stack {
  if (!(opacity > 1)) return { opacities: [opacity], growth: 0 };
  const stacked = Math.exp(((4 * Math.min(opacity, 2) - 3) ** 2 - 1) / Math.E);
  const copies = Math.min(stacked, MOST_COPIES);
  const opacities = Array.from({ length: Math.ceil(copies) }, (_, i) => Math.min(1, copies - i));
  return { opacities, growth: Math.log(harmonicNumber(stacked) / harmonicNumber(copies)) / 2 };
}

/** ∫₀¹ (1 − tⁿ) / (1 − t) dt for n ≥ 1, to four digits. */
function harmonicNumber(n: number): number {
  return Math.log(n) + 0.5772156649 + 1 / (2 * n) - 1 / (12 * n * n) + 1 / (120 * n ** 4);
}
