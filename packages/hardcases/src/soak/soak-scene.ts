import {
  ACCURACY_PRESETS,
  type Accuracy,
  type AccuracyPreset,
  type Camera,
  type CloudInstance,
  type CloudPrecision,
  encodePly,
  type FixedDetail,
  type FrameRasterizer,
  type FrameRequest,
  orthographicCamera,
  perspectiveCamera,
  type ShDegree,
  type SplatCloud,
  type SplatEngine,
  type SplatSet,
  type Vec3,
} from '@websplatter/core';
import { antialias, brightness, clip, type EffectUse, fog, reveal, tint } from '@websplatter/core/effects';
import { ordinarySplats, resized, splatsOf, withRandomSh } from '../make-splats.ts';
import type { Chance } from './chance.ts';

/** Everything that a cloud is made from. */
export interface CloudRecipe {
  readonly set: SplatSet;
  /** Whether its splats come from the bytes of a PLY, or from memory. */
  readonly isFile: boolean;
  /** Precisions in order: planes made from others may differ by a step from those of a file. */
  readonly precisions: readonly CloudPrecision[];
  /** How many of these there were when its levels of detail were made; null if it has none. */
  readonly levelsAfter: number | null;
}

/** How a cloud is drawn. */
export type Placing = Omit<CloudInstance, 'cloud'>;

/** A cloud of the scene. */
export interface SoakCloud {
  recipe: CloudRecipe;
  cloud: SplatCloud;
  placing: Placing;
}

/** Camera and settings of a frame, besides its clouds. */
export interface SoakView {
  camera: { readonly position: Vec3; readonly target: Vec3; readonly isOrthographic: boolean };
  readonly size: { readonly widthPx: number; readonly heightPx: number };
  accuracy: Accuracy;
  detail: FixedDetail;
  background: Vec3;
}

const DEGREES: readonly ShDegree[] = [0, 1, 2, 3];
const RASTERIZERS: readonly FrameRasterizer[] = ['tiles', 'quads'];
/** Splats of `ordinarySplats` lie about the origin, up to this far from it. */
const SCENE_REACH = 6;

export function randomRecipe(chance: Chance): CloudRecipe {
  const seed = chance.whole(1, 1e6);
  const shDegree = chance.of(DEGREES);
  const copies = chance.whole(1, 6);
  const splats = Array.from({ length: copies }, (_, i) => resized(ordinarySplats(seed + i), 1 + 0.1 * i));
  const set = splatsOf(withRandomSh(splats.flat(), shDegree, 0.2), { shDegree });
  return { set, isFile: chance.happens(0.5), precisions: [randomPrecision(chance)], levelsAfter: null };
}

export function randomPrecision(chance: Chance): CloudPrecision {
  return {
    geometryPrecision: chance.of(['f32', 'packed'] as const),
    shPrecision: chance.of(['f32', 'f16', 'u8'] as const),
  };
}

/** Makes the cloud, with its planes remade as often as they were before, and levels of the same. */
export async function makeCloud(
  engine: SplatEngine,
  { set, isFile, precisions, levelsAfter }: CloudRecipe,
  signal?: AbortSignal,
): Promise<SplatCloud> {
  const cloud = isFile
    ? await engine.load(new Blob([encodePly(set)]), { precision: precisions[0], signal, name: 'soak.ply' })
    : engine.add(set, { name: 'soak' });
  for (const [i, precision] of precisions.entries()) {
    if (i > 0 || !isFile) await engine.requestPrecision(cloud, precision, { signal });
    if (i + 1 === levelsAfter) await cloud.makeLevels();
  }
  return cloud;
}

export function randomPlacing(chance: Chance): Placing {
  return {
    modelMatrix: randomModelMatrix(chance),
    opacity: chance.happens(0.8) ? 1 : chance.within(0, 1),
    shDegree: chance.of(DEGREES),
    effects: randomEffects(chance),
  };
}

/** A turn about y, a scale, perhaps a mirror, and a move. */
function randomModelMatrix(chance: Chance): number[] {
  if (chance.happens(0.3)) return [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];
  const angle = chance.within(-Math.PI, Math.PI);
  const scale = chance.within(0.3, 1.5);
  const [cos, sin] = [scale * Math.cos(angle), scale * Math.sin(angle)];
  const height = chance.happens(0.2) ? -scale : scale;
  return [cos, 0, -sin, 0, 0, height, 0, 0, sin, 0, cos, 0, ...chance.vector(2), 1];
}

export function randomEffects(chance: Chance): EffectUse[] {
  const possible: readonly (() => EffectUse)[] = [
    () => tint([chance.within(0, 1), chance.within(0, 1), chance.within(0, 1)]),
    () => brightness(chance.within(0, 2)),
    () => antialias(),
    () => fog({ color: [0.5, 0.6, 0.7], near: chance.within(0, 4), far: chance.within(5, 20) }),
    () => clip({ volumes: [{ shape: 'sphere', center: chance.vector(2), radius: chance.within(0.5, 6) }] }),
    () => reveal({ from: chance.vector(2), radius: chance.within(0, 8), softEdge: chance.within(0, 2) }),
  ];
  return possible.filter(() => chance.happens(0.15)).map((make) => make());
}

export function randomAccuracy(chance: Chance): Accuracy {
  return {
    preset: chance.of(Object.keys(ACCURACY_PRESETS) as AccuracyPreset[]),
    rasterizer: chance.of([...RASTERIZERS, ...RASTERIZERS, 'auto'] as const),
    ...(chance.happens(0.3) && { sortKeyBits: chance.of([16, 24, 32] as const) }),
    ...(chance.happens(0.2) && { recordPrecision: chance.of(['f32', 'f16', 'paper'] as const) }),
    ...(chance.happens(0.2) && { resolutionScale: chance.of([0.5, 0.75, 1]) }),
    ...(chance.happens(0.2) && { extent: chance.of(['opacity', 'fixed'] as const) }),
    ...(chance.happens(0.2) && { alphaCutoff: chance.of([1 / 1024, 1 / 255, 0.05]) }),
  };
}

export function randomDetail(chance: Chance): FixedDetail {
  return chance.of([
    'full',
    { maxErrorPx: chance.within(0, 4) },
    { maxSplats: chance.whole(1, 1000) },
    { maxShare: chance.within(0.01, 1) },
    { maxErrorPx: chance.within(0, 4), maxSplats: chance.whole(1, 1000) },
  ]);
}

export function randomSize(chance: Chance): SoakView['size'] {
  return { widthPx: chance.whole(1, 96), heightPx: chance.whole(1, 96) };
}

export function randomCamera(chance: Chance): SoakView['camera'] {
  const position = chance.vector(SCENE_REACH);
  // Never straight up or down, which is no line of sight.
  position[2] += 0.1;
  return { position, target: [0, 0, 0], isOrthographic: chance.happens(0.15) };
}

function cameraOf({ camera: { position, target, isOrthographic }, size }: SoakView): Camera {
  const aspect = size.widthPx / size.heightPx;
  return isOrthographic
    ? orthographicCamera({ position, target, aspect, height: 8, near: -20, far: 40 })
    : perspectiveCamera({ position, target, aspect, fovYDegrees: 60 });
}

/** The frame that shows `clouds` in this view. */
export function requestOf(
  view: SoakView,
  clouds: readonly Pick<SoakCloud, 'cloud' | 'placing'>[],
): FrameRequest {
  return {
    camera: cameraOf(view),
    clouds: clouds.map(({ cloud, placing }) => ({ cloud, ...placing })),
    ...view.size,
    accuracy: view.accuracy,
    detail: view.detail,
    background: view.background,
  };
}
