import type { CloudPage } from '../clouds/cloud-planes.ts';
import { CHUNK_SPLATS, SHADER_CONSTANTS } from '../data/layout/constants.ts';
import { roundUp } from '../data/layout/gpu-struct.ts';
import { Page } from '../data/layout/structs.ts';
import { type FrameShape, perShape } from './frame-shape.ts';

/** Offsets of uniform bindings are multiples of this many bytes. */
export const UNIFORM_ALIGNMENT = 256;
/** Bytes from one `Page` to the next in a frame's uniforms. */
export const PAGE_STRIDE_BYTES = roundUp(Page.bytes, UNIFORM_ALIGNMENT);

/** One page of one of the frame's clouds. */
export interface FramePage extends CloudPage {
  readonly cloudIndex: number;
  /** First chunk of the page, counting through the frame. */
  readonly chunkStart: number;
  /** Links of the page's splats; null where all are drawn. */
  readonly links: GPUBuffer | null;
  /** Whether they are blobs, which stand for splats of the pages before. */
  readonly isBlobs: boolean;
}

/** All pages of a frame's clouds, in the clouds' order. */
export const pagesOf = perShape(({ clouds }: FrameShape): readonly FramePage[] => {
  let chunkStart = 0;
  return clouds.flatMap(({ planes, levels }, cloudIndex) => {
    const splats = planes.pages.map((page, i) => ({
      ...page,
      links: levels?.splatLinks[i] ?? null,
      isBlobs: false,
    }));
    const blobs = levels?.blobPages.map((page) => ({ ...page, isBlobs: true })) ?? [];
    return [...splats, ...blobs].map((page) => {
      const framePage = { ...page, cloudIndex, chunkStart };
      chunkStart += page.chunkCount;
      return framePage;
    });
  });
});

/** Most workgroups that the visible splats of a page can take, at one thread per splat. */
export function projectWorkgroups(chunkCount: number): number {
  return Math.ceil((chunkCount * CHUNK_SPLATS) / SHADER_CONSTANTS.PROJECT_WORKGROUP);
}

/** Number of chunks of all pages. */
export function totalChunks(pages: readonly FramePage[]): number {
  return pages.reduce((sum, { chunkCount }) => sum + chunkCount, 0);
}

/** Place of a splat of a frame. */
export interface FrameSplat {
  readonly cloudIndex: number;
  /** Index in storage; for a blob, behind all splats of the cloud: pages of blobs follow theirs. */
  readonly storedIndex: number;
  /** Where the splat is a blob: the page of the cloud's blobs, and the chunk and slot there. */
  readonly blob: { readonly page: number; readonly chunk: number; readonly slot: number } | null;
}

/** Finds the cloud of splat `number`, counted through the frame's chunks, and its storage index. */
export function locateSplat(pages: readonly FramePage[], number: number): FrameSplat {
  const chunk = Math.floor(number / CHUNK_SPLATS);
  const found = pages.findLast(({ chunkStart }) => chunkStart <= chunk)!;
  const { cloudIndex } = found;
  // Only the last page of a cloud may have a partial chunk, so its pages are one run of splats.
  const { chunkStart } = pages.find((page) => page.cloudIndex === cloudIndex)!;
  const blobPages = pages.filter((page) => page.cloudIndex === cloudIndex && page.isBlobs);
  const blob = found.isBlobs
    ? { page: blobPages.indexOf(found), chunk: chunk - found.chunkStart, slot: number % CHUNK_SPLATS }
    : null;
  return { cloudIndex, storedIndex: number - CHUNK_SPLATS * chunkStart, blob };
}
