import { deviceWith } from './device-with.ts';

/** A device on which a test makes allocations fail. */
export interface FailingDevice {
  readonly device: GPUDevice;
  /** Lets one allocation fail: the one after the next `count`. */
  failAfter(count: number): void;
  /** Lets no allocation fail from now on. @returns whether one has failed. */
  stop(): boolean;
}

/**
 * `whole`, but allocations may fail as in a browser: the new object is invalid, and only an
 * out-of-memory scope reports it. A failure outside of any such scope is an uncaptured error, as is the
 * use of an invalid object outside of a validation scope; both fail a test whose device is watched.
 */
export function failingDevice(whole: GPUDevice): FailingDevice {
  /** Allocations before the one that fails; negative when it has. */
  let remaining = Number.POSITIVE_INFINITY;
  const scopes: { readonly filter: GPUErrorFilter; lacks: boolean }[] = [];
  const make = <Made>(create: () => Made, createInvalid: () => Made): Made => {
    if (remaining-- !== 0) return create();
    const scope = scopes.findLast(({ filter }) => filter === 'out-of-memory');
    if (!scope) throw new Error('An allocation failed outside of any scope.');
    scope.lacks = true;
    whole.pushErrorScope('validation');
    const made = createInvalid();
    void whole.popErrorScope();
    return made;
  };
  const device = deviceWith(whole, {
    createBuffer: (descriptor: GPUBufferDescriptor) =>
      make(
        () => whole.createBuffer(descriptor),
        () => whole.createBuffer({ ...descriptor, usage: 0 }),
      ),
    createTexture: (descriptor: GPUTextureDescriptor) =>
      make(
        () => whole.createTexture(descriptor),
        () => whole.createTexture({ ...descriptor, usage: 0 }),
      ),
    pushErrorScope: (filter: GPUErrorFilter) => {
      scopes.push({ filter, lacks: false });
      whole.pushErrorScope(filter);
    },
    popErrorScope: async () => {
      const scope = scopes.pop();
      const error = await whole.popErrorScope();
      return scope?.lacks ? ({ message: 'out of memory' } as GPUOutOfMemoryError) : error;
    },
  });
  return {
    device,
    failAfter: (count) => {
      remaining = count;
    },
    stop: () => {
      const hasFailed = remaining < 0;
      remaining = Number.POSITIVE_INFINITY;
      return hasFailed;
    },
  };
}
