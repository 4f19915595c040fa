import { type PackedMotion, packMotion } from '../../features/motion/pack-motion.data.ts';
import { given, type Members, wrongArgument } from '../given.ts';
import { CHUNK_WORDS } from '../layout/chunk-words.ts';
import type { Vec3 } from '../math/mat4.ts';
import { selectValue } from '../math/select-value.ts';
import { givenSet } from '../splats/check-set.ts';
import type { DropCounts, SplatColumns, SplatSet } from '../splats/splat-set.ts';
import { emptyBounds } from './center-bounds.ts';
import { checkPrecision } from './check-precision.ts';
import { type CloudFacts, cloudFacts } from './cloud-facts.ts';
import { type PackedGeometry, packGeometry } from './geometry.ts';
import { type Harmonics, isPacked, isPalette, type StoredHarmonics } from './harmonics.ts';
import { mortonOrder, permuteSplats } from './morton-order.ts';
import { type GeometryPrecision, ownShPrecision, type ShPrecision } from './precision.ts';
import { packHarmonics, packPalette, repackHarmonics, truncateHarmonics } from './repack-harmonics.ts';

/** An axis-aligned box, corners included. */
export interface Bounds {
  readonly min: Vec3;
  readonly max: Vec3;
}

/** Bounds that are moved by a vector. */
export function movedBounds({ min, max }: Bounds, [x, y, z]: Vec3): Bounds {
  return {
    min: [min[0] + x, min[1] + y, min[2] + z],
    max: [max[0] + x, max[1] + y, max[2] + z],
  };
}

/** Splats as they are uploaded: in storage order, packed, with bounds of each CHUNK_SPLATS. */
export interface PackedCloud {
  readonly count: number;
  /** Scene-space point that positions are relative to. */
  readonly origin: Vec3;
  /** Bounds of the centres, in scene space. */
  readonly bounds: Bounds;
  /** Bounds of the centres but the outermost 2 % at either end of each axis: where the scene is. */
  readonly robustBounds: Bounds;
  readonly geometry: PackedGeometry;
  /** Of degree `facts.trueShDegree`: bands above it cannot be seen and are left out. */
  readonly harmonics: StoredHarmonics;
  /** One `Chunk` struct per chunk. */
  readonly chunks: ArrayBuffer;
  /** N: each stored splat's row in its file. */
  readonly fileIndices: Uint32Array;
  /** How the splats move; null or absent if they stand still. */
  readonly motion?: PackedMotion | null;
  readonly dropped: DropCounts;
  /** Facts about the set before packing, with all of its bands. */
  readonly facts: CloudFacts;
}

const PACKED: Members = {
  count: 'a number',
  geometry: 'an object',
  harmonics: 'an object',
  chunks: 'an ArrayBuffer',
  fileIndices: 'a typed array',
  facts: 'an object',
};

/** Precisions in which `packCloud` packs. */
export interface PackOptions {
  readonly geometryPrecision: GeometryPrecision;
  /**
   * Default: the precision of the set's harmonics; f32 if they are as trained. Harmonics that are a
   * palette stay one, even if another precision is wanted: nothing would be finer, and little
   * smaller. Others become none: they are packed as u8 then.
   */
  readonly shPrecision?: ShPrecision;
}

/**
 * Arranges `set`, which may have any order, in storage order and packs it. Takes about a second per
 * two million splats.
 *
 * @throws InvalidArgumentError for a precision that there is not.
 * @example
 * const packed = packCloud(await readSplats('/garden.ply'), { geometryPrecision: 'packed', shPrecision: 'u8' });
 * const cloud = engine.addPacked(packed);
 */
export function packCloud(set: SplatSet<Harmonics>, options: PackOptions): PackedCloud {
  givenSet(set);
  const { geometryPrecision, shPrecision = precisionOf(set.harmonics) } = given(options);
  checkPrecision({ geometryPrecision, shPrecision });
  const facts = cloudFacts(set);
  const harmonics = packedHarmonics(set, facts, shPrecision);
  const stored = permuteSplats({ ...set, harmonics }, mortonOrder(set.positions, set.count));
  return packStored(stored, facts, geometryPrecision);
}

/** Packs splats that are in storage order, with harmonics as a cloud stores them. */
export function packStored(
  stored: SplatSet<StoredHarmonics>,
  facts: CloudFacts,
  geometryPrecision: GeometryPrecision,
): PackedCloud {
  const geometry = packGeometry(stored, geometryPrecision);
  const chunks = geometry.chunks.buffer;
  const bounds = totalBounds(chunks, stored.origin);
  return {
    count: stored.count,
    origin: stored.origin,
    bounds,
    robustBounds: stored.count > 0 ? sampledBounds(stored) : bounds,
    geometry,
    harmonics: stored.harmonics,
    chunks,
    fileIndices: stored.fileIndices,
    motion: packMotion(stored),
    dropped: stored.dropped,
    facts,
  };
}

function precisionOf(harmonics: Harmonics): ShPrecision {
  return isPacked(harmonics) ? harmonics.precision : 'f32';
}

/**
 * Leaves out bands that cannot be seen before it packs the others, so that these get the whole
 * range of a byte and no work is wasted.
 */
export function packedHarmonics(
  { harmonics, count }: SplatSet<Harmonics>,
  { shBandReach: bandReach, trueShDegree }: CloudFacts,
  precision: ShPrecision,
): StoredHarmonics {
  if (isPalette(harmonics)) return packPalette(harmonics, trueShDegree);
  const packed = isPacked(harmonics) ? harmonics : packHarmonics(harmonics);
  const kept = truncateHarmonics({ ...packed, bandReach }, count, trueShDegree);
  return repackHarmonics(kept, count, ownShPrecision(precision));
}

/** @throws InvalidArgumentError naming the member that `packed` lacks, for callers without types. */
export function checkPacked(packed: PackedCloud): void {
  const { geometry, harmonics, motion } = given(packed, PACKED, 'packed');
  const geometryMembers = { words: 'a typed array', chunks: 'a typed array', precision: 'a string' } as const;
  given(geometry, geometryMembers, 'packed.geometry');
  given(harmonics, { degree: 'a number', precision: 'a string' }, 'packed.harmonics');
  if (motion == null) return;
  given(motion, { range: 'a list', words: 'a typed array', reaches: 'a typed array' }, 'packed.motion');
  const { range } = motion;
  if (!(range[0] < range[1])) throw wrongArgument('packed.motion.range', range, 'two times in order');
}

/**
 * The buffers of `cloud`, for posting it to another thread without a copy.
 *
 * @example
 * // In a worker.
 * const packed = packCloud(await readSplats('/garden.ply'), { geometryPrecision: 'packed' });
 * postMessage(packed, { transfer: transferablesOf(packed) });
 */
export function transferablesOf(packed: PackedCloud): ArrayBuffer[] {
  checkPacked(packed);
  const { geometry, harmonics, chunks, fileIndices, motion } = packed;
  const colors = isPalette(harmonics) ? harmonics.entries : harmonics.words;
  const buffers = [geometry.words.buffer, colors.buffer, chunks, fileIndices.buffer];
  if (isPalette(harmonics)) buffers.push(harmonics.indices.buffer);
  if (motion) buffers.push(motion.words.buffer, motion.reaches.buffer);
  return buffers as ArrayBuffer[];
}

/** Bounds of all centres in scene space: the union of the chunks' bounds, moved by `origin`. */
export function totalBounds(chunks: ArrayBuffer, origin: Vec3): Bounds {
  const values = new Float32Array(chunks);
  const { min, max } = emptyBounds();
  for (let at = 0; at < values.length; at += CHUNK_WORDS.count) {
    for (let axis = 0; axis < 3; axis++) {
      min[axis] = Math.min(min[axis], values[at + CHUNK_WORDS.minPosition + axis] + origin[axis]);
      max[axis] = Math.max(max[axis], values[at + CHUNK_WORDS.maxPosition + axis] + origin[axis]);
    }
  }
  return { min, max };
}

/** Captures scatter a few splats far around the scene: this fraction at either end. */
const OUTER_PART = 0.02;
/** Splats sampled for quantiles, evenly spread over the storage order and so over space. */
const SAMPLES = 1 << 16;

/** Indices of the splats, in storage order, that robust bounds are taken from. */
export function boundsSamples(count: number): Uint32Array<ArrayBuffer> {
  const step = boundsStep(count);
  return Uint32Array.from({ length: Math.ceil(count / step) }, (_, i) => i * step);
}

/** Robust bounds are taken from one splat of so many, in storage order. */
export function boundsStep(count: number): number {
  return Math.max(1, Math.floor(count / SAMPLES));
}

/** Bounds of most sampled centres, scene space. @param axes their x, y and z about `origin`. */
export function robustBounds(axes: readonly Float32Array[], origin: Vec3): Bounds {
  const [x, y, z] = axes.map((samples, axis) => {
    const values = samples.slice();
    const outer = Math.floor(OUTER_PART * (values.length - 1));
    const low = selectValue(values, outer);
    return [low + origin[axis], selectValue(values, values.length - 1 - outer) + origin[axis]];
  });
  return { min: [x[0], y[0], z[0]], max: [x[1], y[1], z[1]] };
}

/** Bounds of most centres, scene space. */
export function sampledBounds({
  count,
  positions,
  origin,
}: Pick<SplatColumns, 'count' | 'positions' | 'origin'>): Bounds {
  const samples = boundsSamples(count);
  const axes = [0, 1, 2].map((axis) => {
    const values = new Float32Array(samples.length);
    for (let k = 0; k < values.length; k++) values[k] = positions[3 * samples[k] + axis];
    return values;
  });
  return robustBounds(axes, origin);
}
