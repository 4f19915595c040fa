import {
  type AccuracyRequest,
  type CloudInstance,
  cameraFromMatrices,
  combineAccuracies,
  type Detail,
  type EmbeddedFrameRequest,
  type Camera as EngineCamera,
  type SplatCloud,
  type SplatEngine,
} from '@websplatter/core';
import type { EffectUse } from '@websplatter/core/effects';
import type { Camera, Object3D, PerspectiveCamera } from 'three/webgpu';
import { splatDetailOf } from '../renderer/adopt-renderer.ts';
import type { OpenPass, PassPart } from '../renderer/three-bridge.ts';
import type { DrawnCloud, FramePlace, FrameUse, LayerCloud } from './layer-cloud.ts';
import type { LayerView } from './layer-view.ts';

/**
 * Returns `object` as a frame is to draw it; null while it is uploaded, or code for its effects is
 * loaded.
 */
export function instanceOf(
  object: LayerCloud,
  engine: SplatEngine,
  effects: CloudInstance['effects'] | null,
): DrawnCloud | null {
  const cloud = object.uploadedTo(engine);
  if (!cloud || !effects) return null;
  const { drawnOpacity: opacity, time, shDegree, matrixWorld, accuracy, detail } = object;
  if (time !== null) checkFrames(cloud);
  const instances = object.instances?.drawn();
  // A copy: if the next frame is refused, the cloud is drawn with this matrix again.
  const modelMatrix = [...matrixWorld.elements];
  return {
    cloud,
    modelMatrix,
    instances,
    opacity,
    time: time ?? undefined,
    shDegree,
    effects,
    accuracy,
    detail,
  };
}

const warned = new WeakSet<SplatCloud>();

/** Warns that `time` chooses no frame, once for each cloud of a file of frames. */
function checkFrames(cloud: SplatCloud): void {
  if (!cloud.facts.fileFacts?.frames || warned.has(cloud)) return;
  warned.add(cloud);
  console.warn(
    `${cloud.name} has frames, of which \`time\` chooses none. Play them by useSplatSequence or SplatSequence.`,
  );
}

/** Returns the effects of a cloud with their parameters in a frame; undefined while their code is loaded. */
export function effectsIn(
  place: FramePlace & { object: LayerCloud; nowMs: number },
): EffectUse[] | undefined {
  const uses = place.object.effectsAt(place.nowMs, place.scene, place.camera);
  return uses?.map((use: FrameUse) => use.inFrame?.(place) ?? use);
}

/** Prepares a view to draw clouds in its part of a pass; returns whether they can be drawn. */
export function prepareView(
  { embedded, place }: LayerView,
  { depth, hasOccluders }: OpenPass,
  { camera, widthPx, heightPx }: PassPart,
  drawn: ReadonlyMap<LayerCloud, DrawnCloud>,
  other: Partial<EmbeddedFrameRequest>,
): boolean {
  const clouds = [...drawn.values()];
  return embedded.prepare({
    camera: engineCamera(camera, depth?.compare === 'greater-equal'),
    clouds,
    widthPx,
    heightPx,
    depth,
    hasOccluders,
    writesDepth: [...drawn.keys()].some(({ depthWrite }) => depthWrite),
    accuracy: accuracyOf(clouds),
    detail: layerDetail(clouds) ?? splatDetailOf(place.renderer),
    ...other,
  });
}

/** Returns the accuracy that all `clouds` together request; undefined if none does. */
export function accuracyOf(clouds: Iterable<Pick<LayerCloud, 'accuracy'>>): AccuracyRequest | undefined {
  return combineAccuracies([...clouds].flatMap(({ accuracy }) => accuracy ?? []));
}

/** Converts three's camera, as prepared for this render: matrices, clip depth from 0 to 1. */
export function engineCamera(camera: Camera, isReversed: boolean): EngineCamera {
  const projection = camera.projectionMatrix.elements;
  const inMatrix = depthRange(projection, isReversed);
  const parametric = camera as PerspectiveCamera;
  const { near = inMatrix.near, far = inMatrix.far, view }: Partial<PerspectiveCamera> = parametric;
  return {
    ...cameraFromMatrices(camera.matrixWorldInverse.elements, projection, { near, far }),
    wholeProjectionMatrix: view?.enabled ? wholeProjection(parametric) : undefined,
  };
}

/** Returns the projection of the image that `camera.setViewOffset` shows a part of. */
function wholeProjection(camera: PerspectiveCamera): number[] {
  // Without children; three's types do not know the argument.
  const whole = (camera as Object3D).clone(false) as PerspectiveCamera;
  whole.clearViewOffset();
  return whole.projectionMatrix.elements;
}

/**
 * Returns near and far of a camera that has only a matrix: the depths at which its clip depth is 0
 * and 1.
 */
function depthRange(p: readonly number[], isReversed: boolean): { near: number; far: number } {
  const isOrthographic = p[11] === 0;
  const atZero = p[14] / p[10];
  const atOne = isOrthographic ? (p[14] - 1) / p[10] : p[14] / (p[10] + 1);
  return isReversed ? { near: atOne, far: atZero } : { near: atZero, far: atOne };
}

/**
 * Returns the finest detail that any cloud of a frame requests; null if no cloud does. From finest
 * to coarsest: `full`, a PSNR, limits, a frame time, `auto`. The largest of several budgets holds
 * for all clouds together. If one cloud limits the error and another has a budget, the error wins.
 */
export function layerDetail(clouds: Iterable<Pick<LayerCloud, 'detail'>>): Detail | null {
  const asked = [...clouds].flatMap(({ detail }) => detail ?? []);
  return asked.length > 0 ? asked.reduce(finerOf) : null;
}

function finerOf(a: Detail, b: Detail): Detail {
  const [first, second] = [a, b].map(rankOf);
  if (first !== second) return first < second ? a : b;
  if (typeof a === 'string') return a;
  const other = b as Limits;
  const limits = Object.entries(a).flatMap(([name, own]) => {
    const limit = other[name];
    if (own === undefined || limit === undefined) return [];
    return [[name, name === 'maxErrorPx' ? Math.min(own, limit) : Math.max(own, limit)]];
  });
  if (limits.length > 0) return Object.fromEntries(limits);
  const named = ['maxErrorPx', 'maxShare', 'maxSplats'].find(
    (name) => ((a as Limits)[name] ?? other[name]) !== undefined,
  )!;
  return other[named] === undefined ? a : b;
}

function rankOf(detail: Detail): number {
  if (detail === 'full') return 0;
  if (detail === 'auto') return 4;
  const { minPsnrDb, maxFrameMs } = detail as Limits;
  return minPsnrDb !== undefined ? 1 : maxFrameMs !== undefined ? 3 : 2;
}

/** Numbers that limit a detail, as far as it has them. */
type Limits = Partial<Record<string, number>>;
