import { maxColor } from '../data/accuracy/accuracy.ts';
import { SHADER_CONSTANTS } from '../data/layout/constants.ts';
import { BLOB_PRECISION } from '../data/packing/precision.ts';
import { antialias } from '../gpu/effects/antialias/antialias.ts';
import type { ComputePass, Dispatch, DispatchSize, RenderPass } from '../gpu/passes.ts';
import type { CompiledStage, RenderStage, StageDefinition } from '../gpu/pipelines.ts';
import { compose, resolveDepth, resolveDepthState, upscale } from '../stages/compose/compose.ts';
import { composite, compositeInCompute, compositeState } from '../stages/composite/composite.ts';
import { compactSplats, cullChunks, cullSplats, planCull } from '../stages/cull/cull.ts';
import {
  countsInWindow,
  countWorkgroups,
  cutCells,
  cutCount,
  cutSplats,
  cutWorkgroups,
  planCut,
  shiftCells,
} from '../stages/cut/cut.ts';
import { dispatchSize, sizeAtMost } from '../stages/dispatch.ts';
import { planProject, project } from '../stages/project/project.ts';
import { rasterize, rasterizeState } from '../stages/quads/quads.ts';
import { type RadixSort, radixSortStages } from '../stages/sort/radix-sort.ts';
import { blockKeysOf } from '../stages/sort/sort.ts';
import {
  splitsLists,
  tileCount,
  tileEmit,
  tileMasks,
  tilePlan,
  tileRanges,
  tileRasterize,
  tileRest,
} from '../stages/tiles/tiles.ts';
import { wideKeys } from '../stages/wide-keys/wide-keys.ts';
import { batchInstances, pagesOf, projectWorkgroups, sizeOverChunks, totalChunks } from './frame-pages.ts';
import type { Drawing, FrameResources, QuadsSample } from './parts/frame-part.ts';
import { hostCopies } from './parts/host-textures.ts';
import {
  type CloudShape,
  depthSortShape,
  type FrameShape,
  hasWideKeys,
  isScaled,
  PAIR_SORT_OPTIONS,
  pairSortShape,
  perShape,
} from './plan/frame-shape.ts';

// Every pass of a frame, in order, with its stages: when they run, over how much, and what they read and
// write. Nothing else orders stages, and bind groups are made of these names alone. README.md prints this
// table; `frame-passes.test.ts` holds both against the shaders.
//
// The visible splats are found and sorted, and then drawn. A view inside another renderer's frame
// submits `ORDER_PASSES` itself and records `DRAW_PASSES` for its host to submit.

/** A frame with its memory. */
export interface BoundFrame {
  readonly shape: FrameShape;
  readonly resources: FrameResources;
  readonly sort: RadixSort;
  /** Sort of the tiles' pairs, and the room for them; null and 0 without tiles. */
  readonly pairSort: RadixSort | null;
  readonly pairCapacity: number;
}

/** A frame that is drawn to a destination. */
export interface AimedFrame extends BoundFrame, Drawing {}

/**
 * What a stage binds: names in its shader, of which variants may bind fewer. `name=resource` if the frame
 * calls it otherwise.
 */
interface Bound {
  readonly reads?: string;
  readonly writes: string;
}

/** A compute stage that runs once in a frame, unless `of` returns null. */
interface FrameStage extends Bound {
  readonly each?: undefined;
  readonly targets?: undefined;
  readonly of: (shape: FrameShape) => StageDefinition | null;
  /** The variant for hosts whose depth has several samples; null for the same. */
  readonly ofMany?: (shape: FrameShape) => StageDefinition | null;
  /** Default: one workgroup. */
  readonly size?: (frame: BoundFrame) => DispatchSize;
}

/** A compute stage that runs over pages, or over batches of cuts. Effects of their clouds bind more. */
interface TargetStage extends Bound {
  readonly each: 'page' | 'batch';
  readonly of: (variant: TargetVariant) => StageDefinition | null;
  /**
   * @param count chunks of the page, or cells of the batch.
   * @param index of the page.
   */
  readonly size: (count: number, frame: BoundFrame, index: number) => DispatchSize;
}

/** All stages of a radix sort, which binds them itself. */
interface SortStages extends Bound {
  readonly each?: undefined;
  readonly stages: (shape: FrameShape) => readonly StageDefinition[];
  readonly dispatches: (frame: BoundFrame) => readonly Dispatch[];
}

/** A stage that draws. It binds what it reads, and writes its targets. */
interface DrawStage extends Bound {
  readonly of: (shape: FrameShape) => RenderStage | null;
  readonly ofMany?: DrawStage['of'];
  readonly targets: (frame: AimedFrame) => RenderPass['targets'];
  /** Null for no pass. */
  readonly draws: (frame: AimedFrame) => RenderPass['draws'] | null;
}

export type OrderStage = FrameStage | TargetStage | SortStages;
/** A row of the table. */
export type StageRow = OrderStage | DrawStage;

/** A pass; left out if no stage of it runs. */
export interface PassRow<Stage> extends Pick<ComputePass, 'label' | 'timed'> {
  /** The only destination that it runs for. */
  readonly to?: Drawing['destination']['kind'];
  /** Compute stages, or draw stages of which one runs. */
  readonly stages: readonly Stage[];
  /** Textures that are copied before the pass and after it. */
  readonly copies?: (frame: AimedFrame) => Pick<ComputePass, 'copyBefore' | 'copyAfter'>;
}

/** Everything that decides the stages of a cloud's pages. */
type TargetVariant = ReturnType<typeof variantOf>;

function variantOf(shape: FrameShape, cloud: CloudShape) {
  const hasLevels = cloud.levels !== null;
  return {
    // Inputs of variants have one name everywhere; planes at hand may differ from the settings'.
    ...shape.accuracy,
    ...shape,
    ...cloud.planes,
    ...cloud,
    batchInstances: cloud.instanceCount === null ? null : batchInstances(cloud),
    hasLevels,
    isBudgeted: hasLevels && shape.isBudgeted,
    isDilated: false,
  };
}

const { BIN_TILES, IMAGE_TILE_PX, MASK_GROUP, TILE_COUNT_BLOCK } = SHADER_CONSTANTS;

const overChunks: TargetStage['size'] = (count, { shape }) => sizeOverChunks(count, shape);

/** At most `most` workgroups: as many as entry `index` of `name` says. */
function listed(
  most: number,
  { shape, resources }: BoundFrame,
  name: 'cullDispatches' | 'projectDispatches' | 'pairDispatches',
  index: number,
  startsAll = false,
): DispatchSize {
  const { dispatchRow, sortDevice } = shape;
  // Wide devices start all that there is room for: workgroups without pairs cost them little.
  if (startsAll && !sortDevice.isNarrow) return dispatchSize(Math.max(1, most), dispatchRow);
  return sizeAtMost(most, dispatchRow, { buffer: resources[name], offset: 12 * index }, sortDevice.isNarrow);
}

const overVisible: TargetStage['size'] = (chunks, frame, index) =>
  listed(projectWorkgroups(chunks), frame, 'projectDispatches', index);

const overPairs = (perWorkgroup: number, frame: BoundFrame, index: number) =>
  listed(Math.ceil(frame.pairCapacity / perWorkgroup), frame, 'pairDispatches', index, true);

function overImage(image: GPUTexture): DispatchSize {
  const tiles = (px: number) => Math.ceil(px / IMAGE_TILE_PX);
  return [tiles(image.width), tiles(image.height), 1];
}

/** Counts the splats of budgeted cuts, and plans their shift. */
const cutCounts = (runs: (shape: Pick<FrameShape, 'sortDevice'>) => boolean): readonly OrderStage[] => [
  {
    each: 'page',
    of: (variant) => (variant.isBudgeted && runs(variant) ? cutCount(variant) : null),
    size: (chunks, { shape: { sortDevice, dispatchRow } }) =>
      dispatchSize(countWorkgroups(chunks, sortDevice), dispatchRow),
    reads: 'view page pages links cells thresholds cutPlan geometry chunks',
    writes: 'cutCounts',
  },
  {
    of: (shape) => (shape.isBudgeted && runs(shape) ? planCut : null),
    writes: 'cutPlan cutCounts',
  },
];

const listVariant = ({ accuracy, isStacked, sortDevice: { isNarrow } }: FrameShape) => ({
  recordPrecision: accuracy.recordPrecision,
  extent: accuracy.extent,
  isStacked,
  isNarrow,
});

/** `stage` of frames that tiles draw. */
const byTiles =
  (stage: (shape: FrameShape) => StageDefinition) =>
  (shape: FrameShape): StageDefinition | null =>
    shape.rasterizer === 'tiles' ? stage(shape) : null;

/** Counts pairs, and plans bins for them; `isAgain` if bins must be larger. */
const pairCounts = (isAgain: boolean): readonly FrameStage[] => [
  {
    of: byTiles((shape) => tileCount(listVariant(shape), isAgain)),
    size: (frame) => {
      const { shape } = frame;
      const most = Math.ceil(shape.visibleCapacity / TILE_COUNT_BLOCK);
      return listed(most, frame, 'projectDispatches', pagesOf(shape).length, true);
    },
    reads: 'view grid tilePlan visibleCount order records',
    writes: 'pairOffsets=keys blockPairs',
  },
  {
    of: byTiles((shape) => tilePlan(pairSortShape(shape), isAgain)),
    reads: 'view grid visibleCount',
    writes: 'blockPairs tilePlan sortPlan drawArguments pairDispatches',
  },
];

/** Passes that find and sort the visible splats. */
export const ORDER_PASSES: readonly PassRow<OrderStage>[] = [
  {
    label: 'pre-process',
    timed: 'preprocess',
    stages: [
      {
        each: 'batch',
        of: ({ hasLevels, batchInstances }) => (hasLevels ? cutCells(batchInstances ?? 1) : null),
        size: overChunks,
        reads: 'cuts cells cutPlan',
        writes: 'thresholds',
      },
      ...cutCounts(() => true),
      ...cutCounts(({ sortDevice }) => countsInWindow(sortDevice)),
      {
        each: 'batch',
        of: ({ isBudgeted, batchInstances }) => (isBudgeted ? shiftCells(batchInstances ?? 1) : null),
        size: overChunks,
        reads: 'cuts cells cutPlan',
        writes: 'thresholds',
      },
      {
        each: 'page',
        of: cullChunks,
        size: overChunks,
        reads: 'view page pages links cells thresholds chunks',
        writes: 'chunkOffsets',
      },
      {
        of: ({ sortDevice }) => planCull(sortDevice.isNarrow),
        reads: 'cullParameters',
        writes: 'chunkOffsets pagePlans slotCount cullDispatches depthRange visibleChunks',
      },
      {
        each: 'page',
        of: ({ hasLevels, batchInstances }) => (hasLevels ? cutSplats(batchInstances) : null),
        size: (chunks, frame, index) => listed(cutWorkgroups(chunks), frame, 'cullDispatches', index),
        reads: 'view page pages pagePlans visibleChunks links thresholds',
        writes: 'visibilityMasks',
      },
      {
        each: 'page',
        of: cullSplats,
        size: (chunks, frame, index) => listed(chunks, frame, 'cullDispatches', index),
        reads: 'view page pages pagePlans visibleChunks geometry chunks',
        writes: 'visibilityMasks splatOffsets depthRange',
      },
      {
        of: (shape) => planProject(depthSortShape(shape)),
        reads: 'cullParameters slotCount',
        writes:
          'splatOffsets pagePlans visibleCount projectDispatches drawArguments depthSortPlan depthSortDispatch',
      },
      {
        of: () => compactSplats,
        size: (frame) => {
          const pages = pagesOf(frame.shape);
          return listed(totalChunks(pages), frame, 'cullDispatches', pages.length);
        },
        reads: 'cullParameters slotCount visibleChunks visibilityMasks splatOffsets',
        writes: 'visibleSplats',
      },
      {
        each: 'page',
        of: (variant) =>
          project({
            ...variant,
            shortKeyBits: variant.shortensKeys ? variant.accuracy.sortKeyBits : null,
            maxColor: maxColor(variant.accuracy),
            storedShDegree: variant.cloud.shDegree,
          }),
        size: overVisible,
        reads: 'view page pages pagePlans visibleSplats geometry chunks depthRange shRest',
        writes: 'records keys',
      },
      {
        each: 'page',
        of: (variant) => (hasWideKeys(variant) ? wideKeys(variant) : null),
        size: overVisible,
        reads: 'view page pages pagePlans visibleSplats geometry chunks widePlaces',
        writes: 'keys upperKeys',
      },
    ],
  },
  {
    label: 'sort',
    timed: 'sort',
    stages: [
      {
        stages: (shape) => radixSortStages(depthSortShape(shape)),
        dispatches: ({ sort }) => sort.dispatches,
        reads: 'depthSortPlan keys upperKeys',
        writes: 'keys order',
      },
    ],
  },
  {
    label: 'tile lists',
    timed: 'tile-lists',
    stages: [
      ...pairCounts(false),
      ...pairCounts(true),
      {
        of: byTiles((shape) => tileEmit(listVariant(shape), pairSortShape(shape))),
        size: (frame) => overPairs(blockKeysOf(pairSortShape(frame.shape)), frame, 0),
        reads: 'view grid tilePlan order records pairOffsets=keys blockPairs',
        writes: 'pairBins pairRecords digitCounts=pairDigitCounts',
      },
      {
        stages: (shape) =>
          shape.rasterizer === 'tiles' ? radixSortStages(pairSortShape(shape), PAIR_SORT_OPTIONS) : [],
        dispatches: ({ shape, pairSort }) => (shape.rasterizer === 'tiles' ? pairSort!.dispatches : []),
        reads: 'sortPlan pairBins pairRecords pairDigitCounts',
        writes: 'sortedBins sortedRecords',
      },
      {
        of: byTiles(() => tileRanges),
        reads: 'grid tilePlan sortedBins',
        writes: 'binStarts binOrder',
      },
      {
        of: byTiles((shape) => tileMasks(listVariant(shape))),
        size: (frame) => overPairs(MASK_GROUP, frame, 1),
        reads: 'view grid tilePlan records sortedRecords sortedBins',
        writes: 'tileMasks',
      },
    ],
  },
];

/** Most workgroups of tile-rest: each blends one tile after the other. */
const REST_WORKGROUPS = 1024;

/** Tiles of the layer, at least one. */
export function tilesOf({ binCount }: FrameShape): number {
  return Math.max(1, binCount * BIN_TILES ** 2);
}

/** Whether frames of this shape leave the ends of long lists to `tile-rest`. */
export function splitsTiles({ rasterizer, depth, sortDevice: { isNarrow } }: FrameShape): boolean {
  return rasterizer === 'tiles' && splitsLists({ depth, isNarrow });
}

const blendVariant = ({ accuracy, depth, isStacked, sortDevice, ...shape }: FrameShape) => ({
  recordPrecision: accuracy.recordPrecision,
  colorTarget: accuracy.colorTarget,
  depth,
  // By wide keys, records' float32 depths may go back, but by no more than their rounding.
  isExactOrder: !shape.shortensKeys && !shape.sortsByDistance,
  isNarrow: sortDevice.isNarrow,
  isStacked,
});

const BLENDED = 'view grid tilePlan records sortedRecords binStarts binOrder tileMasks testedDepth hostDepth';

/** One triangle over the whole target. */
const OVER_ALL = [[3]] as const;

const resolved =
  (isMany: boolean): DrawStage['of'] =>
  (shape) => {
    const { depth, output } = shape;
    if (!depth?.isTested || output.kind !== 'host') return null;
    return [resolveDepth(depth.compare, isMany, isScaled(shape)), resolveDepthState];
  };

const RASTERIZE: Omit<DrawStage, 'draws'> = {
  of: ({ accuracy, depth, isStacked }) => {
    const { recordPrecision, extent, colorTarget } = accuracy;
    return [rasterize({ recordPrecision, extent, depth, isStacked }), rasterizeState(colorTarget, depth)];
  },
  targets: ({ shape, resources: { layer, depthLayer, testedDepth } }) => ({
    colorAttachments: [layer!, depthLayer]
      .filter((texture) => texture !== null && texture !== undefined)
      .map((texture) => ({
        view: texture.createView(),
        // Tiles have written every pixel. Clearing takes longer than all their stages.
        loadOp: shape.rasterizer === 'tiles' ? ('load' as const) : ('clear' as const),
        storeOp: 'store' as const,
        clearValue: [0, 0, 0, 0],
      })),
    ...(testedDepth && {
      depthStencilAttachment: { view: testedDepth.createView(), depthReadOnly: true },
    }),
  }),
  reads: 'view order records hostDepth',
  writes: 'layer depthLayer',
};

/** Places of the order that a sample takes splats from: near ones are larger than far ones. */
const SAMPLED_PLACES = 16;

/** Quads, spread over their order, to be timed. */
function sampled({ share, visibleSplats }: QuadsSample): RenderPass['draws'] {
  const count = share * visibleSplats;
  // None for a share of none: drawing no instance is warned about.
  const places = Math.min(SAMPLED_PLACES, Math.ceil(count));
  const each = Math.ceil(count / places);
  return Array.from({ length: places }, (_, i) => {
    const first = Math.floor(((i + 0.5) / places) * visibleSplats - each / 2);
    return [4, each, 0, Math.max(0, first)] as const;
  });
}

const composed =
  (isMany: boolean): FrameStage['of'] =>
  ({ depth, isFaded, output }) =>
    output.kind === 'host' && (depth?.isTested || !isMany) ? compose(depth, isMany, isFaded) : null;

const COMPOSE: FrameStage = {
  of: composed(false),
  ofMany: composed(true),
  size: ({ resources }) => overImage(resources.composed!),
  reads: 'layer=image depthLayer=depthImage behind fade viewport hostDepth hostDepths',
  writes: 'image=composed depthImage=composedDepth',
};

/** Puts the image on a canvas, over another background each time. */
export const CANVAS_PASSES: readonly PassRow<FrameStage | DrawStage>[] = [
  {
    label: 'composite',
    to: 'canvas',
    timed: 'composite',
    stages: [
      {
        of: ({ output, rasterizer }) =>
          output.kind === 'canvas' && rasterizer === 'tiles' && output.storable
            ? compositeInCompute(output.storable)
            : null,
        size: ({ resources }) => overImage(resources.canvas as GPUTexture),
        reads: 'parameters=compositeParameters layer=image',
        writes: 'canvas',
      },
      {
        of: ({ output, rasterizer }) =>
          output.kind === 'canvas' && !(rasterizer === 'tiles' && output.storable)
            ? [composite, compositeState(output.format)]
            : null,
        targets: ({ resources }) => ({
          colorAttachments: [
            { view: (resources.canvas as GPUTexture).createView(), loadOp: 'clear', storeOp: 'store' },
          ],
        }),
        draws: () => OVER_ALL,
        reads: 'parameters=compositeParameters layer=image',
        writes: 'canvas',
      },
    ],
  },
];

/** Passes that draw the visible splats: each runs if a stage of it does. */
export const DRAW_PASSES: typeof CANVAS_PASSES = [
  {
    label: 'resolve depth',
    to: 'host',
    timed: 'resolve-depth',
    stages: [
      {
        of: resolved(false),
        ofMany: resolved(true),
        targets: ({ resources }) => ({
          colorAttachments: [],
          depthStencilAttachment: {
            view: resources.testedDepth!.createView(),
            depthLoadOp: 'clear',
            depthStoreOp: 'store',
            depthClearValue: 0,
          },
        }),
        draws: () => OVER_ALL,
        reads: 'viewport hostDepths',
        writes: 'testedDepth',
      },
    ],
  },
  {
    // Before the tiles, which overwrite it.
    label: 'quads sample',
    timed: 'quads-sample',
    stages: [
      {
        ...RASTERIZE,
        draws: ({ sample, shape }: AimedFrame) =>
          sample && shape.rasterizer === 'tiles' ? sampled(sample) : null,
      },
    ],
  },
  {
    label: 'tiles',
    timed: 'tiles',
    stages: [
      {
        of: byTiles((shape) => tileRasterize(blendVariant(shape))),
        size: ({ shape }) => dispatchSize(tilesOf(shape), shape.dispatchRow),
        reads: BLENDED,
        writes: 'longTiles frontPixels layer depthLayer',
      },
      {
        of: (shape) => (splitsTiles(shape) ? tileRest(blendVariant(shape)) : null),
        size: ({ shape }) => [Math.min(REST_WORKGROUPS, tilesOf(shape)), 1, 1],
        reads: `${BLENDED} frontPixels`,
        writes: 'longTiles layer',
      },
    ],
  },
  {
    label: 'rasterize',
    timed: 'rasterize',
    stages: [
      {
        ...RASTERIZE,
        draws: ({ resources }: AimedFrame) => [{ buffer: resources.drawArguments, offset: 0 }],
      },
    ],
  },
  {
    label: 'upscale',
    timed: 'upscale',
    stages: [
      {
        of: (shape) =>
          isScaled(shape) ? upscale(shape.accuracy.colorTarget, shape.depth?.layerFormat != null) : null,
        size: ({ resources }) => overImage(resources.image!),
        reads: 'parameters=upscaleParameters layer depthLayer',
        writes: 'image depthImage',
      },
    ],
  },
  ...CANVAS_PASSES,
  {
    label: 'compose',
    to: 'host',
    timed: 'composite',
    stages: [COMPOSE],
    copies: hostCopies,
  },
];

/** All rows, in order. */
const ROWS: readonly StageRow[] = [...ORDER_PASSES, ...DRAW_PASSES].flatMap(
  ({ stages }): readonly StageRow[] => stages,
);

/** Names in the shader of each row, and the resources of the frame that are bound there. */
export const boundNames = new Map(
  ROWS.map((row) => {
    const bound = `${row.reads ?? ''} ${'draws' in row ? '' : row.writes}`.split(' ').filter(Boolean);
    return [row, bound.map((each) => each.split('='))];
  }),
);

type MadeStages = readonly (readonly (CompiledStage | null)[])[];

/**
 * The stages of a shape by row of the table, each made once: by cloud, of its splats and its merged splats; of
 * whole frames, of one sample and of many.
 */
export const stagesOf = perShape((shape): ReadonlyMap<StageRow, MadeStages> => {
  const variants = shape.clouds.map((cloud) => {
    const variant = variantOf(shape, cloud);
    const isDilated = !cloud.effects.linked.some(({ effect }) => effect === antialias.effect);
    return cloud.levels ? [variant, { ...variant, ...BLOB_PRECISION, isDilated }] : [variant];
  });
  const made = (row: StageRow): MadeStages => {
    if ('dispatches' in row) return [row.stages(shape)];
    if ('each' in row && row.each) return variants.map((each) => each.map((variant) => row.of(variant)));
    return [[row.of(shape), row.ofMany?.(shape) ?? null]];
  };
  return new Map(ROWS.map((row) => [row, made(row)]));
});

/** All stages that frames of this shape run; compile them before drawing. */
export const frameStages = perShape((shape): readonly CompiledStage[] => {
  // The end of a fade may not wait for a shader: splats would vanish while it compiles.
  const unfaded = { ...shape, isFaded: false };
  const ahead = shape.isFaded ? [COMPOSE.of(unfaded), COMPOSE.ofMany!(unfaded)] : [];
  const touched = shape.clouds.flatMap(({ isTouched, levels }) =>
    isTouched ? levels!.refinement!.stages : [],
  );
  return [...stagesOf(shape).values(), [ahead, touched]].flat(2).filter((stage) => stage !== null);
});
