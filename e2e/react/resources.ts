// Counts live resources of a page. Imported before all other modules, whose calls it intercepts.

/** Numbers of live resources. */
export interface Resources {
  /** Reading a file takes one, and its fetch with it. */
  readonly workers: number;
  /** Buffers and textures of all devices, three's included. */
  readonly gpuObjects: number;
  /** Listeners of the window, the document and elements in the page. */
  readonly listeners: number;
}

const workers = new Set<Worker>();
const gpuObjects = new Set<object>();
const listeners = new Map<EventTarget, Set<string>>();

export function countResources(): Resources {
  let listenerCount = 0;
  for (const [target, names] of listeners) {
    // Listeners of a removed element are garbage together with it.
    if (!(target instanceof Node) || target.isConnected) listenerCount += names.size;
  }
  return { workers: workers.size, gpuObjects: gpuObjects.size, listeners: listenerCount };
}

window.Worker = class extends Worker {
  constructor(url: string | URL, options?: WorkerOptions) {
    super(url, options);
    workers.add(this);
  }
  override terminate(): void {
    super.terminate();
    workers.delete(this);
  }
};

/** Calls `after` after every call of a method of `prototype`. */
function watch<T extends object>(
  prototype: T,
  method: keyof T & string,
  after: (self: object, result: object, args: unknown[]) => void,
): void {
  const original = prototype[method] as (...args: unknown[]) => object;
  Object.defineProperty(prototype, method, {
    value(this: object, ...args: unknown[]) {
      const result = original.apply(this, args);
      after(this, result, args);
      return result;
    },
  });
}

for (const method of ['createBuffer', 'createTexture'] as const) {
  watch(GPUDevice.prototype, method, (_device, made) => gpuObjects.add(made));
}
for (const { prototype } of [GPUBuffer, GPUTexture]) {
  watch(prototype, 'destroy', (destroyed) => gpuObjects.delete(destroyed));
}

let listenerNumber = 0;
const listenerNames = new WeakMap<object, number>();

/** Key of a listener: the arguments that removeEventListener compares. */
function nameOf([type, listener, options]: unknown[]): string {
  const known = listenerNames.get(listener as object) ?? ++listenerNumber;
  listenerNames.set(listener as object, known);
  const isCapture = typeof options === 'object' ? (options as AddEventListenerOptions)?.capture : options;
  return `${type} ${known} ${isCapture === true}`;
}

const isCounted = (target: object) => target instanceof Node || target instanceof Window;

watch(EventTarget.prototype, 'addEventListener', (target, _nothing, args) => {
  if (!isCounted(target) || !args[1]) return;
  const names = listeners.get(target as EventTarget) ?? new Set();
  listeners.set(target as EventTarget, names.add(nameOf(args)));
});
watch(EventTarget.prototype, 'removeEventListener', (target, _nothing, args) => {
  if (isCounted(target) && args[1]) listeners.get(target as EventTarget)?.delete(nameOf(args));
});
