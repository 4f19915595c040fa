import { WebSplatterError } from '../../data/errors.ts';
import { printable } from '../../data/printable.ts';
import { waitMs } from '../sources/wait-ms.ts';

/** A scene in bricks in the private file system of the page's origin, made of a file. */
export interface KeptScene {
  /** Tells it from others. */
  readonly key: string;
  /** Of the file that it was made of. */
  readonly fileName: string;
  /** Bytes that it takes; of one that is not whole, those of what is kept to go on with it. */
  readonly bytes: number;
  /** Whether it can be shown; if not, `keepBricks` goes on with it. */
  readonly isWhole: boolean;
  /** When it was asked for last, in milliseconds since 1970. */
  readonly usedMs: number;
}

/** What a folder says about itself; its name is the key. */
export interface AboutScene extends Pick<KeptScene, 'fileName' | 'isWhole'> {
  /** Others cannot be gone on with. */
  readonly version: number;
}

/** Looks at a file that is open still, and the wait between them: 5 s in all. */
const ATTEMPTS = 50;
const PAUSE_MS = 100;
const FOLDER = 'websplatter-bricks';
export const BRICKS_FILE = 'scene.bricks';
export const ABOUT_FILE = 'about.json';
/** An empty file, made anew whenever the scene is asked for: its date tells when that was. */
const USED_FILE = 'used';
/** All that is left of a scene that is whole. */
const WHOLE_FILES = [ABOUT_FILE, BRICKS_FILE, USED_FILE];

/** There is no room for a scene in the storage that the browser gives to the page's origin. */
export class StorageRoomError extends WebSplatterError {
  override readonly name = 'StorageRoomError';
  /** Bytes that are needed besides those that are there. */
  readonly neededBytes: number;
  /** Bytes that are left, or would be without other kept scenes, to a sixteenth of those needed. */
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

/** Name of the lock of a scene: shared while it is in use, exclusive while it is made or removed. */
export function lockName(key: string): string {
  return `${FOLDER}/${key}`;
}

/** The folder of all scenes. Rejects with WebSplatterError 'storage-unavailable' where there is none. */
async function scenesFolder(): Promise<FileSystemDirectoryHandle> {
  try {
    const root = await navigator.storage.getDirectory();
    return await root.getDirectoryHandle(FOLDER, { create: true });
  } catch (cause) {
    const message = `Scenes cannot be kept: ${(cause as Error).message}. The browser may have no private file system, or none in private windows and on pages that are not loaded securely. Convert the file by "npx @websplatter/cli convert".`;
    throw new WebSplatterError('storage-unavailable', message, { cause });
  }
}

/** The folder of a scene, made if it is not there. */
export async function sceneFolder(key: string): Promise<FileSystemDirectoryHandle> {
  return (await scenesFolder()).getDirectoryHandle(key, { create: true });
}

/** What a folder says about itself; null if it says nothing. */
export async function readAbout(folder: FileSystemDirectoryHandle): Promise<AboutScene | null> {
  try {
    const file = await (await folder.getFileHandle(ABOUT_FILE)).getFile();
    return JSON.parse(await file.text()) as AboutScene;
  } catch {
    // A page that ended while it wrote this has made nothing else.
    return null;
  }
}

/** The bricks of a scene that is whole, which is asked for; null if it is not. */
export async function findBricks(key: string): Promise<File | null> {
  const folder = await (await scenesFolder()).getDirectoryHandle(key).catch(() => null);
  if (!folder || !(await readAbout(folder))?.isWhole) return null;
  // What it was made of. Another page may remove the same.
  await removeFiles(folder, (name) => !WHOLE_FILES.includes(name)).catch(() => {});
  await noteUse(folder);
  return (await folder.getFileHandle(BRICKS_FILE)).getFile();
}

/** Removes files of a folder, none of which may be open. */
export async function removeFiles(
  folder: FileSystemDirectoryHandle,
  isRemoved: (name: string) => boolean,
): Promise<void> {
  const names: string[] = [];
  for await (const name of folder.keys()) if (isRemoved(name)) names.push(name);
  for (const name of names) await whenFree(() => folder.removeEntry(name));
}

/** Does something with a file as soon as a worker that was ended has let go of it. */
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

/** Notes that a scene is asked for. */
export async function noteUse(folder: FileSystemDirectoryHandle): Promise<void> {
  // Another page may do the same.
  await folder.removeEntry(USED_FILE).catch(() => {});
  await folder.getFileHandle(USED_FILE, { create: true });
}

/** When a file was changed last, in milliseconds since 1970; 0 if it is not there. */
async function dateOf(folder: FileSystemDirectoryHandle, name: string): Promise<number> {
  const file = await folder.getFileHandle(name).then(
    (handle) => handle.getFile(),
    () => null,
  );
  return file?.lastModified ?? 0;
}

/** Scenes that `keepBricks` has made or begun, those asked for last first. */
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

/** Bytes of the files in a folder. */
export async function bytesIn(folder: FileSystemDirectoryHandle): Promise<number> {
  let bytes = 0;
  // Files may go meanwhile.
  for await (const file of folder.values())
    if (file.kind === 'file')
      bytes += await file.getFile().then(
        ({ size }) => size,
        () => 0,
      );
  return bytes;
}

/**
 * Removes a kept scene, whole or not.
 *
 * @returns false if it is in use: shown, or being made, in this page or in another one.
 */
export async function removeKept({ key }: Pick<KeptScene, 'key'>): Promise<boolean> {
  return navigator.locks.request(lockName(key), { ifAvailable: true }, async (lock) => {
    if (!lock) return false;
    await (await scenesFolder()).removeEntry(key, { recursive: true });
    return true;
  });
}

/** Scenes that nothing uses, those asked for last first, without that of `key`. */
export async function unusedScenes(key: string): Promise<KeptScene[]> {
  const { held = [] } = await navigator.locks.query();
  const inUse = new Set(held.map(({ name }) => name));
  return (await keptScenes()).filter((scene) => scene.key !== key && !inUse.has(lockName(scene.key)));
}
