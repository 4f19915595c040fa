import { DILATION_PX2 } from '../accuracy/accuracy.ts';
import { type DepthConvention, depthMapping } from '../camera/depth-convention.ts';
import { HostDepth, Page, View } from '../layout/structs.ts';
import type { CloudPlan } from './cloud-plan.ts';
import { PAGE_STRIDE_BYTES, pagesOf } from './frame-pages.ts';
import type { FramePlan } from './frame-plan.ts';

/** Contents of a frame's `view` buffer. */
export function viewUniforms({ projection, shape }: FramePlan): ArrayBuffer {
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
    alphaCutoff: shape.accuracy.alphaCutoff,
    dilationPx2: DILATION_PX2,
    dispatchRow: shape.dispatchRow,
  });
  return contents;
}

/** Contents of a frame's `effects` buffer: the parameters of each cloud's effects, `strideBytes` apart. */
export function effectUniforms({ clouds }: FramePlan, strideBytes: number): ArrayBuffer {
  const contents = new Uint8Array(strideBytes * clouds.length);
  for (const [index, { parameters }] of clouds.entries()) {
    contents.set(new Uint8Array(parameters), index * strideBytes);
  }
  return contents.buffer;
}

/** Contents of a frame's `hostDepth` buffer. */
export function hostDepthUniform({ camera }: FramePlan, mapping: DepthConvention['mapping']): ArrayBuffer {
  const contents = new ArrayBuffer(HostDepth.bytes);
  HostDepth.write(contents, depthMapping(camera, mapping));
  return contents;
}

/** Contents of a frame's `pageUniforms` buffer. */
export function pageUniforms({ clouds, shape }: FramePlan): ArrayBuffer {
  const pages = pagesOf(shape);
  const perCloud = clouds.map(cloudUniforms);
  const contents = new ArrayBuffer(PAGE_STRIDE_BYTES * pages.length);
  for (const [index, { cloudIndex, chunkStart, chunkCount, splatCount }] of pages.entries()) {
    Page.write(
      contents,
      { ...perCloud[cloudIndex], index, chunkStart, chunkCount, splatCount },
      index * PAGE_STRIDE_BYTES,
    );
  }
  return contents;
}

function cloudUniforms({ instance: { cloud }, view, sides }: CloudPlan) {
  return {
    linear: view.linear,
    translation: view.translation,
    camera: view.camera ?? [0, 0, 0],
    cameraWeight: view.camera ? 1 : 0,
    direction: view.direction,
    logScales: [cloud.logScaleRange.min, cloud.logScaleRange.step],
    frustum: sides.flatMap(({ normal, offset }) => [...normal, offset]),
    frustumReach: sides.flatMap(({ reach }) => [reach, 0, 0, 0]),
  };
}
