import { createNodeGpu } from '@websplatter/node';
import { shareTestDevice } from '@websplatter/node/gpu-test';
import { ballotDeviceOf } from '../gpu/device.ts';
import { DEFAULT_WORKGROUP_BYTES, type SortShape } from '../stages/sort/sort.ts';

/** A test device with subgroups and all the adapter's workgroup memory, not just 16 KiB. */
export async function createSortDevice(): Promise<GPUDevice> {
  const { adapter } = await createNodeGpu();
  const { maxComputeWorkgroupStorageSize } = adapter.limits;
  const requiredFeatures = (['subgroups', 'timestamp-query'] as const).filter((feature) =>
    adapter.features.has(feature),
  );
  return shareTestDevice({ requiredLimits: { maxComputeWorkgroupStorageSize }, requiredFeatures });
}

/** `shape` with keys ranked by ballots, in blocks for `device`; null if it has no subgroups. */
export function byBallots(shape: SortShape, device: GPUDevice): SortShape | null {
  const ballots = ballotDeviceOf(device);
  if (!ballots) return null;
  const { min, max } = ballots;
  // Small blocks: a subgroup takes a word of workgroup memory per digit; CPUs' have four threads.
  return { ...shape, workgroup: 8 * Math.max(min, 4), itemsPerThread: 8, subgroups: { min, max } };
}

/** Workgroup memory to test on `device`: WebGPU's default, and sizes with other blocks. */
export function sortLimitsOf({ limits }: Pick<GPUDevice, 'limits'>): number[] {
  const all = [DEFAULT_WORKGROUP_BYTES, 32_768, 49_152];
  return all.filter((bytes) => bytes <= limits.maxComputeWorkgroupStorageSize);
}
