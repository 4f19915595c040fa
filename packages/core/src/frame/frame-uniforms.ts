import { type DepthConvention, depthMapping } from '../data/camera/depth-convention.ts';
import type { FrustumSide } from '../data/camera/frustum.ts';
import type { GpuValues } from '../data/layout/gpu-struct.ts';
import { HostDepth, Page, View } from '../data/layout/structs.ts';
import type { CloudPlace } from './cloud-plan.ts';
import { type FramePage, pagesOf } from './frame-pages.ts';
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
  const bytes = new Uint8Array(contents);
  const words = new Uint32Array(contents);
  let first: FramePage | null = null;
  for (const [index, page] of pagesOf(shape).entries()) {
    const { cloudIndex, batchIndex, uniform, instances, chunksEach } = page;
    const cloud = clouds[cloudIndex];
    const cellCount = shape.clouds[cloudIndex].levels?.cellCount ?? 0;
    const count = instances?.count ?? 1;
    if (first?.cloudIndex === cloudIndex && first.batchIndex === batchIndex) {
      bytes.copyWithin(uniform.offset, first.uniform.offset, first.uniform.offset + uniform.size);
    } else {
      first = page;
      for (let i = 0; i < count; i++) {
        const place = instances ? cloud.places![instances.first + i] : cloud;
        Page.write(
          contents,
          placeValues(place, cloud.dilationPx2, i * cellCount),
          uniform.offset + i * Page.bytes,
        );
      }
      // Clears the rest of the batch, which may hold another frame's pages.
      bytes.fill(0, uniform.offset + count * Page.bytes, uniform.offset + uniform.size);
    }
    for (let i = 0; i < count; i++) {
      const start = (uniform.offset + i * Page.bytes) / 4;
      words[start + Page.offsets.index / 4] = index;
      words[start + Page.offsets.chunkStart / 4] = page.chunkStart + i * chunksEach;
      words[start + Page.offsets.chunkCount / 4] = chunksEach;
      words[start + Page.offsets.splatCount / 4] = page.splatCount;
    }
  }
}

/** Fields that all pages of a place have in common; the others are 0. */
function placeValues(
  { view, sides }: CloudPlace,
  dilationPx2: number,
  cellStart: number,
): GpuValues<typeof Page.fields> {
  return {
    linear: view.linear,
    translation: view.translation,
    dilationPx2,
    camera: view.camera ?? ORIGIN,
    cameraWeight: view.camera ? 1 : 0,
    sight: view.sight,
    direction: view.direction,
    cellStart,
    ...packedSides(sides),
    index: 0,
    chunkStart: 0,
    chunkCount: 0,
    splatCount: 0,
  };
}

const ORIGIN = [0, 0, 0] as const;

function packedSides(sides: readonly FrustumSide[]) {
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
