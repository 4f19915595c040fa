import type { Culling, Extent } from '../../data/accuracy/accuracy.ts';
import { CHUNK_SPLATS, SCAN_BLOCK } from '../../data/layout/constants.ts';
import { LEVEL_CONSTANTS } from '../../data/layout/level-structs.ts';
import { ScanParameters } from '../../data/layout/structs.ts';
import type { GeometryPrecision } from '../../data/packing/precision.ts';
import { NARROW_SUBGROUP } from '../../gpu/device.ts';
import { type EffectSet, geometryEffects, hasHook, NO_EFFECTS } from '../../gpu/effects/effect-set.ts';
import type { GpuMemory } from '../../gpu/gpu-memory.ts';
import { type Dispatch, dispatchOf } from '../../gpu/passes.ts';
import { computeStage, type Pipelines, type StageDefinition } from '../../gpu/pipelines.ts';
import { dispatchSize } from '../dispatch.ts';
import { engineTexts } from '../family-texts.ts';
import { levelTexts } from '../levels.ts';
import type { SortDevice } from '../sort/sort.ts';

/** Variant of the cull-splats stage to link. */
export interface CullSplatsVariant {
  readonly isOrthographic: boolean;
  readonly geometryPrecision: GeometryPrecision;
  readonly extent: Extent;
  readonly culling: Culling;
  /** Whether splats are sorted by distance from the camera, not by depth; default false. */
  readonly sortsByDistance?: boolean;
  /** Effects of the page's cloud; default none. */
  readonly effects?: EffectSet;
  /** Whether all splats are balls, even after effects; default false. */
  readonly isIsotropic?: boolean;
  /** Whether splats may be merged ones, with opacities above 1; default false. */
  readonly isStacked?: boolean;
  /** Whether a cut decides which splats are drawn; default false. */
  readonly hasLevels?: boolean;
  /** Whether splats are blobs whose opacity follows dilation; default false. */
  readonly isDilated?: boolean;
  /** Most instances that are drawn together; null: the page is drawn once. Default null. */
  readonly batchInstances?: number | null;
  /** Default: any. */
  readonly sortDevice?: Pick<SortDevice, 'isNarrow'>;
}

/** Tests each splat of a page's visible chunks. */
export function cullSplats(variant: CullSplatsVariant): StageDefinition {
  const { extent, culling, effects = NO_EFFECTS } = variant;
  // Colours are not known yet.
  const acting = geometryEffects(effects);
  const isNarrow = variant.sortDevice?.isNarrow === true;
  const { batchInstances = null } = variant;
  const isPacked = variant.geometryPrecision === 'packed';
  return computeStage('cull-splats', {
    texts: engineTexts,
    ...((variant.isDilated || batchInstances !== null) && { later: levelTexts }),
    conditions: {
      NARROW: isNarrow,
      ORTHOGRAPHIC: variant.isOrthographic,
      GEOMETRY_F32: !isPacked,
      FRUSTUM_CULLING: culling === 'frustum',
      DISTANCE_ORDER: variant.sortsByDistance === true,
      ISOTROPIC: variant.isIsotropic === true,
      FIXED_EXTENT: culling !== 'frustum' && extent === 'fixed',
      STACKED: culling !== 'frustum' && variant.isStacked === true,
      LEVELS: variant.hasLevels === true,
      DILATED: variant.isDilated === true,
      INSTANCES: batchInstances !== null,
      SPLAT_EFFECTS: hasHook(acting, 'splat'),
      OPACITY_EFFECTS: hasHook(acting, 'opacity'),
    },
    effects: acting,
    constants: {
      CULL_WORKGROUP: isNarrow ? NARROW_SUBGROUP : CHUNK_SPLATS,
      ...(batchInstances !== null && { BATCH_INSTANCES: batchInstances }),
      ...(variant.isDilated && { MOST_OPACITY: LEVEL_CONSTANTS.MOST_OPACITY }),
    },
  });
}

/**
 * Tests each chunk of a page, or of all instances of a page, against the frustum; with levels, also
 * whether the cut goes through it.
 */
export function cullChunks({
  hasLevels = false,
  batchInstances = null,
}: Pick<CullSplatsVariant, 'hasLevels' | 'batchInstances'> = {}): StageDefinition {
  const isInstanced = batchInstances !== null;
  return computeStage('cull-chunks', {
    texts: engineTexts,
    ...((hasLevels || isInstanced) && { later: levelTexts }),
    conditions: { LEVELS: hasLevels, INSTANCES: isInstanced },
    constants: {
      ...(hasLevels && LEVEL_CONSTANTS),
      ...(isInstanced && { BATCH_INSTANCES: batchInstances }),
    },
  });
}

/** Lists the visible chunks of the frame in storage order. */
export const compactChunks: StageDefinition = /* @__PURE__ */ computeStage('compact-chunks', {
  texts: engineTexts,
});

/** Lists the visible splats of the frame in storage order. */
export const compactSplats: StageDefinition = /* @__PURE__ */ computeStage('compact-splats', {
  texts: engineTexts,
});

/** Sizes the dispatches over the visible chunks. */
export const planCull: StageDefinition = /* @__PURE__ */ computeStage('plan-cull', { texts: engineTexts });

/** Few threads scan a block where few run in lockstep: waiting for each other takes long there. */
const NARROW_SCAN = { SCAN_WORKGROUP: 8, SCAN_ITEMS: SCAN_BLOCK / 8 };

/** The stages of a `PrefixScan` on devices whose `hasNarrowSubgroups` is `isNarrow`. */
export function prefixScanStages(isNarrow: boolean): readonly StageDefinition[] {
  return ['reduceBlocks', 'scanBlocks', 'scanSingleBlock'].map((entryPoint) => ({
    stage: 'prefix-scan',
    texts: engineTexts,
    entryPoint,
    constants: isNarrow ? NARROW_SCAN : {},
  }));
}

/** An exclusive prefix scan in place: n counts become n + 1 sums, the total last. */
export class PrefixScan {
  readonly dispatches: readonly Dispatch[];

  /**
   * @param memory a part of its own, whose owner frees it.
   * @param values a buffer with room for maxCount + 1 words.
   * @param inputCount one word on the GPU: the number of counts, at most `maxCount`.
   * @throws GpuLimitError
   */
  constructor(
    device: GPUDevice,
    pipelines: Pipelines,
    memory: GpuMemory,
    options: {
      label: string;
      values: GPUBuffer;
      inputCount: GPUBuffer;
      maxCount: number;
      dispatchRow: number;
      isNarrow: boolean;
    },
  ) {
    let { values, inputCount, maxCount } = options;
    const [reduceBlocks, scanBlocks, scanSingleBlock] = prefixScanStages(options.isNarrow);
    const { STORAGE, UNIFORM, COPY_DST } = GPUBufferUsage;
    const reductions: Dispatch[] = [];
    const scans: Dispatch[] = [];
    for (let level = 0; ; level++) {
      const blockCount = Math.ceil((maxCount + 1) / SCAN_BLOCK);
      const label = `${options.label} scan level ${level}`;
      const parameters = memory.createBuffer(`${label} parameters`, ScanParameters.bytes, UNIFORM | COPY_DST);
      const contents = ScanParameters.pack({ blockCount, dispatchRow: options.dispatchRow });
      device.queue.writeBuffer(parameters, 0, contents);
      const blockSums = memory.createBuffer(`${label} block sums`, 4 * (blockCount + 1), STORAGE | COPY_DST);
      const size = dispatchSize(blockCount, options.dispatchRow);
      const reduction = dispatchOf(
        pipelines,
        reduceBlocks,
        { parameters, inputCount, values, blockSums },
        size,
      );
      const scan = blockCount === 1 ? scanSingleBlock : scanBlocks;
      scans.unshift({ ...reduction, pipeline: pipelines.compute(scan)! });
      if (blockCount === 1) break;
      reductions.push(reduction);
      // The next level scans this level's block sums; their number never changes.
      values = blockSums;
      maxCount = blockCount;
      inputCount = memory.createBuffer(`${label} block count`, 4, STORAGE | COPY_DST);
      device.queue.writeBuffer(inputCount, 0, Uint32Array.of(blockCount));
    }
    this.dispatches = [...reductions, ...scans];
  }
}
