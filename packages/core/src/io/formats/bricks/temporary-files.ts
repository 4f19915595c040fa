import { InvalidArgumentError, SplatSourceError, WebSplatterError } from '../../../data/errors.ts';

/** A file for data that exceed memory. Any storage with random access can implement it. */
export interface TemporaryFile {
  /** Rejects if the storage is full. The caller may reuse `bytes` afterwards. */
  write(bytes: Uint8Array<ArrayBuffer>, at: number): Promise<void>;
  /** Reads bytes that were written before, into new memory. */
  read(at: number, byteCount: number): Promise<Uint8Array<ArrayBuffer>>;
  remove(): Promise<void>;
}

/**
 * Creates an empty file, or opens a named file with any contents. Rejects as `write`.
 *
 * @param byteCount expected size in bytes; undefined if unknown.
 * @param name name of a file that a resumed writer needs again. The same name opens the same file
 *   until it is removed.
 */
export type MakeTemporaryFile = (byteCount: number | undefined, name?: string) => Promise<TemporaryFile>;

/**
 * Sum of the mixed 32-bit words of `bytes`: a checksum that detects lost writes, of parts in any
 * order. Mixed, because two faults of opposite sign must not cancel.
 */
export function sumOf({ buffer, byteOffset, byteLength }: Uint8Array<ArrayBuffer>): number {
  let sum = 0;
  for (const word of new Uint32Array(buffer, byteOffset, byteLength >> 2)) sum = (sum + mixed(word)) | 0;
  for (const byte of new Uint8Array(buffer, byteOffset + (byteLength & ~3), byteLength & 3))
    sum = (sum + mixed(byte)) | 0;
  return sum;
}

function mixed(word: number): number {
  const product = Math.imul(word ^ (word >>> 16), 0x45d9f3b);
  return product ^ (product >>> 16);
}

/**
 * Reads bytes that were written before, into new memory. Rejects as the file, and with
 * SplatSourceError if the checksum differs.
 *
 * @param sum expected `sumOf` of the bytes; undefined if unknown.
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
  // Words are read in place, so they must be aligned.
  const own =
    bytes.byteOffset % 4 === 0 && bytes.byteLength === bytes.buffer.byteLength ? bytes : bytes.slice();
  if (sum !== undefined && sum !== sumOf(own))
    throw wrongStorage(`the ${byteCount} bytes from ${at} on are not those that were written`);
  return own;
}

/** Stands for a file name in errors. */
const TEMPORARY_FILE = 'temporary file';

export function wrongStorage(found: string): SplatSourceError {
  return new SplatSourceError(TEMPORARY_FILE, `${found}. Use other storage for makeFile, and write again.`);
}

/**
 * Whether a writer failed because of its stored files, and would fail again. False for errors of
 * the source and for missing workers.
 */
export function isOfStorage(error: unknown): boolean {
  if (error instanceof SplatSourceError) return error.file === TEMPORARY_FILE;
  return error instanceof InvalidArgumentError || !(error instanceof WebSplatterError);
}

/** Initial capacity of a file of unknown size. */
const FIRST_BYTES = 1 << 20;

/** Creates a temporary file in memory. Rejects with SplatSourceError if memory is exhausted. */
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
