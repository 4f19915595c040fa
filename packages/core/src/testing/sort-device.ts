import { createNodeGpu } from '@websplatter/node';
import { shareTestDevice } from '@websplatter/node/gpu-test';
import { DEFAULT_WORKGROUP_BYTES } from '../stages/sort-shape.ts';

/** A test device with as much workgroup memory as the adapter has: by default devices have 16 KiB. */
export async function createSortDevice(): Promise<GPUDevice> {
  const { adapter } = await createNodeGpu();
  const { maxComputeWorkgroupStorageSize } = adapter.limits;
  return shareTestDevice({ requiredLimits: { maxComputeWorkgroupStorageSize } });
}

/** Amounts of workgroup memory to test on `device`: WebGPU's default, and those above it that the sort has other blocks for. */
export function sortLimitsOf({ limits }: Pick<GPUDevice, 'limits'>): number[] {
  const all = [DEFAULT_WORKGROUP_BYTES, 32_768, 49_152];
  return all.filter((bytes) => bytes <= limits.maxComputeWorkgroupStorageSize);
}
