import { SplatFileError } from '../../data/errors.ts';
import type { Turns } from '../../data/turns.ts';
import { type BrickResult, type BrickTask, runTask } from '../formats/bricks/brick-tasks.ts';
import { BrickWriter, temporaryBytes } from '../formats/bricks/brick-writer.ts';
import { brickTaskBuffers } from '../formats/bricks/task-buffers.ts';
import { isOfStorage } from '../formats/bricks/temporary-files.ts';
import { openPlyRows } from '../formats/ply/ply-rows.ts';
import { PLY_READERS } from '../formats/ply/read-ply.ts';
import { readSource } from '../loading/read-source.ts';
import { workerStopped } from '../loading/start-worker.ts';
import { Remote, RemotePool, serve } from '../remote.ts';
import { knownSource } from '../sources/known-source.ts';
import { JournalFile } from './journal-file.ts';
import {
  ABOUT_FILE,
  type AboutScene,
  BRICKS_FILE,
  bytesIn,
  findFolder,
  type KeptScene,
  noteUse,
  readAbout,
  removeFiles,
  removeKept,
  removeScene,
  StorageRoomError,
  sceneFolder,
  unusedScenes,
} from './kept-scenes.ts';
import { hasRoom, StorageFiles, UNNAMED } from './storage-files.ts';

/** Increment it when the format of journals or temporary files changes. */
const VERSION = 2;
/** Version of work that must not be resumed. */
const NO_VERSION = 0;
const JOURNAL_FILE = 'journal';
/** Rows of the source between two journal entries: about one second of work. */
const KEEP_ROWS = 1 << 19;
/** Fraction of the progress at which all splats have been read. */
const READING_PART = 0.15;

/** Request to keep a scene. */
interface KeepRequest {
  readonly key: string;
  readonly file: Blob;
  readonly fileName: string;
  /** Ports of workers that run `HELPER_TASKS`. */
  readonly helpers: MessagePort[];
}

const HELPER_TASKS = { run: (task: BrickTask) => runTask(task) };

/** Tasks of the workers that keep a scene; each worker has one of them. */
export const KEEP_TASKS = {
  /** Converts a file to bricks. Resolves with the facts of StorageRoomError, null if there is room. */
  keep: async (request: KeepRequest, _: Turns, onProgress: (fraction: number) => void) => {
    try {
      await keepScene(request, onProgress);
      return null;
    } catch (error) {
      if (!(error instanceof StorageRoomError)) throw error;
      const { neededBytes, availableBytes } = error;
      return { neededBytes, availableBytes };
    }
  },
  /** Serves `HELPER_TASKS` on a port, until the worker ends. */
  help: (port: MessagePort): Promise<never> => {
    serve(HELPER_TASKS, port);
    return new Promise(() => {});
  },
};

/**
 * Converts a PLY to bricks in the folder of its key, or resumes the conversion. The caller holds
 * the scene's lock.
 */
async function keepScene(
  { key, file, fileName, helpers }: KeepRequest,
  onProgress: (fraction: number) => void,
): Promise<void> {
  const rows = await openPlyRows(file, fileName);
  const begun = await findFolder(key);
  const before = begun && (await readAbout(begun));
  // Another page may have finished it in the meantime.
  if (before?.isWhole) return;
  const canGoOn = before?.version === VERSION;
  if (begun) await removeFiles(begun, (name) => !canGoOn || name.startsWith(UNNAMED));
  const begunBytes = begun ? await bytesIn(begun) : 0;
  const neededBytes = temporaryBytes(rows.count, rows.shDegree);
  const storage = { hasRoom: (byteCount: number) => hasRoom(key, byteCount), remove: removeKept };
  try {
    const missingBytes = Math.max(0, neededBytes - begunBytes);
    // Before anything is written: full storage refuses even a folder.
    await makeRoom(missingBytes, await unusedScenes(key), storage, fileName);
  } catch (error) {
    if (!canGoOn) await removeScene(key);
    throw error;
  }
  const folder = await sceneFolder(key);
  const files = new StorageFiles(folder);
  const about: AboutScene = { fileName, isWhole: false, version: VERSION };
  try {
    await writeAbout(files, about);
    await noteUse(folder);
    const journalFile = await files.open(JOURNAL_FILE);
    const writer = new BrickWriter({
      makeFile: files.makeFile,
      run: runIn(helpers, fileName),
      threads: Math.max(1, helpers.length),
      journal: new JournalFile(journalFile, journalFile.handle.getSize(), files.flush),
    });
    await addRows(writer, rows, (fraction) => onProgress(READING_PART * fraction));
    const bricks = await files.open(BRICKS_FILE);
    let byteCount = 0;
    await writer.finish(
      async (part) => {
        await bricks.write(part, byteCount);
        byteCount += part.length;
      },
      (fraction) => onProgress(READING_PART + (1 - READING_PART) * fraction),
    );
    bricks.handle.truncate(byteCount);
    files.flush();
    await writeAbout(files, { ...about, isWhole: true });
  } catch (error) {
    if ((error as Error).name !== 'QuotaExceededError') {
      // If the files contradict the journal, a resumed writer would fail again.
      if (isOfStorage(error)) await writeAbout(files, { ...about, version: NO_VERSION });
      throw error;
    }
    const ownBytes = await bytesIn(folder);
    const leftBytes = await roomUpTo(neededBytes, storage.hasRoom);
    throw new StorageRoomError(fileName, neededBytes, ownBytes + leftBytes);
  }
  // The first use removes the temporary files, so they must be closed.
  files.close();
}

/** Runs tasks in the workers of `helpers`, or in this thread if there are none. */
function runIn(helpers: MessagePort[], fileName: string): (task: BrickTask) => Promise<BrickResult> {
  if (helpers.length === 0) return runTask;
  const failure = (event: Partial<ErrorEvent>) => workerStopped(fileName, 'worker that arranges it', event);
  const pool = new RemotePool<typeof HELPER_TASKS>(
    helpers.length,
    () => new Remote(() => helpers.pop()!, { failure }),
  );
  return (task) => pool.call('run', task, { transfer: brickTaskBuffers(task) });
}

/** Adds the rows that the journal does not cover. */
async function addRows(
  writer: BrickWriter,
  { count, fileOf }: Awaited<ReturnType<typeof openPlyRows>>,
  onProgress: (fraction: number) => void,
): Promise<void> {
  let row = await writer.resume();
  if (row === count) return;
  let kept = row;
  const onPiece: NonNullable<Parameters<typeof readSource>[1]['onPiece']> = async (piece) => {
    await writer.add(piece);
    row += Object.values(piece.dropped).reduce((sum, dropped) => sum + dropped, piece.count);
    onProgress(row / count);
    if (row - kept < KEEP_ROWS) return;
    await writer.keep(row);
    kept = row;
  };
  const options = { shPrecision: 'f32', maxSplats: Number.POSITIVE_INFINITY, onPiece } as const;
  try {
    await onPiece(await readSource(knownSource(fileOf([[row, count - row]])), options, PLY_READERS));
  } catch (error) {
    // The remaining rows may all be invalid splats.
    const isEmpty = error instanceof SplatFileError && error.code === 'empty';
    if (!isEmpty || writer.count === 0) throw error;
  }
  await writer.keep(count);
}

async function writeAbout(files: StorageFiles, about: AboutScene): Promise<void> {
  const file = await files.open(ABOUT_FILE);
  const bytes = new TextEncoder().encode(JSON.stringify(about));
  file.handle.truncate(0);
  await file.write(bytes, 0);
  files.flush();
}

/** Precision of the search for available room. */
const STEPS = 16;

/** Storage with evictable scenes. */
interface SceneStorage {
  /** Whether this many bytes can be written. */
  readonly hasRoom: (byteCount: number) => Promise<boolean>;
  readonly remove: (scene: KeptScene) => Promise<unknown>;
}

/**
 * Evicts scenes, the last of the list first, until there is enough room. Browsers do not report
 * their real quota (Chromium 156 reports 10 GiB), so room is found by trial.
 *
 * @param others evictable scenes.
 * @param fileName file name in messages.
 *
 * Rejects with StorageRoomError, before any eviction, if even an eviction of all would not suffice.
 */
export async function makeRoom(
  neededBytes: number,
  others: readonly KeptScene[],
  { hasRoom, remove }: SceneStorage,
  fileName: string,
): Promise<void> {
  if (await hasRoom(neededBytes)) return;
  const leftBytes = await roomUpTo(neededBytes, hasRoom);
  const mostBytes = others.reduce((sum, { bytes }) => sum + bytes, leftBytes);
  if (mostBytes >= neededBytes) {
    for (const scene of others.toReversed()) {
      await remove(scene);
      if (await hasRoom(neededBytes)) return;
    }
  }
  throw new StorageRoomError(fileName, neededBytes, mostBytes);
}

/** Bytes that can be written, up to `byteCount`, in steps of one sixteenth. */
async function roomUpTo(byteCount: number, hasRoom: SceneStorage['hasRoom']): Promise<number> {
  for (let step = STEPS - 1; step > 0; step--) {
    const bytes = Math.floor((step * byteCount) / STEPS);
    if (await hasRoom(bytes)) return bytes;
  }
  return 0;
}
