import { type CloudFacts, cloudFacts } from '../../../data/packing/cloud-facts.ts';
import type { PackedHarmonics } from '../../../data/packing/harmonics.ts';
import { type PackedCloud, packedHarmonics, packStored } from '../../../data/packing/packed-cloud.ts';
import { type CloudPrecision, type OwnShPrecision, ownShPrecision } from '../../../data/packing/precision.ts';
import type { SplatSet } from '../../../data/splats/splat-set.ts';
import type { Turns } from '../../../data/turns.ts';
import { LastResults } from '../last-results.ts';
import {
  columnsOfSplats,
  decodeDifference,
  decodeKey,
  harmonicsOfSplats,
  type KeyFrame,
  type PackedFrame,
} from './decode-frame.ts';
import type { Column } from './frame-columns.ts';
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

/** A key frame, with its harmonics packed for the frames that share them. */
interface KeptKey {
  readonly key: KeyFrame;
  readonly shared: Map<OwnShPrecision, { readonly harmonics: PackedHarmonics; readonly facts: CloudFacts }>;
}

/** Decoded key frames that a thread keeps, bytes: one of half a million splats of degree 3. */
const KEPT_BYTES = 160 << 20;
const KEYS = new LastResults<KeptKey>(KEPT_BYTES, ({ key, shared }) => {
  const columns = key.columns.reduce((sum, column) => sum + (column?.byteLength ?? 0), 0);
  const words = [...shared.values()].reduce((sum, { harmonics }) => sum + harmonics.words.byteLength, 0);
  return columns + key.rotations.byteLength + words;
});

/**
 * Decodes a frame and packs it for the GPU.
 *
 * Rejects with SplatFileError for a damaged file, and with the reason of the turns' signal.
 */
export async function packFrame(
  { frame, precision }: { readonly frame: FrameBytes; readonly precision: CloudPrecision },
  turns: Turns,
): Promise<PackedCloud> {
  const { key, shared, difference } = await decoded(frame);
  await turns.give();
  const columns = { ...columnsOfSplats(key, difference), ...frame.facts };
  await turns.give();
  const shPrecision = ownShPrecision(precision.shPrecision);
  const isShared = !difference?.slice(COLUMN.harmonics).some((column) => column !== null);
  const known = isShared ? shared.get(shPrecision) : undefined;
  if (known) {
    const { declaredShDegree, shBandReach } = known.facts;
    // Copied, because the result is transferred.
    const harmonics = { ...known.harmonics, words: known.harmonics.words.slice() };
    const facts = { ...cloudFacts({ ...columns, harmonics }), declaredShDegree, shBandReach };
    return packStored({ ...columns, harmonics }, facts, precision.geometryPrecision);
  }
  const set = { ...columns, harmonics: harmonicsOfSplats(key, difference) };
  const facts = cloudFacts(set);
  await turns.give();
  const harmonics = packedHarmonics(set, facts, shPrecision) as PackedHarmonics;
  if (isShared)
    shared.set(shPrecision, { harmonics: { ...harmonics, words: harmonics.words.slice() }, facts });
  return packStored({ ...columns, harmonics }, facts, precision.geometryPrecision);
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
}: FrameBytes): Promise<KeptKey & { readonly difference: readonly Column[] | null }> {
  const [kept, columns] = await Promise.all([
    KEYS.get(id, async () => ({ key: await decodeKey(packedKey), shared: new Map() })),
    difference && decodeDifference(difference),
  ]);
  return { ...kept, difference: columns };
}
