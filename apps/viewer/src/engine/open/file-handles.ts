import { type AskedHandle, type FoundFile, MOST_FILES } from './file-drop.ts';

/** Lets the user choose files in a picker that returns handles; null if the browser has none. */
export async function pickHandles(): Promise<readonly AskedHandle[] | null> {
  const { showOpenFilePicker } = window as unknown as {
    showOpenFilePicker?: (options: { readonly multiple: boolean }) => Promise<AskedHandle[]>;
  };
  if (!showOpenFilePicker) return null;
  try {
    return await showOpenFilePicker({ multiple: true });
  } catch (error) {
    // The user cancelled. Any other error means that the picker is not allowed here, e.g. in a
    // frame.
    return (error as Error).name === 'AbortError' ? [] : null;
  }
}

/**
 * Reads the files of `handles`, including files in folders; null if the user denies permission.
 *
 * @throws DOMException if a file or folder no longer exists.
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
