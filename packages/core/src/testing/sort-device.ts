import { createNodeGpu } from '@websplatter/node';
import { shareTestDevice } from '@websplatter/node/gpu-test';
import { ballotDeviceOf } from '../gpu/device.ts';
import {
  BALLOT_BLOCKS,
  DEFAULT_WORKGROUP_BYTES,
  type SortShape,
  workgroupBytesOf,
} from '../stages/sort/sort.ts';

/** A test device with subgroups, and with the adapter's workgroup memory and threads, not WebGPU's default. */
export async function createSortDevice(): Promise<GPUDevice> {
  const { adapter } = await createNodeGpu();
  const { maxComputeWorkgroupStorageSize, maxComputeInvocationsPerWorkgroup, maxComputeWorkgroupSizeX } =
    adapter.limits;
  const requiredFeatures = (['subgroups', 'timestamp-query'] as const).filter((feature) =>
    adapter.features.has(feature),
  );
  return shareTestDevice({
    requiredLimits: {
      maxComputeWorkgroupStorageSize,
      maxComputeInvocationsPerWorkgroup,
      maxComputeWorkgroupSizeX,
    },
    requiredFeatures,
  });
}

/**
 * `shape` with keys ranked by ballots, in every block that GPUs with subgroups of 32 threads take: with
 * as many subgroups and keys per thread, but subgroups of the device's size. None if it has no
 * subgroups.
 */
export function byBallots(shape: SortShape, device: GPUDevice): SortShape[] {
  const ballots = ballotDeviceOf(device);
  if (!ballots) return [];
  const { min, max, workgroupThreads } = ballots;
  const { maxComputeWorkgroupStorageSize } = device.limits;
  return BALLOT_BLOCKS.map(([threads, itemsPerThread]) => {
    const workgroup = (threads / 32) * Math.max(min, 4);
    return { ...shape, workgroup, itemsPerThread, subgroups: { min, max } };
  }).filter(
    (each) => each.workgroup <= workgroupThreads && workgroupBytesOf(each) <= maxComputeWorkgroupStorageSize,
  );
}

/** Workgroup memory to test on `device`: WebGPU's default, and sizes with other blocks. */
export function sortLimitsOf({ limits }: Pick<GPUDevice, 'limits'>): number[] {
  const all = [DEFAULT_WORKGROUP_BYTES, 32_768, 49_152];
  return all.filter((bytes) => bytes <= limits.maxComputeWorkgroupStorageSize);
}
