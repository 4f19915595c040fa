/** `GPUBufferUsage`, which is undefined in Node until a GPU is opened. */
export const BUFFER_USAGE = { STORAGE: 1, COPY_SRC: 2, COPY_DST: 4, MAP_WRITE: 8 };

/** An idle device with unlimited memory. `whenIdle` stands for `onSubmittedWorkDone`. */
export function deviceWithoutGpu(whenIdle: () => Promise<void>): GPUDevice {
  return {
    limits: { maxBufferSize: 1e9, maxStorageBufferBindingSize: 1e9 },
    queue: { submit: () => {}, onSubmittedWorkDone: whenIdle },
    createCommandEncoder: () => ({ finish: () => {} }),
    createBuffer: ({ size }: GPUBufferDescriptor) => ({
      size,
      getMappedRange: () => new ArrayBuffer(size),
      destroy: () => {},
    }),
    pushErrorScope: () => {},
    popErrorScope: async () => null,
  } as unknown as GPUDevice;
}
