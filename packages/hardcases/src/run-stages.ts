import type { AccuracyPreset, Camera, Harmonics, SplatSet } from '@websplatter/core';
import {
  compareCulling,
  compareOrder,
  compareRecords,
  describeFieldError,
  findNonFinite,
  InspectedFrame,
} from '@websplatter/core/inspect';
import type { RunVariant, WatchedDevice } from './run-device.ts';
import type { ResultBuilder } from './run-result.ts';

/** A case's clouds as they were read. */
export interface PlacedSet {
  readonly set: SplatSet<Harmonics>;
  readonly modelMatrix?: ArrayLike<number>;
}

/** One picture of a case. */
export interface CasePicture {
  readonly caseName: string;
  readonly cameraName: string;
  readonly camera: Camera;
  readonly clouds: readonly PlacedSet[];
  readonly widthPx: number;
  readonly heightPx: number;
}

/** The presets whose stages are held against their twins: float32 and packed geometry, which are all there is. */
const STAGE_PRESETS = ['reference', 'balanced'] as const;
/** One pass: the keys stay as `project` wrote them. */
const ONE_PASS_KEY_BITS = 8;

/** Holds every stage of the picture against its float64 twin. */
export async function checkStages(
  watched: WatchedDevice,
  variant: RunVariant,
  picture: CasePicture,
  result: ResultBuilder,
): Promise<void> {
  for (const preset of STAGE_PRESETS) {
    await inspect(watched, variant, picture, preset, ONE_PASS_KEY_BITS, async (frame) => {
      const where = [picture.caseName, `camera ${picture.cameraName}`, preset];
      const culling = await compareCulling(frame);
      result.unsureSplats += culling.unsureCount;
      for (const flaw of culling.flaws) result.fail(where, flaw);
      const [first] = culling.mismatches;
      if (first) {
        const { cloudIndex, splatIndex, expected, got } = first;
        const more = `${culling.mismatches.length} splats differ`;
        result.fail(
          where,
          `cloud ${cloudIndex}, splat ${splatIndex}: got ${got}, expected ${expected} (${more})`,
        );
      }
      const { worst, firstBad, badCount } = await compareRecords(frame);
      for (const error of Object.values(worst)) {
        result.addStage({ ...error, camera: picture.cameraName, preset });
      }
      if (firstBad) result.fail(where, `${describeFieldError(firstBad)} (${badCount} values differ)`);
      for (const flaw of await compareOrder(frame)) result.fail(where, flaw);
      for (const found of await findNonFinite(frame)) result.fail(where, found);
    });
  }
  await inspect(watched, variant, picture, 'reference', 32, async (frame) => {
    const where = [picture.caseName, `camera ${picture.cameraName}`, 'keys of 32 bits'];
    for (const flaw of await compareOrder(frame)) result.fail(where, flaw);
  });
}

async function inspect(
  watched: WatchedDevice,
  variant: RunVariant,
  { clouds, camera, widthPx, heightPx }: CasePicture,
  preset: AccuracyPreset,
  keyBits: number,
  check: (frame: InspectedFrame) => Promise<void>,
): Promise<void> {
  // What the engine makes of the preset on this device: not every one blends in float32.
  const { accuracy } = await watched.engine(preset, variant);
  const frame = await InspectedFrame.draw(watched.device, {
    clouds,
    camera,
    widthPx,
    heightPx,
    accuracy,
    dispatchRow: watched.dispatchRow(variant),
    keyBits,
    pipelines: watched.pipelines(variant),
  });
  try {
    await check(frame);
  } finally {
    frame.destroy();
  }
}
