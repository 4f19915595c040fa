/** Calls that make something on a device, all but commands and views of textures. */
const MAKING = [
  'createBindGroup',
  'createBindGroupLayout',
  'createBuffer',
  'createComputePipeline',
  'createComputePipelineAsync',
  'createPipelineLayout',
  'createQuerySet',
  'createRenderBundleEncoder',
  'createRenderPipeline',
  'createRenderPipelineAsync',
  'createSampler',
  'createShaderModule',
  'createTexture',
] as const satisfies readonly (keyof GPUDevice)[];

export type MakingCalls = Record<(typeof MAKING)[number], number>;

/** `device`, and the number of calls that make something on it, from now on. */
export function countedDevice(device: GPUDevice): {
  readonly device: GPUDevice;
  readonly calls: MakingCalls;
} {
  const calls = Object.fromEntries(MAKING.map((name) => [name, 0])) as MakingCalls;
  const counted = new Proxy(device, {
    get(target, name) {
      const value = Reflect.get(target, name);
      if (typeof value !== 'function') return value;
      if (!(name in calls)) return value.bind(target);
      return (...args: unknown[]) => {
        calls[name as keyof MakingCalls]++;
        return value.apply(target, args);
      };
    },
  });
  return { device: counted, calls };
}
