/** Idle devices, by the options that they were requested with. */
const idle = new Map<string, GPUDevice[]>();

/** Numbers of all devices, in the order in which they were made. */
const numbers = new Map<GPUDevice, number>();

/**
 * Pipelines of all shared devices, kept alive: Dawn then returns them for equal descriptors instead of
 * compiling again, which would take most of the time of many test files on a software adapter.
 */
const compiled: GPUObjectBase[] = [];

/**
 * Lends the oldest idle device of `adapter`, or makes one. No other test has it until it is destroyed.
 * That destroys the objects made with it and returns the device to the pool. Except for Dawn's cache
 * of shaders, it behaves like a new device.
 */
export async function lendDevice(
  adapter: GPUAdapter,
  { requiredFeatures = [], requiredLimits = {} }: GPUDeviceDescriptor = {},
): Promise<GPUDevice> {
  const key = JSON.stringify([[...requiredFeatures].sort(), Object.entries(requiredLimits).sort()]);
  const known = idle.get(key)?.pop();
  if (known) return borrowed(known, key);
  const label = 'shared device';
  const made = await adapter.requestDevice({ label, requiredFeatures, requiredLimits });
  numbers.set(made, numbers.size);
  return borrowed(made, key);
}

/** Keeps idle devices in order of age, the oldest last: it is lent first, since it has compiled most shaders. */
function giveBack(device: GPUDevice, key: string): void {
  const others = idle.get(key) ?? [];
  idle.set(
    key,
    [...others, device].toSorted((a, b) => numbers.get(b)! - numbers.get(a)!),
  );
}

/** Wraps `device`: methods that a test replaces are replaced in the wrapper only. */
function borrowed(device: GPUDevice, key: string): GPUDevice {
  const made = new Set<{ destroy(): unknown }>();
  const listeners: Parameters<GPUDevice['removeEventListener']>[] = [];
  let openScopes = 0;
  let end: ((info: GPUDeviceLostInfo) => void) | null = null;
  const lost = new Promise<GPUDeviceLostInfo>((resolve) => {
    end = resolve;
  });
  void device.lost.then((info) => {
    end?.(info);
    end = null;
  });

  const remembered = <Made extends { destroy(): unknown }>(object: Made): Made => {
    made.add(object);
    if (!end) object.destroy();
    return object;
  };
  const kept = async <Pipeline extends GPUObjectBase>(pipeline: Promise<Pipeline>): Promise<Pipeline> => {
    compiled.push(await pipeline);
    return pipeline;
  };
  const members: Partial<GPUDevice> = {
    lost,
    createBuffer: (descriptor) => remembered(device.createBuffer(descriptor)),
    createTexture: (descriptor) => remembered(device.createTexture(descriptor)),
    createQuerySet: (descriptor) => remembered(device.createQuerySet(descriptor)),
    createComputePipelineAsync: (descriptor) => kept(device.createComputePipelineAsync(descriptor)),
    createRenderPipelineAsync: (descriptor) => kept(device.createRenderPipelineAsync(descriptor)),
    // Scopes are a stack of the whole device, which later borrowers use too: count open ones.
    pushErrorScope: (filter) => {
      if (!end) return undefined;
      openScopes++;
      return device.pushErrorScope(filter);
    },
    popErrorScope: async () => {
      if (!end) return null;
      openScopes--;
      return device.popErrorScope();
    },
    addEventListener: (...listener: Parameters<GPUDevice['addEventListener']>) => {
      listeners.push(listener);
      device.addEventListener(...listener);
    },
    destroy: () => {
      if (!end) return undefined;
      end({ reason: 'destroyed', message: 'The borrowed device was given back.' } as GPUDeviceLostInfo);
      end = null;
      for (const object of made) object.destroy();
      for (const listener of listeners) device.removeEventListener(...listener);
      for (; openScopes > 0; openScopes--) void device.popErrorScope();
      giveBack(device, key);
      return undefined;
    },
  };
  return withMembers(device, members);
}

/** Returns an object with all members of `whole`, overridden by `members`; all of them are writable. */
function withMembers(whole: GPUDevice, members: Partial<GPUDevice>): GPUDevice {
  const object = Object.create(Object.getPrototypeOf(whole));
  for (const name of [...namesOf(Object.getPrototypeOf(whole)), ...namesOf(whole)]) {
    const value = Object.hasOwn(members, name) ? members[name] : whole[name];
    const own = typeof value === 'function' && !Object.hasOwn(members, name) ? value.bind(whole) : value;
    Object.defineProperty(object, name, { value: own, writable: true, configurable: true, enumerable: true });
  }
  return object;
}

const namesOf = (object: object) =>
  Object.getOwnPropertyNames(object).filter((name) => name !== 'constructor') as (keyof GPUDevice)[];
