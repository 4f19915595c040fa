import {
  type AccuracyRequest,
  type CloudInstance,
  cameraFromMatrices,
  combineAccuracies,
  type Camera as EngineCamera,
  type SplatCloud,
  type SplatEngine,
} from '@websplatter/core';
import type { Camera, Object3D, PerspectiveCamera } from 'three/webgpu';
import type { DrawnCloud, LayerCloud } from './layer-cloud.ts';

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
