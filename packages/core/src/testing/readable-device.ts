/**
 * `whole` with these limits, all of whose storage buffers can be read back.
 *
 * @param onBuffer is told the label of each buffer that is about to be created.
 */
export function readableDevice(
  whole: GPUDevice,
  limits: Partial<Record<keyof GPUSupportedLimits, number>> = {},
  onBuffer: (label: string) => void = () => {},
): GPUDevice {
  const limited = new Proxy(whole.limits, {
    get: (target, name) => limits[name as keyof GPUSupportedLimits] ?? Reflect.get(target, name),
  });
  const createBuffer = (descriptor: GPUBufferDescriptor) => {
    onBuffer(descriptor.label ?? '');
    const isStorage = (descriptor.usage & GPUBufferUsage.STORAGE) !== 0;
    return whole.createBuffer({
      ...descriptor,
      usage: descriptor.usage | (isStorage ? GPUBufferUsage.COPY_SRC : 0),
    });
  };
  return new Proxy(whole, {
    get: (target, name) => {
      if (name === 'limits') return limited;
      if (name === 'createBuffer') return createBuffer;
      const value = Reflect.get(target, name);
      return typeof value === 'function' ? value.bind(target) : value;
    },
  });
}
