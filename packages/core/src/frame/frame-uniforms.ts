import { DILATION_PX2 } from '../data/accuracy/accuracy.ts';
import { type DepthConvention, depthMapping } from '../data/camera/depth-convention.ts';
import type { FrustumSide } from '../data/camera/frustum.ts';
import { HostDepth, Page, View } from '../data/layout/structs.ts';
import type { CloudPlace } from './cloud-plan.ts';
import { pagesOf } from './frame-pages.ts';
import type { FramePlan } from './frame-plan.ts';

/** Returns the contents of a frame's `view` buffer. */
export function viewUniforms({ projection, shape }: FramePlan): ArrayBuffer {
  const { widthPx, heightPx, focalPx, centerPx, clampX, clampY, near, far } = projection;
  return View.pack({
    sizePx: [widthPx, heightPx],
    focalPx,
    centerPx,
    clampX,
    clampY,
    near,
    // Shaders may assume that there are no infinities; the largest float32 does the same.
    far: Math.min(far, 3.4028234663852886e38),
    alphaCutoff: shape.accuracy.alphaCutoff,
    dilationPx2: DILATION_PX2,
    dispatchRow: shape.dispatchRow,
  });
}

/** Returns the contents of a frame's `hostDepth` buffer. */
export function hostDepthUniform({ camera }: FramePlan, mapping: DepthConvention['mapping']): ArrayBuffer {
  return HostDepth.pack(depthMapping(camera, mapping));
}

/**
 * Writes the contents of a frame's `pageUniforms` buffer.
 *
 * @param contents `uniformBytes` of the pages; reused for every frame, since allocating memory of
 *   this size is slow.
 */
export function writePageUniforms({ clouds, shape }: FramePlan, contents: ArrayBuffer): void {
  const sides = clouds.map((cloud) => (cloud.places ?? [cloud]).map(packedSides));
  for (const [index, page] of pagesOf(shape).entries()) {
    const { cloudIndex, splatCount, uniform, instances } = page;
    const { first, count } = instances ?? { first: 0, count: 1 };
    const chunkCount = page.chunkCount / count;
    // Those behind the last of a batch, which another frame may have had.
    if (instances) new Uint8Array(contents, uniform.offset, uniform.size).fill(0, count * Page.bytes);
    for (let i = 0; i < count; i++) {
      const { view } = clouds[cloudIndex].places?.[first + i] ?? clouds[cloudIndex];
      const values = {
        linear: view.linear,
        translation: view.translation,
        camera: view.camera ?? ORIGIN,
        cameraWeight: view.camera ? 1 : 0,
        direction: view.direction,
        ...sides[cloudIndex][first + i],
        index,
        chunkStart: page.chunkStart + i * chunkCount,
        chunkCount,
        splatCount,
      };
      Page.write(contents, values, uniform.offset + i * Page.bytes);
    }
  }
}

const ORIGIN = [0, 0, 0] as const;

function packedSides({ sides }: Pick<CloudPlace, 'sides'>) {
  return {
    frustum: fourEach(sides, ({ normal, offset }, into, at) => {
      into[at] = normal[0];
      into[at + 1] = normal[1];
      into[at + 2] = normal[2];
      into[at + 3] = offset;
    }),
    frustumReach: fourEach(sides, ({ reach }, into, at) => {
      into[at] = reach;
    }),
  };
}

/** Collects four numbers per side. */
function fourEach(
  sides: readonly FrustumSide[],
  fill: (side: FrustumSide, into: number[], at: number) => void,
): number[] {
  const numbers = new Array<number>(4 * sides.length).fill(0);
  for (let i = 0; i < sides.length; i++) fill(sides[i], numbers, 4 * i);
  return numbers;
}
