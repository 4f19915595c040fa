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

/** A cloud of a case, after reading. */
export interface PlacedSet {
  readonly set: SplatSet<Harmonics>;
  readonly modelMatrix?: ArrayLike<number>;
}

/** One frame of a case. */
export interface CaseFrame {
  readonly caseName: string;
  readonly cameraName: string;
  readonly camera: Camera;
  readonly clouds: readonly PlacedSet[];
  readonly widthPx: number;
  readonly heightPx: number;
}

/** How the stages of a frame are compared with their references. */
export interface StageCheck {
  readonly preset: AccuracyPreset;
  readonly keyBits: number;
}

/** One pass of the sort leaves the keys as `project` wrote them, for comparison with records. */
const ONE_PASS_KEY_BITS = 8;

/**
 * With float32 and with packed geometry, and the order of keys that all sort passes have moved: of
 * float32, and of float64.
 */
export const STAGE_CHECKS: readonly StageCheck[] = [
  { preset: 'reference', keyBits: ONE_PASS_KEY_BITS },
  { preset: 'balanced', keyBits: ONE_PASS_KEY_BITS },
  { preset: 'reference', keyBits: 32 },
  { preset: 'reference', keyBits: 64 },
];

/**
 * Compares each stage of a frame with its float64 reference; keys of several passes by their order
 * alone.
 */
export async function checkStages(
  watched: WatchedDevice,
  variant: RunVariant,
  caseFrame: CaseFrame,
  { preset, keyBits }: StageCheck,
  result: ResultBuilder,
): Promise<void> {
  const isOnePass = keyBits === ONE_PASS_KEY_BITS;
  const where = [
    caseFrame.caseName,
    `camera ${caseFrame.cameraName}`,
    isOnePass ? preset : `keys of ${keyBits} bits`,
  ];
  await inspect(watched, variant, caseFrame, preset, keyBits, async (frame) => {
    if (isOnePass) {
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
        result.addStage({ ...error, camera: caseFrame.cameraName, preset });
      }
      if (firstBad) result.fail(where, `${describeFieldError(firstBad)} (${badCount} values differ)`);
    }
    for (const flaw of await compareOrder(frame)) result.fail(where, flaw);
    if (isOnePass) for (const found of await findNonFinite(frame)) result.fail(where, found);
  });
}

async function inspect(
  watched: WatchedDevice,
  variant: RunVariant,
  { clouds, camera, widthPx, heightPx }: CaseFrame,
  preset: AccuracyPreset,
  keyBits: number,
  check: (frame: InspectedFrame) => Promise<void>,
): Promise<void> {
  // The preset as this device supports it: not every device blends in float32.
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
    // Of keys of several passes, only the order is compared.
    isDrawn: keyBits === ONE_PASS_KEY_BITS,
  });
  try {
    await check(frame);
  } finally {
    frame.destroy();
  }
}
