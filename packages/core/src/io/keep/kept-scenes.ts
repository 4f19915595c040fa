import { WebSplatterError } from '../../data/errors.ts';
import { printable } from '../../data/printable.ts';
import { waitMs } from '../sources/wait-ms.ts';

/** A scene in bricks in the private file system of the page's origin. */
export interface KeptScene {
  /** Unique key of the scene. */
  readonly key: string;
  /** Name of the source file. */
  readonly fileName: string;
  /** Bytes in storage, including temporary files if the conversion is unfinished. */
  readonly bytes: number;
  /** Whether the conversion is finished; if not, `keepBricks` resumes it. */
  readonly isWhole: boolean;
  /** Time of the last request, in milliseconds since 1970. */
  readonly usedMs: number;
}

/** Metadata in a scene's folder, whose name is the key. */
export interface AboutScene extends Pick<KeptScene, 'fileName' | 'isWhole'> {
  /** Version of the journal; work of other versions cannot be resumed. */
  readonly version: number;
}

/** Attempts to get a file that is still open, and the wait between them: 5 s in all. */
const ATTEMPTS = 50;
const PAUSE_MS = 100;
const FOLDER = 'websplatter-bricks';
export const BRICKS_FILE = 'scene.bricks';
export const ABOUT_FILE = 'about.json';
/** An empty file, recreated at each request: its date is the time of the last request. */
const USED_FILE = 'used';
/** The files of a finished scene; all others are removed. */
const WHOLE_FILES = [ABOUT_FILE, BRICKS_FILE, USED_FILE];

/** The page's storage quota is too small for a scene. */
export class StorageRoomError extends WebSplatterError {
  override readonly name = 'StorageRoomError';
  /** Further bytes needed. */
  readonly neededBytes: number;
  /** Bytes available, counting evictable scenes, with a precision of one sixteenth of `neededBytes`. */
  readonly availableBytes: number;

  constructor(fileName: string, neededBytes: number, availableBytes: number) {
    super(
      'no-room',
      `${printable(fileName)}: arranging it for streaming needs ${inMegabytes(neededBytes)} of this browser's ` +
        `storage, which has ${inMegabytes(availableBytes)} left for this page. Free space on the disk, or convert it by "npx @websplatter/cli convert" and open that.`,
    );
    this.neededBytes = neededBytes;
    this.availableBytes = availableBytes;
  }
}

function inMegabytes(byteCount: number): string {
  return `${Math.ceil(byteCount / 1e6).toLocaleString('en')} MB`;
}

/** Name of a scene's lock: shared for use, exclusive for conversion and removal. */
export function lockName(key: string): string {
  return `${FOLDER}/${key}`;
}

/** The folder of all scenes. Rejects with WebSplatterError 'storage-unavailable' if there is no storage. */
async function scenesFolder(): Promise<FileSystemDirectoryHandle> {
  try {
    const root = await navigator.storage.getDirectory();
    return await root.getDirectoryHandle(FOLDER, { create: true });
  } catch (cause) {
    const message = `Scenes cannot be kept: ${(cause as Error).message}. The browser may have no private file system, or none in private windows and on pages that are not loaded securely. Convert the file by "npx @websplatter/cli convert".`;
    throw new WebSplatterError('storage-unavailable', message, { cause });
  }
}

/** The folder of a scene, created if missing. */
export async function sceneFolder(key: string): Promise<FileSystemDirectoryHandle> {
  return (await scenesFolder()).getDirectoryHandle(key, { create: true });
}

/** The folder of a scene; null if there is none. */
export async function findFolder(key: string): Promise<FileSystemDirectoryHandle | null> {
  // Rejects with NotFoundError.
  return (await scenesFolder()).getDirectoryHandle(key).catch(() => null);
}

/** Metadata of a scene's folder; null if missing or damaged. */
export async function readAbout(folder: FileSystemDirectoryHandle): Promise<AboutScene | null> {
  try {
    const file = await (await folder.getFileHandle(ABOUT_FILE)).getFile();
    return JSON.parse(await file.text()) as AboutScene;
  } catch {
    // A page that ended before or during this write has made nothing to go on from.
    return null;
  }
}

/** The bricks of a finished scene, marked as used now; null if there are none. */
export async function findBricks(key: string): Promise<File | null> {
  const folder = await findFolder(key);
  if (!folder || !(await readAbout(folder))?.isWhole) return null;
  // Temporary files are obsolete. Another page may remove the same ones.
  await removeFiles(folder, (name) => !WHOLE_FILES.includes(name)).catch(() => {});
  await noteUse(folder);
  return (await folder.getFileHandle(BRICKS_FILE)).getFile();
}

/** Removes files of a folder. No file may be open. */
export async function removeFiles(
  folder: FileSystemDirectoryHandle,
  isRemoved: (name: string) => boolean,
): Promise<void> {
  const names: string[] = [];
  for await (const name of folder.keys()) if (isRemoved(name)) names.push(name);
  for (const name of names) await whenFree(() => folder.removeEntry(name));
}

/** Retries an action while a terminated worker still holds the file. */
export async function whenFree<Result>(act: () => Promise<Result>): Promise<Result> {
  for (let attempt = 1; ; attempt++) {
    try {
      return await act();
    } catch (error) {
      const isOpen = (error as Error).name === 'NoModificationAllowedError';
      if (!isOpen || attempt === ATTEMPTS) throw error;
      await waitMs(PAUSE_MS, undefined);
    }
  }
}

/** Marks a scene as used now. */
export async function noteUse(folder: FileSystemDirectoryHandle): Promise<void> {
  // Another page may remove it at the same time.
  await folder.removeEntry(USED_FILE).catch(() => {});
  await folder.getFileHandle(USED_FILE, { create: true });
}

/** Time of a file's last change, in milliseconds since 1970; 0 if it is missing. */
async function dateOf(folder: FileSystemDirectoryHandle, name: string): Promise<number> {
  // A missing file is the oldest.
  const file = await folder.getFileHandle(name).then(
    (handle) => handle.getFile(),
    () => null,
  );
  return file?.lastModified ?? 0;
}

/**
 * Finished and unfinished scenes of `keepBricks`, most recently used first.
 *
 * @example
 * for (const { fileName, bytes, usedMs } of await keptScenes())
 *   console.log(`${fileName}: ${bytes} bytes, used on ${new Date(usedMs).toLocaleDateString()}`);
 */
export async function keptScenes(): Promise<KeptScene[]> {
  const scenes: KeptScene[] = [];
  for await (const folder of (await scenesFolder()).values()) {
    if (folder.kind !== 'directory') continue;
    const { fileName = '', isWhole = false } = (await readAbout(folder)) ?? {};
    const usedMs = await dateOf(folder, USED_FILE);
    scenes.push({ key: folder.name, fileName, isWhole, usedMs, bytes: await bytesIn(folder) });
  }
  return scenes.sort((a, b) => b.usedMs - a.usedMs);
}

export async function bytesIn(folder: FileSystemDirectoryHandle): Promise<number> {
  let bytes = 0;
  for await (const file of folder.values())
    if (file.kind === 'file')
      // It may disappear during the loop.
      bytes += await file.getFile().then(
        ({ size }) => size,
        () => 0,
      );
  return bytes;
}

/**
 * Removes a kept scene, finished or not.
 *
 * @returns false if it is displayed or being converted, in any page.
 * @example
 * for (const scene of await keptScenes())
 *   if (!(await removeKept(scene))) console.log(`${scene.fileName} is in use.`);
 */
export async function removeKept({ key }: Pick<KeptScene, 'key'>): Promise<boolean> {
  return navigator.locks.request(lockName(key), { ifAvailable: true }, async (lock) => {
    if (!lock) return false;
    await removeScene(key);
    return true;
  });
}

/** Removes the folder of a scene, if there is one. The caller holds its lock; no file may be open. */
export async function removeScene(key: string): Promise<void> {
  if (await findFolder(key)) await (await scenesFolder()).removeEntry(key, { recursive: true });
}

/** Evictable scenes, most recently used first; the scene with this key is excluded. */
export async function unusedScenes(key: string): Promise<KeptScene[]> {
  const { held = [] } = await navigator.locks.query();
  const inUse = new Set(held.map(({ name }) => name));
  return (await keptScenes()).filter((scene) => scene.key !== key && !inUse.has(lockName(scene.key)));
}
