/** Constructors of memory by a number of bytes or of items. */
const METERED = [
  ...['ArrayBuffer', 'SharedArrayBuffer', 'Int8Array', 'Uint8Array', 'Uint8ClampedArray', 'Int16Array'],
  ...['Uint16Array', 'Int32Array', 'Uint32Array', 'Float32Array', 'Float64Array', 'BigInt64Array'],
  ...['BigUint64Array', 'Array'],
];
const ITEM_BYTES = 8;

type Constructor = new (...values: unknown[]) => object;

/**
 * Runs `run`, and returns the bytes that are asked for meanwhile as buffers, typed arrays and
 * arrays of a given length. Unlike the memory of the process, they do not depend on when garbage is
 * collected, and are never fewer than were held at once. Memory of the platform itself, such as
 * pieces of a stream, is not counted.
 */
export async function allocatedBytes(run: () => Promise<unknown>): Promise<number> {
  let bytes = 0;
  const globals = globalThis as unknown as Record<string, Constructor>;
  const originals = METERED.map((name) => [name, globals[name]] as const);
  const { ArrayBuffer: Buffer, SharedArrayBuffer: SharedBuffer } = globalThis;
  const put = (name: string, kind: Constructor) => {
    globals[name] = kind;
    // `slice`, and code that copies columns, makes the copy by `constructor`.
    kind.prototype.constructor = kind;
  };
  for (const [name, Original] of originals) {
    const construct = (_: Constructor, values: unknown[]) => {
      const made = new Original(...values) as { byteLength?: number; length: number };
      // A view takes no memory of its own.
      if (!(values[0] instanceof Buffer || values[0] instanceof SharedBuffer))
        bytes += made.byteLength ?? ITEM_BYTES * made.length;
      return made;
    };
    put(name, new Proxy(Original, { construct }));
  }
  try {
    await run();
  } finally {
    for (const [name, Original] of originals) put(name, Original);
  }
  return bytes;
}
