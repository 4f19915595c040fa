import { DILATION_PX2 } from '../accuracy/accuracy.ts';
import type { Camera, Projection } from '../camera/camera.ts';
import { cloudView } from '../camera/cloud-view.ts';
import { type DepthConvention, depthMapping } from '../camera/depth-convention.ts';
import { cullPlanes } from '../camera/frustum.ts';
import { writeParameters } from '../effects/effect-set.ts';
import { reachOf, usesOf } from '../effects/effects.ts';
import { HostDepth, Page, View } from '../layout/structs.ts';
import { identity4 } from '../math/mat4.ts';
import type { ViewFrame } from './frame-request.ts';
import { type FrameResources, PAGE_STRIDE_BYTES } from './frame-resources.ts';
import type { FrameShape } from './frame-shape.ts';

/** Contents of a frame's `view` buffer. */
export function viewUniforms(projection: Projection, { accuracy, dispatchRow }: FrameShape): ArrayBuffer {
  const { widthPx, heightPx, focalPx, centerPx, clampX, clampY, near, far } = projection;
  const contents = new ArrayBuffer(View.bytes);
  View.write(contents, {
    sizePx: [widthPx, heightPx],
    focalPx,
    centerPx,
    clampX,
    clampY,
    near,
    // Shaders may assume that there are no infinities: the largest float32 is as good.
    far: Math.min(far, 3.4028234663852886e38),
    alphaCutoff: accuracy.alphaCutoff,
    dilationPx2: DILATION_PX2,
    dispatchRow,
  });
  return contents;
}

/** Contents of a frame's `effects` buffer: the parameters of each cloud's effects, `strideBytes` apart. */
export function effectUniforms({ camera, clouds }: ViewFrame, strideBytes: number): ArrayBuffer {
  const contents = new ArrayBuffer(strideBytes * clouds.length);
  for (const [index, instance] of clouds.entries()) {
    const { cloud, modelMatrix = identity4() } = instance;
    const place = { modelMatrix, origin: cloud.origin, viewMatrix: camera.viewMatrix };
    writeParameters(contents, usesOf(instance), place, index * strideBytes);
  }
  return contents;
}

/** Contents of a frame's `hostDepth` buffer. */
export function hostDepthUniform(camera: Camera, mapping: DepthConvention['mapping']): ArrayBuffer {
  const contents = new ArrayBuffer(HostDepth.bytes);
  HostDepth.write(contents, depthMapping(camera, mapping));
  return contents;
}

/** Contents of a frame's `pageUniforms` buffer. */
export function pageUniforms(
  { camera, clouds }: ViewFrame,
  projection: Projection,
  frame: FrameResources,
): ArrayBuffer {
  const { alphaCutoff } = frame.shape.accuracy;
  const perCloud = clouds.map((instance) => {
    const { cloud, modelMatrix = identity4() } = instance;
    const view = cloudView(camera.viewMatrix, modelMatrix, cloud.origin, projection.isOrthographic);
    const reach = reachOf(usesOf(instance));
    const planes = cullPlanes(view, projection, alphaCutoff, DILATION_PX2, reach);
    return {
      linear: view.linear,
      translation: view.translation,
      camera: view.camera ?? [0, 0, 0],
      cameraWeight: view.camera ? 1 : 0,
      direction: view.direction,
      logScales: [cloud.logScaleRange.min, cloud.logScaleRange.step],
      frustum: planes.flatMap(({ normal, offset }) => [...normal, offset]),
      frustumReach: planes.flatMap(({ reach }) => [reach, 0, 0, 0]),
    };
  });
  const contents = new ArrayBuffer(PAGE_STRIDE_BYTES * frame.pages.length);
  for (const [index, { cloudIndex, chunkStart, chunkCount, splatCount }] of frame.pages.entries()) {
    Page.write(
      contents,
      { ...perCloud[cloudIndex], index, chunkStart, chunkCount, splatCount },
      index * PAGE_STRIDE_BYTES,
    );
  }
  return contents;
}
