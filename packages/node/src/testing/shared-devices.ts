/** Idle devices, by the options that they were requested with. */
const idle = new Map<string, GPUDevice[]>();

/**
 * Pipelines of all shared devices. As long as one lives, Dawn gives it to callers that ask its
 * device for an equal one, instead of compiling it again, which would take most of the time of many
 * test files on a software adapter.
 */
const compiled: GPUObjectBase[] = [];

/**
 * Lends a device of `adapter` that earlier tests have used, or makes one: no other test has it
 * until it is destroyed, which destroys the objects made with it and leaves the rest to the next.
 * Everything but Dawn's own memory of shaders is as of a new device.
 */
export async function lendDevice(
  adapter: GPUAdapter,
  { requiredFeatures = [], requiredLimits = {} }: GPUDeviceDescriptor = {},
): Promise<GPUDevice> {
  const key = JSON.stringify([[...requiredFeatures].sort(), Object.entries(requiredLimits).sort()]);
  const known = idle.get(key)?.pop();
  if (known) return borrowed(known, key);
  const label = 'shared device';
  return borrowed(await adapter.requestDevice({ label, requiredFeatures, requiredLimits }), key);
}

function giveBack(device: GPUDevice, key: string): void {
  idle.set(key, [...(idle.get(key) ?? []), device]);
}

/** An object of its own for `device`, so that methods that tests replace end with them. */
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
    // Scopes are a stack, on which others have theirs by then.
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

/** An object with `members`, and those of `whole` for the rest, each of which can be replaced. */
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
