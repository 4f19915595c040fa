import { SplatFileError } from '../../../data/errors.ts';
import type { Vec3 } from '../../../data/math/mat4.ts';
import { originOfSamples } from '../../../data/packing/origin.ts';
import type { Turns } from '../../../data/turns.ts';
import { unpackedLimit } from '../../sources/read-limits.ts';
import { LastResults } from '../last-results.ts';
import { type HarmonicsColumns, NodeRows, readPalette } from './node-rows.ts';
import { RadChunk } from './rad-chunk.ts';
import type { ChunkPlace, RadHeader } from './rad-header.ts';

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

/** The nodes of a chunk. */
export interface DecodedChunk {
  readonly childCounts: Float32Array | Uint32Array;
  readonly childStarts: Float32Array | Uint32Array;
  readonly rows: NodeRows;
  readonly origin: Vec3;
  readonly bytes: number;
}

const DECODED = new LastResults<DecodedChunk>(KEPT_BYTES, ({ bytes }) => bytes);
/** Of the last scene. */
const PALETTES = new LastResults<HarmonicsColumns | undefined>(0, () => 1);

/**
 * Decodes a chunk, and keeps it for a while.
 *
 * Rejects with SplatFileError, and with the reason of the turns' signal.
 */
export function decodedChunk(chunk: PackedChunk, facts: RadFacts, turns: Turns): Promise<DecodedChunk> {
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
export function stackIn({ rows, childCounts }: DecodedChunk, i: number) {
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
