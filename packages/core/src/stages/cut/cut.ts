import { CHUNK_SPLATS } from '../../data/layout/constants.ts';
import { LEVEL_CONSTANTS } from '../../data/layout/level-structs.ts';
import { NARROW_SUBGROUP } from '../../gpu/device.ts';
import { computeStage, type StageDefinition } from '../../gpu/pipelines.ts';
import type { CullSplatsVariant } from '../cull/cull.ts';
import { levelTexts } from '../levels.ts';
import type { SortDevice } from '../sort/sort.ts';

/** Finds the threshold of each cell of a cloud, for each of up to `batchInstances` instances. */
export function cutCells(batchInstances = 1): StageDefinition {
  return computeStage('cut-cells', {
    later: levelTexts,
    constants: { ...LEVEL_CONSTANTS, BATCH_INSTANCES: batchInstances },
  });
}

/** Finds thresholds as `cutCells` does, and shifts them as the frame's budget asks. */
export function shiftCells(batchInstances = 1): StageDefinition {
  return { ...cutCells(batchInstances), conditions: { SHIFTED: true } };
}

/** Finds the least shift of a frame's thresholds that keeps its budget. */
export const planCut: StageDefinition = /* @__PURE__ */ computeStage('plan-cut', {
  later: levelTexts,
  constants: LEVEL_CONSTANTS,
});

type CountingDevice = Pick<SortDevice, 'isNarrow'>;

/**
 * Chunks per workgroup: few, so that all of a GPU has work; more if each thread works alone, with bins
 * of its own.
 */
function countedChunks({ isNarrow }: CountingDevice): number {
  return isNarrow ? 32 * NARROW_SUBGROUP : 16;
}

/**
 * Whether a frame counts the shifts near the last frame's first, and all of them only if it must. Wide
 * GPUs count all at once: a second count that has nothing to do takes them as long as it saves.
 */
export function countsInWindow({ isNarrow }: CountingDevice): boolean {
  return isNarrow;
}

/** Counts the splats and blobs of a page that a cut would draw, for each shift of its threshold. */
export function cutCount({
  geometryPrecision,
  culling,
  batchInstances = null,
  sortDevice,
}: Pick<CullSplatsVariant, 'geometryPrecision' | 'culling' | 'batchInstances'> & {
  readonly sortDevice: CountingDevice;
}): StageDefinition {
  return computeStage('cut-count', {
    later: levelTexts,
    conditions: {
      GEOMETRY_F32: geometryPrecision === 'f32',
      FRUSTUM_CULLING: culling === 'frustum',
      NARROW: sortDevice.isNarrow,
      INSTANCES: batchInstances !== null,
    },
    constants: {
      ...LEVEL_CONSTANTS,
      ...(batchInstances !== null && { BATCH_INSTANCES: batchInstances }),
      COUNTED_CHUNKS: countedChunks(sortDevice),
      COUNT_WORKGROUP: sortDevice.isNarrow ? NARROW_SUBGROUP : CHUNK_SPLATS,
    },
  });
}

/** Workgroups of cut-count for a page of `chunkCount` chunks. */
export function countWorkgroups(chunkCount: number, device: CountingDevice): number {
  return Math.ceil(chunkCount / countedChunks(device));
}

/**
 * Tells which splats or blobs of a page's visible chunks the cut goes through.
 *
 * @param batchInstances most instances that are drawn together; null: the page is drawn once.
 */
export function cutSplats(batchInstances: number | null = null): StageDefinition {
  return computeStage('cut-splats', {
    later: levelTexts,
    conditions: { INSTANCES: batchInstances !== null },
    constants: { ...LEVEL_CONSTANTS, ...(batchInstances !== null && { BATCH_INSTANCES: batchInstances }) },
  });
}

/** Workgroups of cut-splats for a page of `chunkCount` chunks, if all of them are visible. */
export function cutWorkgroups(chunkCount: number): number {
  return Math.ceil(chunkCount / 32);
}

/** Refines cuts around splats that are drawn one by one, in the cells of a page. */
export const touchLinks: StageDefinition = /* @__PURE__ */ computeStage('touch-links', {
  later: levelTexts,
  constants: LEVEL_CONSTANTS,
});

/** Refines cuts as `touchLinks` does, in the cells of a level above the chunks. */
export const touchUpperLinks: StageDefinition = { ...touchLinks, conditions: { UPPER: true } };

/** Tells the leaves of a cell whether the cells below them are on the GPU. */
export const openLeaves: StageDefinition = /* @__PURE__ */ computeStage('open-leaves', {
  later: levelTexts,
  constants: LEVEL_CONSTANTS,
});
