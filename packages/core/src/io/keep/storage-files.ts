import type { MakeTemporaryFile, TemporaryFile } from '../formats/bricks/temporary-files.ts';
import { sceneFolder, whenFree } from './kept-scenes.ts';

/** Prefix of file names that a resumed conversion does not need. */
export const UNNAMED = 'temporary-';
/** An exclusive synchronous file handle, available in workers. */
interface SyncHandle {
  read(bytes: Uint8Array, options: { readonly at: number }): number;
  write(bytes: Uint8Array, options: { readonly at: number }): number;
  getSize(): number;
  truncate(byteCount: number): void;
  flush(): void;
  close(): void;
}

/** An open file of a folder. */
interface OpenFile extends TemporaryFile {
  readonly handle: SyncHandle;
}

/** Files in a folder of the private file system. A file stays open until it or the collection is closed. */
export class StorageFiles {
  readonly #folder: FileSystemDirectoryHandle;
  readonly #open = new Map<string, OpenFile>();
  /** Files with writes that are not flushed. */
  readonly #written = new Set<SyncHandle>();
  #made = 0;

  constructor(folder: FileSystemDirectoryHandle) {
    this.#folder = folder;
  }

  readonly makeFile: MakeTemporaryFile = (_, name) => this.open(name ?? `${UNNAMED}${this.#made++}`);

  /** Opens a file, or creates it if missing. */
  async open(name: string): Promise<OpenFile> {
    const known = this.#open.get(name);
    if (known) return known;
    const entry = await this.#folder.getFileHandle(name, { create: true });
    const handle = await openHandle(entry);
    const file: OpenFile = {
      handle,
      write: async (bytes, at) => {
        this.#written.add(handle);
        // Private windows of Chromium 156 return 4294967288 if storage is full.
        const written = handle.write(bytes, { at });
        if (written !== bytes.length)
          throw new DOMException('Nothing more can be written.', 'QuotaExceededError');
      },
      read: async (at, count) => {
        const bytes = new Uint8Array(count);
        for (let from = 0; from < count; ) {
          const read = handle.read(bytes.subarray(from), { at: at + from });
          if (read === 0) throw new Error(`${name} ends at byte ${at + from}.`);
          from += read;
        }
        return bytes;
      },
      remove: async () => {
        handle.close();
        this.#written.delete(handle);
        this.#open.delete(name);
        await this.#folder.removeEntry(name);
      },
    };
    this.#open.set(name, file);
    return file;
  }

  /** Flushes all written files to durable storage. */
  readonly flush = (): void => {
    for (const handle of this.#written) handle.flush();
    this.#written.clear();
  };

  close(): void {
    for (const { handle } of this.#open.values()) handle.close();
    this.#open.clear();
    this.#written.clear();
  }
}

/** Whether this many further bytes can be written in the folder of a scene, which is made if missing. */
export async function hasRoom(key: string, byteCount: number): Promise<boolean> {
  try {
    const file = await new StorageFiles(await sceneFolder(key)).open(`${UNNAMED}room`);
    try {
      file.handle.truncate(byteCount);
      return file.handle.getSize() === byteCount;
    } finally {
      await file.remove();
    }
  } catch (error) {
    if ((error as Error).name !== 'QuotaExceededError') throw error;
    return false;
  }
}

function openHandle(file: FileSystemFileHandle): Promise<SyncHandle> {
  // TypeScript declares it for workers only.
  const { createSyncAccessHandle } = file as unknown as {
    createSyncAccessHandle: () => Promise<SyncHandle>;
  };
  return whenFree(() => createSyncAccessHandle.call(file));
}
