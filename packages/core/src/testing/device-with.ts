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
