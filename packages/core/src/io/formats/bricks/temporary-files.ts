/** A file for data that does not fit the memory; any storage with random access can be one. */
export interface TemporaryFile {
  /** Rejects where there is no room. The bytes are not kept. */
  write(bytes: Uint8Array<ArrayBuffer>, at: number): Promise<void>;
  /** Bytes that were written before, in memory of their own. */
  read(at: number, byteCount: number): Promise<Uint8Array<ArrayBuffer>>;
  remove(): Promise<void>;
}

/**
 * Makes an empty file, or one of any contents if it has a name. Rejects as `write`.
 *
 * @param byteCount how large it will be, if known.
 * @param name of what a writer with a journal needs again; the file is the same as long as it is
 *   not removed.
 */
export type MakeTemporaryFile = (byteCount: number | undefined, name?: string) => Promise<TemporaryFile>;

/** Bytes of the first memory of a file whose size is not known. */
const FIRST_BYTES = 1 << 20;

/** A temporary file in memory. */
export async function memoryFile(byteCount = FIRST_BYTES): Promise<TemporaryFile> {
  let memory = new Uint8Array(byteCount);
  return {
    write: async (bytes, at) => {
      if (at + bytes.length > memory.length) {
        const larger = new Uint8Array(Math.max(at + bytes.length, 2 * memory.length));
        larger.set(memory);
        memory = larger;
      }
      memory.set(bytes, at);
    },
    read: async (at, count) => memory.slice(at, at + count),
    remove: async () => {
      memory = new Uint8Array(0);
    },
  };
}
