import { deviceWith, limitsWith, type SomeLimits } from './device-with.ts';

/**
 * `whole` with these limits, all of whose storage buffers can be read back.
 *
 * @param onBuffer called with the label of each buffer before it is created.
 */
export function readableDevice(
  whole: GPUDevice,
  limits: SomeLimits = {},
  onBuffer: (label: string) => void = () => {},
): GPUDevice {
  const createBuffer = (descriptor: GPUBufferDescriptor) => {
    onBuffer(descriptor.label ?? '');
    const isStorage = (descriptor.usage & GPUBufferUsage.STORAGE) !== 0;
    return whole.createBuffer({
      ...descriptor,
      usage: descriptor.usage | (isStorage ? GPUBufferUsage.COPY_SRC : 0),
    });
  };
  return deviceWith(whole, { limits: limitsWith(whole, limits), createBuffer });
}
