import type { SceneFiles } from '@websplatter/core';
import { FORMAT_TITLES, SPLAT_FORMATS } from '@websplatter/core/formats';

/** A file, and its path from the folder that was dropped or chosen. */
export interface FoundFile {
  readonly path: string;
  readonly file: File;
}

/** A dropped folder may be a whole disk. */
export const MOST_FILES = 2000;

/**
 * A handle of Chromium's File System Access API, which TypeScript's DOM types cover only in part.
 */
export interface AskedHandle {
  readonly kind: 'file' | 'directory';
  readonly name: string;
  getFile?(): Promise<File>;
  values?(): AsyncIterable<AskedHandle>;
  requestPermission?(options: { readonly mode: 'read' }): Promise<PermissionState>;
}

/** Files that make one scene, and its name. */
export interface OpenedFiles {
  readonly name: string;
  readonly source: File | SceneFiles;
}

/** The answer to dropped or chosen files: scenes to open, a reason why not, or both. */
export interface FileDropDecision {
  /** Files to open, each as a part of one scene; empty if there is nothing to open. */
  readonly opened: readonly OpenedFiles[];
  readonly notice: string | null;
  /**
   * SuperSplat's `settings.json` for the opened scene, or for the current one if none is opened.
   */
  readonly settings?: File;
  /** A project, which is opened instead of files. */
  readonly project?: File;
  /** Whether the files are added to the scene instead of replacing it. */
  readonly isAdded?: boolean;
  /** Handles to read the files again later; none in browsers without handles. */
  readonly handles?: readonly AskedHandle[];
}

type DroppedEntry = Pick<FileSystemEntry, 'isDirectory' | 'fullPath'> &
  Partial<Pick<FileSystemDirectoryEntry, 'createReader'>> &
  Partial<Pick<FileSystemFileEntry, 'file'>>;

interface DroppedItem {
  readonly kind: string;
  getAsFile(): File | null;
  webkitGetAsEntry?(): DroppedEntry | null;
}

/** How names of project files end. */
export const PROJECT_ENDING = '.wsplat';

/** Name endings that a file input accepts. */
export const ACCEPTED_FILES = [
  ...SPLAT_FORMATS.flatMap(({ extensions }) => extensions),
  '.webp',
  '.bin',
  '.gz',
  PROJECT_ENDING,
].join();

/** Formats that users may drop, e.g. `PLY, SPZ or SOG`. */
export const READABLE_FORMATS = new Intl.ListFormat('en', { type: 'disjunction' }).format(FORMAT_TITLES);

/**
 * Lists dropped files, including files in folders. Call it synchronously in the drop event:
 * browsers empty `items` afterwards.
 */
export async function droppedFiles(items: Iterable<DroppedItem>): Promise<FoundFile[]> {
  const found: (FoundFile | DroppedEntry)[] = [];
  for (const item of items) {
    if (item.kind !== 'file') continue;
    const entry = item.webkitGetAsEntry?.();
    const file = item.getAsFile();
    if (entry?.isDirectory) found.push(entry);
    else if (file) found.push({ path: file.name, file });
  }
  const files: FoundFile[] = [];
  for (const each of found) {
    if ('file' in each && each.file instanceof File) files.push(each as FoundFile);
    else await addFolder(each as DroppedEntry, files);
  }
  return files;
}

async function addFolder(folder: DroppedEntry, files: FoundFile[]): Promise<void> {
  const reader = folder.createReader?.();
  while (reader && files.length < MOST_FILES) {
    // Browsers return at most a hundred entries at a time, and none at the end.
    const entries = await new Promise<FileSystemEntry[]>((resolve, reject) => {
      reader.readEntries(resolve, reject);
    });
    if (entries.length === 0) return;
    for (const entry of entries as DroppedEntry[]) {
      if (entry.isDirectory) await addFolder(entry, files);
      else {
        const file = await new Promise<File>((resolve, reject) => {
          entry.file?.(resolve, reject);
        });
        files.push({ path: entry.fullPath.replace(/^\//, ''), file });
      }
    }
  }
}

/**
 * Handles of dropped files, if the browser has them. Call it synchronously in the drop event:
 * browsers empty `items` afterwards.
 */
export async function droppedHandles(items: Iterable<DataTransferItem>): Promise<readonly AskedHandle[]> {
  const asked = Array.from(items, (item) =>
    (item as unknown as { getAsFileSystemHandle?: () => Promise<AskedHandle | null> })
      .getAsFileSystemHandle?.()
      // The file itself is there without a handle; it is only not offered again after a reload.
      .catch(() => null),
  );
  const handles = await Promise.all(asked);
  return handles.filter((handle) => handle !== null && handle !== undefined);
}

/** Files of a file input, with their paths if a folder was chosen. */
export function chosenFiles(files: Iterable<File>): FoundFile[] {
  return Array.from(files, (file) => ({ path: file.webkitRelativePath || file.name, file }));
}
