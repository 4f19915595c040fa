import type { createNodeGpu } from '@websplatter/node';
import { sharedTestGpu } from '@websplatter/node/gpu-test';

/**
 * The package, given to `vi.mock`, with adapters that lend shared devices: the commands of a test file then
 * compile the same shaders once.
 */
export function withSharedDevices<Module extends { readonly createNodeGpu: typeof createNodeGpu }>(
  module: Module,
): Module {
  return {
    ...module,
    createNodeGpu: async (options) => {
      const made = await module.createNodeGpu(options);
      return { ...made, adapter: await sharedTestGpu.requestAdapter() };
    },
  };
}
