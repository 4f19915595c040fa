import { InvalidArgumentError, SplatSourceError, WebSplatterError } from '../../../data/errors.ts';

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

/** The sum of the words of bytes, by which storage that lost some is told. */
export function sumOf({ buffer, byteOffset, byteLength }: Uint8Array<ArrayBuffer>): number {
  let sum = 0;
  for (const word of new Uint32Array(buffer, byteOffset, byteLength >> 2)) sum = (sum + word) | 0;
  for (const byte of new Uint8Array(buffer, byteOffset + (byteLength & ~3), byteLength & 3))
    sum = (sum + byte) | 0;
  return sum;
}

/**
 * Reads what was written before, in memory of its own. Rejects as the file, and with
 * SplatSourceError where the storage gives other bytes.
 *
 * @param sum of the bytes; undefined where it is not known.
 */
export async function readBack(
  file: TemporaryFile,
  at: number,
  byteCount: number,
  sum: number | undefined,
): Promise<Uint8Array<ArrayBuffer>> {
  const bytes = await file.read(at, byteCount);
  if (!(bytes instanceof Uint8Array) || bytes.length !== byteCount)
    throw wrongStorage(`${byteCount} bytes from ${at} on were read, and ${bytes?.length} came`);
  // Words are read in place.
  const own =
    bytes.byteOffset % 4 === 0 && bytes.byteLength === bytes.buffer.byteLength ? bytes : bytes.slice();
  if (sum !== undefined && sum !== sumOf(own))
    throw wrongStorage(`the ${byteCount} bytes from ${at} on are not those that were written`);
  return own;
}

/** In place of a name, in errors. */
const TEMPORARY_FILE = 'temporary file';

export function wrongStorage(found: string): SplatSourceError {
  return new SplatSourceError(TEMPORARY_FILE, `${found}. Use other storage for makeFile, and write again.`);
}

/** Whether a writer failed over what is kept for it, and would again: not over its source, or for lack of a worker. */
export function isOfStorage(error: unknown): boolean {
  if (error instanceof SplatSourceError) return error.file === TEMPORARY_FILE;
  return error instanceof InvalidArgumentError || !(error instanceof WebSplatterError);
}

/** Bytes of the first memory of a file whose size is not known. */
const FIRST_BYTES = 1 << 20;

/** A temporary file in memory. Rejects with SplatSourceError where there is none. */
export async function memoryFile(byteCount = FIRST_BYTES): Promise<TemporaryFile> {
  let memory = memoryOf(byteCount);
  return {
    write: async (bytes, at) => {
      if (at + bytes.length > memory.length) {
        const larger = memoryOf(Math.max(at + bytes.length, 2 * memory.length));
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

function memoryOf(byteCount: number): Uint8Array<ArrayBuffer> {
  try {
    return new Uint8Array(byteCount);
  } catch (error) {
    if (error instanceof RangeError) throw wrongStorage(`there is no memory for ${byteCount} bytes`);
    throw error;
  }
}
