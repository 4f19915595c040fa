import type { StageDefinition } from '../gpu/pipelines.ts';
import type { OwnShPrecision } from '../packing/precision.ts';
import { loadVariant } from '../shaders/link-shader.ts';
import type { ShDegree } from '../splats/splat-set.ts';
import { compactChunks } from '../stages/compact-chunks.ts';
import { compactSplats } from '../stages/compact-splats.ts';
import { compareImages } from '../stages/compare-images.ts';
import { compose } from '../stages/compose.ts';
import { composite, compositeInCompute } from '../stages/composite.ts';
import { copyWords } from '../stages/copy-words.ts';
import { coverPoints } from '../stages/cover-points.ts';
import { cullChunks } from '../stages/cull-chunks.ts';
import { cullSplats } from '../stages/cull-splats.ts';
import { ingestChunks } from '../stages/ingest-chunks.ts';
import { ingestGather } from '../stages/ingest-gather.ts';
import { ingestKeys } from '../stages/ingest-keys.ts';
import { ingestRows } from '../stages/ingest-rows.ts';
import { ingestScatter } from '../stages/ingest-scatter.ts';
import { pick } from '../stages/pick.ts';
import { planCull } from '../stages/plan-cull.ts';
import { planProject } from '../stages/plan-project.ts';
import { prefixScanStages } from '../stages/prefix-scan.ts';
import { project } from '../stages/project.ts';
import { radixSortStages } from '../stages/radix-sort.ts';
import { type RasterizeDepth, rasterize } from '../stages/rasterize.ts';
import { repackGeometry } from '../stages/repack-geometry.ts';
import { repackSh } from '../stages/repack-sh.ts';
import { resolveDepth } from '../stages/resolve-depth.ts';
import { pairSortShapeFor, sortShapeFor } from '../stages/sort-shape.ts';
import { tileCosts } from '../stages/tile-costs.ts';
import { tileCount } from '../stages/tile-count.ts';
import { tileEmit } from '../stages/tile-emit.ts';
import { tileMasks } from '../stages/tile-masks.ts';
import { tilePlan } from '../stages/tile-plan.ts';
import { tileRanges } from '../stages/tile-ranges.ts';
import { tileRasterize } from '../stages/tile-rasterize.ts';
import { upscale } from '../stages/upscale.ts';

const DEGREES: readonly ShDegree[] = [0, 1, 2, 3];
const SH_PRECISIONS: readonly OwnShPrecision[] = ['f32', 'f16', 'u8'];
const BOTH = [false, true] as const;
const GEOMETRY = ['f32', 'packed'] as const;
const RECORD = ['f32', 'f16', 'paper'] as const;
const EXTENTS = ['opacity', 'fixed'] as const;
const SHORT_KEYS = [24, 16] as const;
/** Every amount that devices have which makes a difference to the sort. */
const WORKGROUP_BYTES = [16_384, 32_768, 49_152] as const;
/** One for each length of digits. */
const PAIR_KEY_BITS = [8, 9] as const;
/** Sorts of pairs by bin, of layers with few bins, and with so many that two passes are needed. */
const PAIR_SORTS = WORKGROUP_BYTES.flatMap((bytes) =>
  PAIR_KEY_BITS.flatMap((bits) => BOTH.map((isNarrow) => pairSortShapeFor(bits, bytes, isNarrow))),
);

/** Of one word per ballot, and of several. */
const BALLOT_DEVICES = [
  { min: 32, max: 32, workgroupThreads: 1024 },
  { min: 32, max: 64, workgroupThreads: 256 },
] as const;

const COLOR_TARGETS = ['rgba8unorm', 'rgba16float', 'rgba32float'] as const;
const COMPARES = ['less-equal', 'greater-equal'] as const;
const DEPTHS: readonly (RasterizeDepth | null)[] = [
  null,
  ...(['projection', 'logarithmic'] as const).flatMap((mapping) =>
    [false, true].flatMap((isOrthographic) =>
      ([null, 'r16float'] as const).map((layerFormat) => ({
        mapping,
        compare: 'less-equal' as const,
        isOrthographic,
        layerFormat,
      })),
    ),
  ),
];
const TILE_DEPTHS: readonly (RasterizeDepth | null)[] = DEPTHS.flatMap((depth) =>
  depth
    ? COMPARES.map((compare) => ({ ...depth, compare, layerFormat: depth.layerFormat && 'r32float' }))
    : [null],
);

/** All stages, in every variant that a frame may run, with their texts. */
export function allStageVariants(): Promise<StageDefinition[]> {
  const stages: StageDefinition[] = [
    cullChunks,
    compactChunks,
    compactSplats,
    copyWords,
    planCull,
    planProject,
    composite,
    compositeInCompute('bgra8unorm'),
    compositeInCompute('rgba8unorm'),
    compareImages,
    ...prefixScanStages,
    ...RECORD.flatMap((recordPrecision) =>
      EXTENTS.flatMap((extent) => DEPTHS.map((depth) => rasterize({ recordPrecision, extent, depth }))),
    ),
    ...DEPTHS.flatMap((depth) => (depth ? [false, true] : [false]).map((many) => compose(depth, many))),
    ...COMPARES.flatMap((compare) =>
      BOTH.flatMap((many) => BOTH.map((scaled) => resolveDepth(compare, many, scaled))),
    ),
    tileRanges,
    ...RECORD.flatMap((recordPrecision) => [
      ...EXTENTS.flatMap((extent) => [
        tileCount({ recordPrecision, extent }),
        tileMasks({ recordPrecision, extent }),
        ...PAIR_SORTS.map((shape) => tileEmit({ recordPrecision, extent }, shape)),
      ]),
      ...COLOR_TARGETS.flatMap((colorTarget) =>
        TILE_DEPTHS.flatMap((depth) =>
          BOTH.flatMap((isExactOrder) =>
            BOTH.map((isNarrow) =>
              tileRasterize({ recordPrecision, colorTarget, depth, isExactOrder, isNarrow }),
            ),
          ),
        ),
      ),
    ]),
    ...PAIR_SORTS.flatMap((shape) => [tilePlan(shape), ...radixSortStages(shape)]),
    ...COLOR_TARGETS.flatMap((target) => BOTH.map((hasDepthLayer) => upscale(target, hasDepthLayer))),
    ...RECORD.map(pick),
    ...RECORD.flatMap((precision) => [null, ...COMPARES].map((compare) => coverPoints(precision, compare))),
    ...RECORD.flatMap((recordPrecision) => [
      tileCosts(recordPrecision, 'counts'),
      tileCosts(recordPrecision, 'map'),
    ]),
    ...GEOMETRY.flatMap((geometryPrecision) => [
      ingestKeys(geometryPrecision),
      ingestChunks(geometryPrecision),
      ...SH_PRECISIONS.flatMap((shPrecision) =>
        DEGREES.flatMap((shDegree) =>
          [undefined, 45].map((entryValues) =>
            ingestRows({ geometryPrecision, shPrecision, shDegree, entryValues }),
          ),
        ),
      ),
    ]),
    ingestGather,
    ingestScatter,
    repackGeometry,
    ...DEGREES.slice(1).flatMap((degree) => [
      repackSh({ degree, from: 'f32', to: 'f16' }),
      repackSh({ degree, from: 'f32', to: 'u8' }),
      repackSh({ degree, from: 'f16', to: 'u8' }),
    ]),
    ...BALLOT_DEVICES.flatMap((ballots) =>
      [24, 27].flatMap((keyBits) => radixSortStages(sortShapeFor(keyBits, 49_152, false, ballots))),
    ),
    ...WORKGROUP_BYTES.flatMap((bytes) =>
      [8, 16, 20, 24, 27, 32].flatMap((keyBits) =>
        BOTH.flatMap((isNarrow) => radixSortStages(sortShapeFor(keyBits, bytes, isNarrow))),
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
  return [...new Map(stages.map((stage) => [JSON.stringify(stage), stage])).values()];
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
