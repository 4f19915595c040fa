import { type FoundFile, MOST_FILES } from './found-file.ts';

/** A handle of Chromium's File System Access API, of which TypeScript's library knows a part. */
export interface AskedHandle {
  readonly kind: 'file' | 'directory';
  readonly name: string;
  getFile?(): Promise<File>;
  values?(): AsyncIterable<AskedHandle>;
  requestPermission?(options: { readonly mode: 'read' }): Promise<PermissionState>;
}

/** Lets a person choose files, with handles; null where the browser has no such picker. */
export async function pickHandles(): Promise<readonly AskedHandle[] | null> {
  const { showOpenFilePicker } = window as unknown as {
    showOpenFilePicker?: (options: { readonly multiple: boolean }) => Promise<AskedHandle[]>;
  };
  if (!showOpenFilePicker) return null;
  try {
    return await showOpenFilePicker({ multiple: true });
  } catch (error) {
    // Called off by the person; anything else means that it is not allowed here, in a frame say.
    return (error as Error).name === 'AbortError' ? [] : null;
  }
}

/** Handles of a drop, if the browser gives them. Call it within the event, which empties items. */
export async function droppedHandles(items: Iterable<DataTransferItem>): Promise<readonly AskedHandle[]> {
  const asked = Array.from(items, (item) =>
    (item as unknown as { getAsFileSystemHandle?: () => Promise<AskedHandle | null> })
      .getAsFileSystemHandle?.()
      .catch(() => null),
  );
  const handles = await Promise.all(asked);
  return handles.filter((handle) => handle !== null && handle !== undefined);
}

/**
 * The files of `handles`, those in folders too; null if the person does not allow it.
 *
 * @throws DOMException where one is no longer there.
 */
export async function filesOf(handles: readonly AskedHandle[]): Promise<FoundFile[] | null> {
  const files: FoundFile[] = [];
  for (const handle of handles) {
    const permission = (await handle.requestPermission?.({ mode: 'read' })) ?? 'granted';
    if (permission !== 'granted') return null;
    await addFiles(handle, '', files);
  }
  return files;
}

async function addFiles(handle: AskedHandle, folder: string, files: FoundFile[]): Promise<void> {
  const path = folder + handle.name;
  if (handle.kind === 'file') {
    const file = await handle.getFile?.();
    if (file) files.push({ path, file });
    return;
  }
  for await (const member of handle.values?.() ?? []) {
    if (files.length >= MOST_FILES) return;
    await addFiles(member, `${path}/`, files);
  }
}
