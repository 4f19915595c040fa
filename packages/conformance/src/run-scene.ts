import {
  type AccuracyPreset,
  type DropCounts,
  type DropReason,
  type FrameRasterizer,
  readSplats,
} from '@websplatter/core';
import type { ReferenceImage, renderReference } from '@websplatter/core/reference';
import type { DeviceCase, HardCloud, SceneCase } from './hard-case.ts';
import type { RunVariant, WatchedDevice } from './run-device.ts';
import { CaseViews, checkImage, drawFrames, firstDifference, minPsnrOf } from './run-images.ts';
import type { ResultBuilder } from './run-result.ts';
import { type CaseFrame, checkStages, type PlacedSet, STAGE_CHECKS } from './run-stages.ts';

export interface SceneRun {
  readonly watched: WatchedDevice;
  /** Returns another device on the same GPU, made at the first call. */
  readonly secondDevice: () => Promise<WatchedDevice>;
  readonly variant: RunVariant;
  /** Whether the GPU blends halves by truncation. */
  readonly isTruncating: boolean;
  readonly presets: readonly AccuracyPreset[];
  readonly rasterizers: readonly FrameRasterizer[];
  /** Width and height of images for cases that give no size. */
  readonly sizePx: number;
  /** Which images are drawn again, to see that they do not differ. */
  readonly repeats: 'all' | 'few';
  /** Tells which of the checks are made that take turns; undefined for all. */
  readonly turn: number | undefined;
  readonly endsAtFailure: boolean;
  readonly renderReference: typeof renderReference;
}

/** Cases with at least this many frames must give the same image on a second device too. */
const FRAMES_FOR_SECOND_DEVICE = 100;
const DEFAULT_FRAMES = 2;
/** Most frames of an image where few are drawn again. */
const FEW_FRAMES = 20;

/** Runs a scene: checks reading, then stages and images for each of its cameras. */
export async function runScene(
  hardCase: SceneCase | DeviceCase,
  run: SceneRun,
  result: ResultBuilder,
): Promise<void> {
  const clouds = await Promise.all(hardCase.clouds().map(readCloud));
  const truth = hardCase.truth ? await Promise.all(hardCase.truth().map(readCloud)) : clouds;
  const { widthPx, heightPx } = hardCase.size ?? { widthPx: run.sizePx, heightPx: run.sizePx };
  // An image without pixels has no aspect ratio: any will do.
  const aspect = widthPx / heightPx || 1;
  const views = new CaseViews(clouds);
  try {
    await checkDropped(hardCase, run, views, result);
    for (const [index, [cameraName, camera]] of Object.entries(hardCase.cameras(aspect)).entries()) {
      const caseFrame = { caseName: hardCase.name, cameraName, camera, clouds, widthPx, heightPx };
      const turn = run.turn === undefined ? undefined : run.turn + index;
      const isDone = () => run.endsAtFailure && result.failures.length > 0;
      if (widthPx * heightPx > 0)
        for (const check of inTurn(STAGE_CHECKS, turn)) {
          if (isDone()) return;
          await checkStages(run.watched, run.variant, caseFrame, check, result);
        }
      if (isDone()) return;
      const reference = () => run.renderReference({ ...caseFrame, clouds: truth });
      const turns = { ...run, rasterizers: inTurn(run.rasterizers, turn) };
      await checkImages(hardCase, turns, views, caseFrame, reference, result);
      if (isDone()) return;
    }
  } finally {
    views.destroy();
  }
}

/** The one of `all` whose turn it is; all of them where there are no turns. */
function inTurn<T>(all: readonly T[], turn: number | undefined): readonly T[] {
  return turn === undefined ? all : [all[turn % all.length]];
}

export async function readCloud(cloud: HardCloud): Promise<PlacedSet> {
  if ('set' in cloud) return cloud;
  const set = await readSplats(cloud.file, { shPrecision: 'f32' });
  return { set, modelMatrix: cloud.modelMatrix };
}

/** Checks which splats the engine reports as dropped. */
async function checkDropped(
  { name, dropped: expected = {} }: SceneCase | DeviceCase,
  { watched, variant }: SceneRun,
  views: CaseViews,
  result: ResultBuilder,
): Promise<void> {
  const engine = await watched.engine('reference', variant);
  const dropped: { [Reason in DropReason]?: number } = {};
  for (const { cloud } of views.instances(engine)) {
    for (const [reason, count] of Object.entries(cloud.dropped) as [DropReason, number][])
      dropped[reason] = (dropped[reason] ?? 0) + count;
  }
  result.dropped = dropped;
  if (countsText(dropped) !== countsText(expected))
    result.fail([name], `left out ${countsText(dropped)}, expected ${countsText(expected)}`);
}

function countsText(counts: DropCounts): string {
  const entries = Object.entries(counts).filter(([, count]) => count > 0);
  return entries.length === 0
    ? 'nothing'
    : entries
        .map((entry) => entry.join(': '))
        .sort()
        .join(', ');
}

async function checkImages(
  hardCase: SceneCase | DeviceCase,
  run: SceneRun,
  views: CaseViews,
  caseFrame: CaseFrame,
  renderTruth: () => ReferenceImage,
  result: ResultBuilder,
): Promise<void> {
  const isCompared = hardCase.decidesAtThreshold === undefined && caseFrame.widthPx * caseFrame.heightPx > 0;
  const reference = isCompared ? renderTruth() : null;
  const { identicalFrames = run.repeats === 'all' ? DEFAULT_FRAMES : 1 } = hardCase;
  for (const preset of run.presets) {
    const engine = await run.watched.engine(preset, run.variant);
    const { colorTarget } = engine.accuracy;
    for (const rasterizer of run.rasterizers) {
      const minPsnrDb = minPsnrOf(hardCase, {
        preset,
        rasterizer,
        colorTarget,
        isTruncating: run.isTruncating,
      });
      // Images without a bound are only reported: one rasteriser's suffice, in half the time.
      if (minPsnrDb === null && rasterizer !== run.rasterizers[0]) continue;
      const where = [caseFrame.caseName, `camera ${caseFrame.cameraName}`, preset, rasterizer];
      const fail = (what: string) => result.fail(where, what);
      // Ties come out differently for the same reasons at every preset and, since both rasterisers
      // draw in the order of one sort, with each of them: many frames of one suffice.
      const isFirst = preset === run.presets[0] && rasterizer === run.rasterizers[0];
      const most = isFirst ? identicalFrames : DEFAULT_FRAMES;
      const frames = run.repeats === 'all' ? most : Math.min(most, isFirst ? FEW_FRAMES : 1);
      const data = await drawFrames(views, engine, caseFrame, { preset, rasterizer }, frames, fail);
      checkImage(minPsnrDb, preset, rasterizer, caseFrame, data, reference, result);
      if (preset === run.presets[0] && identicalFrames >= FRAMES_FOR_SECOND_DEVICE)
        await checkSecondDevice(run, views, preset, rasterizer, caseFrame, data, fail);
    }
  }
}

async function checkSecondDevice(
  { secondDevice, variant }: SceneRun,
  views: CaseViews,
  preset: AccuracyPreset,
  rasterizer: FrameRasterizer,
  caseFrame: CaseFrame,
  first: Float32Array,
  fail: (what: string) => void,
): Promise<void> {
  const second = await secondDevice();
  const data = await drawFrames(
    views,
    await second.engine(preset, variant),
    caseFrame,
    { preset, rasterizer },
    1,
    fail,
  );
  const at = firstDifference(first, data);
  if (at >= 0) fail(`on a second device value ${at}: got ${data[at]}, the first device had ${first[at]}`);
  for (const error of await second.takeErrors()) fail(`on a second device: ${error}`);
}
