import type { SceneFiles } from '@websplatter/core';
import { FORMAT_TITLES, SPLAT_FORMATS } from '@websplatter/core/formats';
import type { AskedHandle } from './file-handles.ts';
import { type FoundFile, MOST_FILES } from './found-file.ts';

/** Files that make one scene, and its name. */
export interface OpenedFiles {
  readonly name: string;
  readonly source: File | SceneFiles;
}

/** The answer to dropped or chosen files: scenes to open, a reason why not, or both. */
export interface FileDropDecision {
  /** Each is shown as a part of one scene; none where there is nothing to open. */
  readonly opened: readonly OpenedFiles[];
  readonly notice: string | null;
  /** A `settings.json` of SuperSplat's, for the opened scene, or else for the shown one. */
  readonly settings?: File;
  /** Whether they join the scene, instead of taking its place. */
  readonly isAdded?: boolean;
  /** By which the files can be read again later; none where the browser has none. */
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

/** Ends of names that an input for files accepts. */
export const ACCEPTED_FILES = [
  ...SPLAT_FORMATS.flatMap(({ extensions }) => extensions),
  '.webp',
  '.bin',
  '.gz',
].join();

/** Formats that people may drop, e.g. `PLY, SPZ or SOG`. */
export const READABLE_FORMATS = new Intl.ListFormat('en', { type: 'disjunction' }).format(FORMAT_TITLES);

/** Lists the files of a drop, also in folders. Call it within the event, which empties items. */
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
    // Browsers give a hundred at a time, and none at the end.
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

/** Files of an input, with their paths where a folder was chosen. */
export function chosenFiles(files: Iterable<File>): FoundFile[] {
  return Array.from(files, (file) => ({ path: file.webkitRelativePath || file.name, file }));
}
