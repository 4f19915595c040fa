export type SomeLimits = Partial<Record<keyof GPUSupportedLimits, number>>;

/** `whole` with these members in place of its own. */
export function deviceWith(whole: GPUDevice, members: Partial<Record<keyof GPUDevice, unknown>>): GPUDevice {
  return new Proxy(whole, {
    get: (target, name) => {
      if (Object.hasOwn(members, name)) return members[name as keyof GPUDevice];
      const value = Reflect.get(target, name);
      return typeof value === 'function' ? value.bind(target) : value;
    },
  });
}

/** The limits of `whole`, but for these: WebGPU gives none below its defaults. */
export function limitsWith(whole: GPUDevice, limits: SomeLimits): GPUSupportedLimits {
  return new Proxy(whole.limits, {
    get: (target, name) => limits[name as keyof GPUSupportedLimits] ?? Reflect.get(target, name),
  });
}

/** `whole`, which says that it belongs to another adapter. */
export function withAdapter(whole: GPUDevice, info: Partial<GPUAdapterInfo>): GPUDevice {
  const { subgroupMinSize, subgroupMaxSize } = whole.adapterInfo;
  const adapterInfo = {
    vendor: '',
    architecture: '',
    device: '',
    description: '',
    isFallbackAdapter: false,
    subgroupMinSize,
    subgroupMaxSize,
    ...info,
  };
  return deviceWith(whole, { adapterInfo });
}

/**
 * `whole`, as on an adapter of the same vendor with a label of its own. Engines remember by the
 * label which rasteriser was faster, also for the files of tests that come later in the process.
 */
export function onOwnAdapter(whole: GPUDevice, name: string): GPUDevice {
  const { vendor, architecture, device, description, isFallbackAdapter } = whole.adapterInfo;
  const own = `${architecture} ${name}`;
  return withAdapter(whole, { vendor, architecture: own, device, description, isFallbackAdapter });
}
