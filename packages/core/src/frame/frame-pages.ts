import type { CloudPage } from '../clouds/cloud-planes.ts';
import { CHUNK_SPLATS, SHADER_CONSTANTS } from '../data/layout/constants.ts';
import { roundUp } from '../data/layout/gpu-struct.ts';
import { Page } from '../data/layout/structs.ts';
import type { EffectSet } from '../gpu/effects/effect-set.ts';
import type { DispatchSize } from '../gpu/passes.ts';
import { dispatchSize } from '../stages/dispatch.ts';
import { type CloudShape, type FrameShape, perShape } from './plan/frame-shape.ts';

/** Offsets of bindings are multiples of this many bytes on every device. */
export const BINDING_ALIGNMENT = 256;
/** Bytes that a uniform binding may have on every device. */
const UNIFORM_BINDING_BYTES = 65_536;

/** One page of one of the frame's clouds, or of a batch of one's instances. */
export interface FramePage extends CloudPage {
  readonly cloudIndex: number;
  /** Index of the page's batch within the cloud. */
  readonly batchIndex: number;
  /** Range of the page's instances in the cloud's list; null without instances. */
  readonly instances: { readonly first: number; readonly count: number } | null;
  /** First chunk of the page, counting through the frame. */
  readonly chunkStart: number;
  /** Chunks of each of its instances, and of all of them, one after another. */
  readonly chunksEach: number;
  readonly chunkCount: number;
  /** First splat of the page, counting through the cloud; blobs follow all splats. */
  readonly splatStart: number;
  /**
   * Bytes of the frame's page-uniform buffer that hold the `Page` struct of this page; if instances
   * are drawn in a batch, the structs of the whole batch.
   */
  readonly uniform: UniformRange;
  /** Range of the page's effect parameters in the frame's. */
  readonly parameters: UniformRange;
  /** Links of the page's splats; null where all are drawn. */
  readonly links: GPUBuffer | null;
  /** Whether the page holds blobs, which stand for splats of earlier pages. */
  readonly isBlobs: boolean;
}

/** Place of a binding in a buffer of uniforms, bytes. */
export interface UniformRange {
  readonly offset: number;
  readonly size: number;
}

/** Most instances that the least uniform binding has room for. */
export function instancesPerBinding({ parameterBytes }: EffectSet): number {
  return Math.floor(UNIFORM_BINDING_BYTES / Math.max(Page.bytes, parameterBytes));
}

/** Most instances of a cloud that stages draw together. */
export function batchInstances({ planes, effects }: CloudShape): number {
  // Of one page, since splats of a cloud are drawn one after another.
  return planes.pages.length === 1 ? instancesPerBinding(effects) : 1;
}

/** Instances of a cloud that stages draw together. */
export interface Batch {
  /** In the cloud's list. */
  readonly first: number;
  readonly count: number;
  /** Number of instances that its bindings have room for. */
  readonly places: number;
}

/** All batches of a cloud; one of a single place for a cloud without instances. */
export function batchesOf(cloud: CloudShape): Batch[] {
  const { instanceCount } = cloud;
  if (instanceCount === null) return [{ first: 0, count: 1, places: 1 }];
  const places = batchInstances(cloud);
  return Array.from({ length: Math.ceil(instanceCount / places) }, (_, batch) => {
    const first = batch * places;
    return { first, count: Math.min(places, instanceCount - first), places };
  });
}

/** All pages of a frame, by cloud and then by instance. */
export const pagesOf = perShape(({ clouds }: FrameShape): readonly FramePage[] => {
  let chunkStart = 0;
  let [uniformEnd, parametersEnd] = [0, 0];
  return clouds.flatMap((cloud, cloudIndex) => {
    const { planes, levels, effects, instanceCount } = cloud;
    const splats = planes.pages.map((page, i) => ({
      ...page,
      links: levels?.splatLinks[i] ?? null,
      isBlobs: false,
    }));
    const blobs = levels?.blobPages.map((page) => ({ ...page, isBlobs: true })) ?? [];
    return batchesOf(cloud).flatMap(({ first, count, places }, batchIndex) => {
      let splatStart = 0;
      return [...splats, ...blobs].map((page): FramePage => {
        const framePage = {
          ...page,
          cloudIndex,
          batchIndex,
          instances: instanceCount === null ? null : { first, count },
          chunkStart,
          chunksEach: page.chunkCount,
          chunkCount: count * page.chunkCount,
          splatStart,
          uniform: { offset: uniformEnd, size: Page.bytes * places },
          parameters: { offset: parametersEnd, size: effects.parameterBytes * places },
        };
        chunkStart += framePage.chunkCount;
        splatStart += page.chunkCount * CHUNK_SPLATS;
        uniformEnd = endOf(framePage.uniform);
        parametersEnd = endOf(framePage.parameters);
        return framePage;
      });
    });
  });
});

/** Returns the size of a buffer for all of `ranges`. */
export function uniformBytes(ranges: readonly UniformRange[]): number {
  return endOf(ranges.at(-1) ?? { offset: 0, size: 0 });
}

function endOf({ offset, size }: UniformRange): number {
  return roundUp(offset + size, BINDING_ALIGNMENT);
}

/** Most workgroups that the visible splats of a page can take, at one thread per splat. */
export function projectWorkgroups(chunkCount: number): number {
  return Math.ceil((chunkCount * CHUNK_SPLATS) / SHADER_CONSTANTS.PROJECT_WORKGROUP);
}

/** Size of a dispatch with a thread for each of `count` chunks, or cells of as many splats. */
export function sizeOverChunks(count: number, { dispatchRow }: FrameShape): DispatchSize {
  // At least one workgroup: Dawn warns about empty dispatches.
  return dispatchSize(Math.max(1, Math.ceil(count / SHADER_CONSTANTS.CHUNK_WORKGROUP)), dispatchRow);
}

/** Number of chunks of all pages. */
export function totalChunks(pages: readonly FramePage[]): number {
  return pages.reduce((sum, { chunkCount }) => sum + chunkCount, 0);
}

/** Place of a splat of a frame. */
export interface FrameSplat {
  readonly cloudIndex: number;
  /** Index in the list of the cloud's instances; null without one. */
  readonly instanceIndex: number | null;
  /** Index in storage; for a blob, behind all splats of the cloud: pages of blobs follow theirs. */
  readonly storedIndex: number;
  /** Where the splat is a blob: the page of the cloud's blobs, and the chunk and slot there. */
  readonly blob: { readonly page: number; readonly chunk: number; readonly slot: number } | null;
}

/** Finds the cloud of splat `number`, counted through the frame's chunks, and its storage index. */
export function locateSplat(pages: readonly FramePage[], number: number): FrameSplat {
  const chunk = Math.floor(number / CHUNK_SPLATS);
  const found = pages.findLast(({ chunkStart }) => chunkStart <= chunk)!;
  const { cloudIndex, instances, chunksEach, splatStart } = found;
  const chunkInBatch = chunk - found.chunkStart;
  const instanceIndex = instances && instances.first + Math.floor(chunkInBatch / chunksEach);
  const chunkInPage = chunkInBatch % chunksEach;
  const slot = number % CHUNK_SPLATS;
  const isOfBatch = (page: FramePage) =>
    page.cloudIndex === cloudIndex && page.batchIndex === found.batchIndex;
  const blobPages = pages.filter((page) => isOfBatch(page) && page.isBlobs);
  const blob = found.isBlobs ? { page: blobPages.indexOf(found), chunk: chunkInPage, slot } : null;
  const storedIndex = splatStart + CHUNK_SPLATS * chunkInPage + slot;
  return { cloudIndex, instanceIndex, storedIndex, blob };
}
