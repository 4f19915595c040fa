import { BLOB_PRECISION } from '../data/packing/precision.ts';
import { antialias } from '../gpu/effects/antialias/antialias.ts';
import type { StageDefinition } from '../gpu/pipelines.ts';
import { batchInstances, type FramePage } from './frame-pages.ts';
import { type CloudShape, type FrameShape, perShape } from './frame-shape.ts';

/** Everything that decides the stages of a cloud's pages. */
export type PageVariant = ReturnType<typeof variantOf>;

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

/** Stages that differ between the pages of a frame. */
export interface PageStages<Name extends string> {
  /** Stages of all pages of frames of this shape. */
  all(shape: FrameShape): StageDefinition[];
  /** Stages of one page; null for a stage that does not run over it. */
  of(
    shape: FrameShape,
    page: Pick<FramePage, 'cloudIndex' | 'isBlobs'>,
  ): Readonly<Record<Name, StageDefinition | null>>;
}

/** Makes stages once per shape: one set for the splats of each cloud, and one for its blobs. */
export function pageStages<Name extends string>(
  make: (variant: PageVariant) => Readonly<Record<Name, StageDefinition | null>>,
): PageStages<Name> {
  const ofClouds = perShape((shape) =>
    shape.clouds.map((cloud) => {
      const variant = variantOf(shape, cloud);
      const isDilated = !cloud.effects.parts.some(({ effect }) => effect === antialias.effect);
      const blobs = cloud.levels ? [make({ ...variant, ...BLOB_PRECISION, isDilated })] : [];
      return [make(variant), ...blobs];
    }),
  );
  return {
    all: (shape) =>
      ofClouds(shape)
        .flat()
        .flatMap((stages) => Object.values<StageDefinition | null>(stages).filter((each) => each !== null)),
    of: (shape, { cloudIndex, isBlobs }) => ofClouds(shape)[cloudIndex][Number(isBlobs)],
  };
}
