import { BLOB_PRECISION, type OwnShPrecision } from '../data/packing/precision.ts';
import type { ShDegree } from '../data/splats/splat-set.ts';
import { packBuffers } from '../features/gpu-splats/pack-buffers.stages.ts';
import { morphGeometry, morphSh } from '../features/morph/morph.stages.ts';
import { skinGeometry } from '../features/skin/skin.stages.ts';
import { instancesPerBinding } from '../frame/frame-pages.ts';
import { NO_EFFECTS } from '../gpu/effects/effect-set.ts';
import type { StageDefinition } from '../gpu/pipelines.ts';
import { loadVariant } from '../gpu/shaders/link-shader.ts';
import { compose, resolveDepth, upscale } from '../stages/compose/compose.ts';
import { composite, compositeInCompute } from '../stages/composite/composite.ts';
import { coverPoints } from '../stages/cover/cover.ts';
import { compactSplats, cullChunks, cullSplats, planCull } from '../stages/cull/cull.ts';
import {
  cutCells,
  cutCount,
  cutSplats,
  openLeaves,
  planCut,
  shiftCells,
  touchLinks,
  touchUpperLinks,
} from '../stages/cut/cut.ts';
import { ingestGather } from '../stages/gather/gather.ts';
import { ingestChunks, ingestKeys, ingestRows, ingestScatter } from '../stages/ingest/ingest.ts';
import { averageSamples, compareImages, copyWords } from '../stages/measure/measure.ts';
import { mergeChunks, mergeHarmonics } from '../stages/merge/merge.ts';
import { pick } from '../stages/pick/pick.ts';
import { planProject, project } from '../stages/project/project.ts';
import { type RasterizeDepth, rasterize } from '../stages/quads/quads.ts';
import { repackGeometry, repackSh } from '../stages/repack/repack.ts';
import { radixSortStages } from '../stages/sort/radix-sort.ts';
import { pairSortShapeFor, sortShapeFor } from '../stages/sort/sort.ts';
import { tileCosts } from '../stages/tile-costs/tile-costs.ts';
import {
  splitsLists,
  type TileRasterizeVariant,
  tileCount,
  tileEmit,
  tileMasks,
  tilePlan,
  tileRanges,
  tileRasterize,
  tileRest,
} from '../stages/tiles/tiles.ts';
import { wideKeys } from '../stages/wide-keys/wide-keys.ts';

const DEGREES: readonly ShDegree[] = [0, 1, 2, 3];
const SH_PRECISIONS: readonly OwnShPrecision[] = ['f32', 'f16', 'u8'];
const BOTH = [false, true] as const;
const GEOMETRY = ['f32', 'packed'] as const;
const RECORD = ['f32', 'f16', 'paper'] as const;
const EXTENTS = ['opacity', 'fixed'] as const;
const SHORT_KEYS = [24, 16] as const;
/** Sizes of workgroup memory that give different sorts. */
const WORKGROUP_BYTES = [16_384, 32_768, 49_152] as const;
/** One for each length of digits. */
const PAIR_KEY_BITS = [8, 9] as const;
/** Sorts of pairs by bin, of layers with few bins, and with so many that two passes are needed. */
const PAIR_SORTS = PAIR_KEY_BITS.flatMap((bits) => [
  ...WORKGROUP_BYTES.map((workgroupBytes) => pairSortShapeFor(bits, { workgroupBytes })),
  pairSortShapeFor(bits, { isNarrow: true }),
]);

/** Devices with one word per ballot, and with several. */
const BALLOT_DEVICES = [
  { min: 32, max: 32, workgroupThreads: 1024 },
  { min: 32, max: 64, workgroupThreads: 256 },
] as const;

/** One of the kinds of tiles: how they treat merged splats does not depend on it. */
const STACKED_TILES = { colorTarget: 'rgba16float', depth: null, isExactOrder: true } as const;

/** Instances per binding of clouds without effects. */
const BATCH_INSTANCES = instancesPerBinding(NO_EFFECTS);

const COLOR_TARGETS = ['rgba8unorm', 'rgba16float', 'rgba32float'] as const;
const COMPARES = ['less-equal', 'greater-equal'] as const;
/** Depth is tested, written, or both. */
const DEPTH_USES = [
  { isTested: true, layerFormat: null },
  { isTested: true, layerFormat: 'r16float' },
  { isTested: false, layerFormat: 'r16float' },
] as const;
const DEPTHS: readonly (RasterizeDepth | null)[] = [
  null,
  ...(['projection', 'logarithmic'] as const).flatMap((mapping) =>
    [false, true].flatMap((isOrthographic) =>
      DEPTH_USES.map((use) => ({ mapping, compare: 'less-equal' as const, isOrthographic, ...use })),
    ),
  ),
];
const TILE_DEPTHS: readonly (RasterizeDepth | null)[] = DEPTHS.flatMap((depth) =>
  depth
    ? COMPARES.map((compare) => ({ ...depth, compare, layerFormat: depth.layerFormat && 'r32float' }))
    : [null],
);

/** The stages that blend tiles. */
function tileStages(variant: TileRasterizeVariant): StageDefinition[] {
  return [tileRasterize(variant), ...(splitsLists(variant) ? [tileRest(variant)] : [])];
}

/** All stages, in every variant that a frame may run, with their texts. */
export function allStageVariants(): Promise<StageDefinition[]> {
  const stages: StageDefinition[] = [
    cullChunks(),
    compactSplats,
    copyWords,
    composite,
    compositeInCompute('bgra8unorm'),
    compositeInCompute('rgba8unorm'),
    averageSamples,
    compareImages,
    ...BOTH.flatMap((isNarrow) => [planCull(isNarrow), planProject(sortShapeFor(32, { isNarrow }))]),
    ...RECORD.flatMap((recordPrecision) =>
      EXTENTS.flatMap((extent) => [
        ...DEPTHS.map((depth) => rasterize({ recordPrecision, extent, depth })),
        rasterize({ recordPrecision, extent, depth: null, isStacked: true }),
      ]),
    ),
    ...DEPTHS.flatMap((depth) =>
      (depth?.isTested ? BOTH : [false]).flatMap((many) =>
        BOTH.map((isFaded) => compose(depth, many, isFaded)),
      ),
    ),
    ...COMPARES.flatMap((compare) =>
      BOTH.flatMap((many) => BOTH.map((scaled) => resolveDepth(compare, many, scaled))),
    ),
    tileRanges,
    ...RECORD.flatMap((recordPrecision) => [
      ...EXTENTS.flatMap((extent) => [
        ...BOTH.flatMap((isStacked) => [
          ...BOTH.flatMap((isNarrow) => [
            ...BOTH.map((isAgain) => tileCount({ recordPrecision, extent, isStacked, isNarrow }, isAgain)),
            tileMasks({ recordPrecision, extent, isStacked, isNarrow }),
          ]),
        ]),
        ...PAIR_SORTS.map((shape) => tileEmit({ recordPrecision, extent, isNarrow: shape.isNarrow }, shape)),
        tileEmit({ recordPrecision, extent, isStacked: true }, PAIR_SORTS[0]),
      ]),
      ...BOTH.flatMap((isNarrow) =>
        tileStages({ ...STACKED_TILES, recordPrecision, isNarrow, isStacked: true }),
      ),
      ...COLOR_TARGETS.flatMap((colorTarget) =>
        TILE_DEPTHS.flatMap((depth) =>
          BOTH.flatMap((isExactOrder) =>
            BOTH.flatMap((isNarrow) =>
              tileStages({ recordPrecision, colorTarget, depth, isExactOrder, isNarrow }),
            ),
          ),
        ),
      ),
    ]),
    ...PAIR_SORTS.flatMap((shape) => [tilePlan(shape), tilePlan(shape, true), ...radixSortStages(shape)]),
    ...COLOR_TARGETS.flatMap((target) => BOTH.map((hasDepthLayer) => upscale(target, hasDepthLayer))),
    ...RECORD.flatMap((precision) => [null, ...COMPARES].map((compare) => coverPoints(precision, compare))),
    ...RECORD.flatMap((recordPrecision) =>
      BOTH.flatMap((isStacked) => [
        pick(recordPrecision, isStacked),
        coverPoints(recordPrecision, null, isStacked),
        tileCosts(recordPrecision, 'counts', isStacked),
        tileCosts(recordPrecision, 'map', isStacked),
      ]),
    ),
    ...GEOMETRY.flatMap((geometryPrecision) => [
      ingestKeys(geometryPrecision),
      ingestChunks(geometryPrecision),
      ...SH_PRECISIONS.flatMap((shPrecision) =>
        DEGREES.flatMap((shDegree) =>
          [{}, { entryValues: 45 }, { hasByteHarmonics: true }].map((kind) =>
            ingestRows({ geometryPrecision, shPrecision, shDegree, ...kind }),
          ),
        ),
      ),
    ]),
    ...GEOMETRY.flatMap((geometryPrecision) =>
      [null, BATCH_INSTANCES].flatMap((batchInstances) =>
        BOTH.map((sortsByDistance) => wideKeys({ geometryPrecision, batchInstances, sortsByDistance })),
      ),
    ),
    ingestGather,
    ingestScatter,
    repackGeometry,
    ...GEOMETRY.map(morphGeometry),
    ...GEOMETRY.map(skinGeometry),
    ...GEOMETRY.flatMap((geometryPrecision) =>
      BOTH.flatMap((hasRotations) =>
        BOTH.flatMap((hasOpacities) =>
          BOTH.map((countsFaults) =>
            packBuffers({ geometryPrecision, hasRotations, hasOpacities, countsFaults }),
          ),
        ),
      ),
    ),
    cullChunks({ hasLevels: true }),
    ...BOTH.map((hasLevels) => cullChunks({ hasLevels, batchInstances: BATCH_INSTANCES })),
    ...[1, BATCH_INSTANCES].flatMap((places) => [cutCells(places), shiftCells(places)]),
    ...[null, BATCH_INSTANCES].map(cutSplats),
    ...GEOMETRY.flatMap((geometryPrecision) =>
      (['bounding-box', 'frustum'] as const).flatMap((culling) =>
        BOTH.flatMap((isNarrow) =>
          [null, BATCH_INSTANCES].map((batchInstances) =>
            cutCount({ geometryPrecision, culling, batchInstances, sortDevice: { isNarrow } }),
          ),
        ),
      ),
    ),
    planCut,
    openLeaves,
    touchLinks,
    touchUpperLinks,
    ...(['f32', 'packed', 'upper'] as const).map(mergeChunks),
    ...DEGREES.slice(1).flatMap((degree) => [
      mergeHarmonics(degree, 'upper'),
      ...GEOMETRY.flatMap((geometryPrecision) =>
        [...SH_PRECISIONS, 'palette' as const].map((shPrecision) =>
          mergeHarmonics(degree, { geometryPrecision, shPrecision }),
        ),
      ),
    ]),
    ...DEGREES.slice(1).flatMap((degree) => [
      ...SH_PRECISIONS.map((precision) => morphSh(degree, precision)),
      repackSh({ degree, from: 'f32', to: 'f16' }),
      repackSh({ degree, from: 'f32', to: 'u8' }),
      repackSh({ degree, from: 'f16', to: 'u8' }),
    ]),
    ...BALLOT_DEVICES.flatMap((ballots) =>
      [24, 27, 64].flatMap((keyBits) =>
        radixSortStages(sortShapeFor(keyBits, { workgroupBytes: 49_152, ballots })),
      ),
    ),
    ...WORKGROUP_BYTES.flatMap((workgroupBytes) =>
      [8, 16, 20, 24, 27, 32, 64].flatMap((keyBits) =>
        BOTH.flatMap((isNarrow) => radixSortStages(sortShapeFor(keyBits, { workgroupBytes, isNarrow }))),
      ),
    ),
  ];
  for (const isOrthographic of [false, true]) {
    for (const geometryPrecision of GEOMETRY) {
      for (const extent of EXTENTS) {
        for (const culling of ['bounding-box', 'frustum'] as const) {
          const variant = { isOrthographic, geometryPrecision, extent, culling };
          stages.push(
            cullSplats(variant),
            cullSplats({ ...variant, isIsotropic: true }),
            ...BOTH.map((isNarrow) =>
              cullSplats({ ...variant, batchInstances: BATCH_INSTANCES, sortDevice: { isNarrow } }),
            ),
            cullSplats({ ...variant, sortDevice: { isNarrow: true } }),
            cullSplats({ ...variant, isStacked: true }),
            ...[null, BATCH_INSTANCES].flatMap((batchInstances) =>
              BOTH.map((isNarrow) => {
                const cut = { isStacked: true, hasLevels: true, batchInstances };
                return cullSplats({ ...variant, ...cut, sortDevice: { isNarrow } });
              }),
            ),
            ...(isOrthographic ? [] : [cullSplats({ ...variant, sortsByDistance: true })]),
          );
        }
      }
      for (const recordPrecision of RECORD) {
        for (const shPrecision of SH_PRECISIONS) {
          for (const storedShDegree of DEGREES) {
            for (const shDegree of DEGREES.filter((degree) => degree <= storedShDegree)) {
              const precisions = { geometryPrecision, recordPrecision, shPrecision };
              const degrees = { storedShDegree, shDegree };
              stages.push(
                project({ isOrthographic, ...precisions, shortKeyBits: null, maxColor: 65504, ...degrees }),
              );
            }
          }
        }
      }
    }
  }
  for (const degree of DEGREES.slice(1)) {
    const precisions = { geometryPrecision: 'packed', recordPrecision: 'f16' } as const;
    const degrees = { storedShDegree: degree, shDegree: degree };
    const frame = { isOrthographic: false, shortKeyBits: null, maxColor: 65504 } as const;
    stages.push(project({ ...frame, ...precisions, ...degrees, shPrecision: 'palette' }));
  }
  for (const recordPrecision of RECORD) {
    const precisions = { geometryPrecision: 'packed', recordPrecision, shPrecision: 'u8' } as const;
    const degrees = { storedShDegree: 3, shDegree: 3 } as const;
    const frame = { isOrthographic: false, shortKeyBits: null, maxColor: 65504 } as const;
    stages.push(project({ ...frame, ...precisions, ...degrees, isIsotropic: true }));
    stages.push(project({ ...frame, ...precisions, ...degrees, sortsByDistance: true }));
    stages.push(project({ ...frame, ...precisions, ...degrees, batchInstances: BATCH_INSTANCES }));
  }
  for (const isOrthographic of BOTH) {
    const frame = { isOrthographic, shortKeyBits: null, maxColor: 65504, isDilated: true } as const;
    const culled = { extent: 'opacity', culling: 'bounding-box', hasLevels: true, isStacked: true } as const;
    for (const batchInstances of [null, BATCH_INSTANCES]) {
      const blobs = { ...frame, ...BLOB_PRECISION, batchInstances };
      stages.push(cullSplats({ ...blobs, ...culled }));
      for (const degree of DEGREES) {
        const degrees = { storedShDegree: degree, shDegree: degree };
        stages.push(project({ ...blobs, ...degrees, recordPrecision: 'f16' }));
      }
    }
  }
  for (const shortKeyBits of SHORT_KEYS) {
    const precisions = { geometryPrecision: 'packed', recordPrecision: 'f16', shPrecision: 'u8' } as const;
    const degrees = { storedShDegree: 3, shDegree: 3 } as const;
    const variant = { isOrthographic: false, ...precisions, shortKeyBits, maxColor: 65504, ...degrees };
    stages.push(project(variant), project({ ...variant, sortsByDistance: true }));
  }
  return Promise.all(uniqueByText(stages).map(loadVariant));
}

function uniqueByText(stages: readonly StageDefinition[]): StageDefinition[] {
  const textOf = (stage: StageDefinition) => JSON.stringify({ ...stage, texts: undefined });
  return [...new Map(stages.map((stage) => [textOf(stage), stage])).values()];
}

/** At most `countEach` variants of each stage, spread evenly over all that it has. */
export function spreadByStage<Variant extends { stage: string }>(
  variants: readonly Variant[],
  countEach: number,
): Variant[] {
  const stages = [...new Set(variants.map(({ stage }) => stage))];
  return stages.flatMap((stage) => {
    const all = variants.filter((variant) => variant.stage === stage);
    const stride = Math.max(1, all.length / countEach);
    return all.filter((_, i) => Math.floor(i / stride) !== Math.floor((i - 1) / stride));
  });
}
