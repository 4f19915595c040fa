import { register } from 'node:module';

/** Used where the adapter has them, as the engine does for a device of its own. */
const OPTIONAL_FEATURES = ['timestamp-query', 'float32-blendable', 'core-features-and-limits'];
const WIDENED_LIMITS = ['maxBufferSize', 'maxStorageBufferBindingSize', 'maxComputeWorkgroupStorageSize'];

/**
 * Imports the packages of one checkout into this process, which can open no other afterwards, and makes a device.
 *
 * What is used of the packages is their public API alone. Where a name differs between the checkouts, give the newer name to
 * the older package here, so that cases are written in one vocabulary.
 */
export async function openCheckout({ folder, dawn }) {
  register('./resolve-hooks.mjs', import.meta.url, { data: { checkout: folder, dawn } });
  const [core, effects, inspect, node, scenes] = await Promise.all(
    ['core', 'core/effects', 'core/inspect', 'node', 'scenes'].map((name) => import(`@websplatter/${name}`)),
  );
  const { gpu, adapter, label } = await node.createNodeGpu();
  const device = await adapter.requestDevice({
    requiredFeatures: OPTIONAL_FEATURES.filter((feature) => adapter.features.has(feature)),
    requiredLimits: Object.fromEntries(WIDENED_LIMITS.map((limit) => [limit, adapter.limits[limit]])),
  });
  return { core, effects, inspect, scenes, gpu, device, adapterLabel: label, ...watch(device) };
}

/** What `device` is asked to compile, and its errors. */
function watch(device) {
  const compiling = new Set();
  for (const method of ['createComputePipelineAsync', 'createRenderPipelineAsync']) {
    const compile = device[method].bind(device);
    device[method] = (descriptor) => {
      const pipeline = compile(descriptor);
      compiling.add(pipeline);
      const forget = () => compiling.delete(pipeline);
      pipeline.then(forget, forget);
      return pipeline;
    };
  }
  const errors = [];
  device.addEventListener('uncapturederror', (event) => {
    event.preventDefault();
    errors.push(`${event.error.constructor.name}: ${event.error.message}`);
  });
  device.lost.then(({ reason, message }) => {
    if (reason !== 'destroyed') errors.push(`the device was lost: ${message}`);
  });

  /**
   * Resolves when no pipeline is being compiled. Some are compiled in the background, for frames that may come; whether one of
   * them is ready decides how the next frame is drawn, which must not depend on time.
   */
  async function compiled() {
    do {
      await Promise.allSettled(compiling);
      // The engine's own reactions to the pipelines come first.
      await new Promise((resolve) => setImmediate(resolve));
    } while (compiling.size > 0);
  }

  /** Errors since the last call. */
  async function takeErrors() {
    // Errors arrive no later than the end of the work that caused them.
    await device.queue.onSubmittedWorkDone();
    return errors.splice(0);
  }

  return { compiled, isCompiling: () => compiling.size > 0, takeErrors };
}
