import { chunkCountOf, chunksOf, logScalesOf, setLogScales } from '../../../data/packing/chunks.ts';
import { cloudFacts, isIsotropic } from '../../../data/packing/cloud-facts.ts';
import { putColumns } from '../../../data/packing/geometry.ts';
import {
  type PackedCloud,
  packedHarmonics,
  packStored,
  sampledBounds,
  totalBounds,
} from '../../../data/packing/packed-cloud.ts';
import { type CloudPrecision, ownShPrecision } from '../../../data/packing/precision.ts';
import type { SomeColumns, SplatSet } from '../../../data/splats/splat-set.ts';
import type { Turns } from '../../../data/turns.ts';
import { LastResults } from '../last-results.ts';
import {
  changedColumns,
  columnsOfSplats,
  decodeDifference,
  decodeKey,
  harmonicsOfSplats,
  type KeyFrame,
  type PackedFrame,
} from './decode-frame.ts';
import type { FrameColumn } from './frame-columns.ts';
import { COLUMN } from './frames-layout.ts';

/** A frame and its key frame, still compressed. Can be posted. */
export interface FrameBytes {
  /** Tells key frames apart, in all files of a thread. */
  readonly id: number;
  readonly key: PackedFrame;
  /** Null for a key frame. */
  readonly difference: PackedFrame | null;
  readonly facts: Pick<SplatSet, 'isAntialiased' | 'fileFacts'>;
}

/** A key frame, and the clouds that its frames are changes of. */
interface KeptKey {
  readonly key: KeyFrame;
  /** Packed, by precision. */
  readonly clouds: Map<string, PackedCloud>;
}

/** Decoded key frames that a thread keeps, bytes: one of half a million splats of degree 3. */
const KEPT_BYTES = 256 << 20;
/** A packed cloud takes no more than the columns and rotations that it is made of. */
const KEYS = new LastResults<KeptKey>(
  KEPT_BYTES,
  ({ key, clouds }) => 4 * key.splatCount * (key.columns.length + 8) * (1 + clouds.size),
);

/**
 * Decodes a frame and packs it for the GPU. Columns that are those of its key frame are
 * packed once for all frames.
 *
 * Rejects with SplatFileError for a damaged file, and with the reason of the turns' signal.
 */
export async function packFrame(
  { frame, precision }: { readonly frame: FrameBytes; readonly precision: CloudPrecision },
  turns: Turns,
): Promise<PackedCloud> {
  const { key, clouds, difference } = await decoded(frame);
  await turns.give();
  const { geometryPrecision } = precision;
  const shPrecision = ownShPrecision(precision.shPrecision);
  const packed = (of: readonly FrameColumn[] | null) => {
    const set = { ...columnsOfSplats(key, of), ...frame.facts, harmonics: harmonicsOfSplats(key, of) };
    const facts = cloudFacts(set);
    return packStored(
      { ...set, harmonics: packedHarmonics(set, facts, shPrecision) },
      facts,
      geometryPrecision,
    );
  };
  if (difference?.slice(COLUMN.harmonics).some((column) => column !== null)) return packed(difference);
  const name = `${geometryPrecision} ${shPrecision}`;
  const known = clouds.get(name) ?? packed(null);
  clouds.set(name, known);
  await turns.give();
  return changedCloud(known, changedColumns(key, difference));
}

/**
 * Returns a copy of a cloud in which some columns of all splats are others, in storage order. Packing
 * these alone is quicker than packing a cloud.
 *
 * @param columns log scales come with positions, because a chunk tells about both.
 */
export function changedCloud(cloud: PackedCloud, columns: SomeColumns): PackedCloud {
  const copy = structuredClone(cloud);
  const { count, origin, geometry, facts, robustBounds } = copy;
  const { positions, logScales } = columns;
  if (positions) {
    const chunks = chunksOf({ count, positions, logScales: logScales ?? positions });
    for (let chunk = 0; chunk < chunkCountOf(count) && !logScales; chunk++)
      setLogScales(chunks, chunk, logScalesOf(geometry.chunks, chunk));
    geometry.chunks.set(chunks);
  }
  putColumns(geometry, columns);
  return {
    ...copy,
    bounds: totalBounds(copy.chunks, origin),
    robustBounds: positions ? sampledBounds({ count, origin, positions }) : robustBounds,
    facts: logScales ? { ...facts, isIsotropic: isIsotropic({ count, logScales }) } : facts,
  };
}

/**
 * Decodes a frame.
 *
 * Rejects as `packFrame`.
 */
export async function readFrame({ frame }: { readonly frame: FrameBytes }): Promise<SplatSet> {
  const { key, difference } = await decoded(frame);
  return {
    ...columnsOfSplats(key, difference),
    ...frame.facts,
    harmonics: harmonicsOfSplats(key, difference),
  };
}

async function decoded({
  id,
  key: packedKey,
  difference,
}: FrameBytes): Promise<KeptKey & { readonly difference: readonly FrameColumn[] | null }> {
  const [kept, columns] = await Promise.all([
    KEYS.get(id, async () => ({ key: await decodeKey(packedKey), clouds: new Map() })),
    difference && decodeDifference(difference),
  ]);
  return { ...kept, difference: columns };
}
