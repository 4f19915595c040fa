import {
  ACCURACY_PRESETS,
  type Accuracy,
  type AccuracyPreset,
  type Camera,
  type CloudInstance,
  type CloudInstances,
  type CloudPrecision,
  encodePly,
  type FixedDetail,
  type FrameRasterizer,
  type FrameRequest,
  orthographicCamera,
  perspectiveCamera,
  type ShDegree,
  type SortBy,
  type SplatCloud,
  type SplatEngine,
  type SplatSet,
  type Vec3,
} from '@websplatter/core';
import {
  antialias,
  brightness,
  type EffectUse,
  fog,
  highlight,
  reveal,
  SplatSelection,
  tint,
  volumes,
} from '@websplatter/core/effects';
import {
  type EditedValues,
  flushEdits,
  followEdits,
  followMorph,
  type RowRange,
  SplatEdits,
  SplatMorph,
} from '@websplatter/core/own-data';
import { ordinarySplats, resized, splatsOf, withRandomSh } from '../make-splats.ts';
import type { Chance } from './chance.ts';

/** A change of a cloud. Missing values take back the edits of the rows. */
export type CloudChange =
  | { readonly precision: CloudPrecision }
  | { readonly rows: RowRange; readonly values?: EditedValues }
  | 'levels';

/** Everything that a cloud is made from. */
export interface CloudRecipe {
  readonly set: SplatSet;
  /** The splats come from the bytes of a PLY or from memory, or lie between two sets. */
  readonly source: 'file' | 'memory' | SplatMorph;
  readonly precision: CloudPrecision;
  /**
   * Changes in order. Their order affects the bits: planes made from other planes may differ by a step
   * from planes made from the file, and levels are made from the present planes.
   */
  readonly changes: readonly CloudChange[];
}

export interface EditableCloud {
  cloud: SplatCloud;
  edits: SplatEdits;
}

export type Placing = Omit<CloudInstance, 'cloud'>;

/** A cloud of the scene. */
export interface SoakCloud extends EditableCloud {
  recipe: CloudRecipe;
  placing: Placing;
}

/** Camera and settings of a frame, without its clouds. */
export interface SoakView {
  camera: { readonly position: Vec3; readonly target: Vec3; readonly isOrthographic: boolean };
  readonly size: { readonly widthPx: number; readonly heightPx: number };
  accuracy: Accuracy;
  detail: FixedDetail;
  sortBy: SortBy;
  background: Vec3;
}

const DEGREES: readonly ShDegree[] = [0, 1, 2, 3];
const RASTERIZERS: readonly FrameRasterizer[] = ['tiles', 'quads'];
/** Splats of `ordinarySplats` lie about the origin, up to this far from it. */
const SCENE_REACH = 6;

export function randomRecipe(chance: Chance): CloudRecipe {
  const copies = chance.whole(1, 6);
  const set = randomSet(chance, copies);
  const source = chance.weighted([
    { weight: 4, of: () => 'file' as const },
    { weight: 4, of: () => 'memory' as const },
    { weight: 1, of: () => new SplatMorph(set, randomSet(chance, copies), randomPrecision(chance)) },
  ]);
  return { set, source: source.of(), precision: randomPrecision(chance), changes: [] };
}

function randomSet(chance: Chance, copies: number): SplatSet {
  const seed = chance.whole(1, 1e6);
  const shDegree = chance.of(DEGREES);
  const splats = Array.from({ length: copies }, (_, i) => resized(ordinarySplats(seed + i), 1 + 0.1 * i));
  return splatsOf(withRandomSh(splats.flat(), shDegree, 0.2), { shDegree });
}

export function randomPrecision(chance: Chance): CloudPrecision {
  return {
    geometryPrecision: chance.of(['f32', 'packed'] as const),
    shPrecision: chance.of(['f32', 'f16', 'u8'] as const),
  };
}

/** Makes the cloud, and changes it as often as it was changed before. */
export async function makeCloud(
  engine: SplatEngine,
  recipe: CloudRecipe,
  signal?: AbortSignal,
): Promise<EditableCloud> {
  const cloud = await makeUnchanged(engine, recipe, signal);
  const item = { cloud, edits: new SplatEdits(recipe.set.count) };
  for (const change of recipe.changes) await changeCloud(engine, item, change, signal);
  return item;
}

async function makeUnchanged(
  engine: SplatEngine,
  { set, source, precision }: CloudRecipe,
  signal?: AbortSignal,
): Promise<SplatCloud> {
  if (source === 'file')
    return engine.load(new Blob([encodePly(set)]), { precision, signal, name: 'soak.ply' });
  if (source === 'memory') {
    const cloud = engine.add(set, { name: 'soak' });
    await engine.requestPrecision(cloud, precision, { signal });
    return cloud;
  }
  const cloud = engine.addPacked(source.packed);
  await followMorph(cloud, source);
  return cloud;
}

export async function changeCloud(
  engine: SplatEngine,
  { cloud, edits }: EditableCloud,
  change: CloudChange,
  signal?: AbortSignal,
): Promise<void> {
  if (change === 'levels') await cloud.makeLevels();
  else if ('precision' in change) await engine.requestPrecision(cloud, change.precision, { signal });
  else {
    await followEdits(cloud, edits);
    if (change.values) edits.set(change.rows, change.values);
    else edits.reset(change.rows);
  }
  // As if each change were drawn: edits that are uploaded together may differ by a step.
  flushEdits(cloud);
}

/** Equal values for some successive rows, or no values, which take edits back. */
export function randomEdit(chance: Chance, { count: splats }: SplatSet): CloudChange {
  const first = chance.whole(0, splats - 1);
  const rows = { first, count: chance.whole(1, Math.min(40, splats - first)) };
  if (chance.happens(0.15)) return { rows };
  const [x, y, z] = chance.vector(1);
  const value = <Value>(probability: number, make: () => Value) =>
    chance.happens(probability) ? make() : undefined;
  const values = {
    positions: value(0.4, () => chance.vector(3)),
    scales: value(0.4, () => [0, 1, 2].map(() => Math.exp(chance.within(-5, 0)))),
    rotations: value(0.4, () => [x, y, z, 1]),
    opacities: value(0.4, () => [chance.within(0, 1)]),
    colors: value(0.4, () => chance.vector(1)),
    visible: value(0.3, () => chance.happens(0.5)),
  };
  return { rows, values };
}

export function randomPlacing(chance: Chance): Placing {
  return {
    modelMatrix: randomModelMatrix(chance),
    instances: chance.happens(0.3) ? randomInstances(chance) : undefined,
    opacity: chance.happens(0.8) ? 1 : chance.within(0, 1),
    shDegree: chance.of(DEGREES),
    effects: randomEffects(chance),
  };
}

/** 0 to 12 instances. */
function randomInstances(chance: Chance): CloudInstances {
  const places = Array.from({ length: chance.whole(0, 12) }, () => randomModelMatrix(chance));
  return {
    modelMatrices: places.flat(),
    tints: chance.happens(0.5) ? places.flatMap(() => chance.vector(1).map(Math.abs)) : undefined,
    opacities: chance.happens(0.5) ? places.map(() => chance.within(0, 1)) : undefined,
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
    () => highlight({ selection: randomSelection(chance), color: [1, 0.5, 0], strength: 0.5 }),
    () => fog({ color: [0.5, 0.6, 0.7], near: chance.within(0, 4), far: chance.within(5, 20) }),
    () =>
      volumes([{ shape: 'sphere', mode: 'keep', center: chance.vector(2), radius: chance.within(0.5, 6) }]),
    () => reveal({ from: chance.vector(2), radius: chance.within(0, 8), softEdge: chance.within(0, 2) }),
  ];
  return possible.filter(() => chance.happens(0.15)).map((make) => make());
}

function randomSelection(chance: Chance): SplatSelection {
  const selection = new SplatSelection();
  selection.add(Array.from({ length: chance.whole(0, 50) }, () => chance.whole(0, 500)));
  return selection;
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
  // Never straight up or down, parallel to the camera's up.
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
    sortBy: view.sortBy,
    background: view.background,
  };
}
