/** The answer to dropped or chosen files: a file to open, a reason why not, or both. */
export interface FileDropDecision {
  readonly file: File | null;
  readonly notice: string | null;
}

interface DroppedItem {
  readonly kind: string;
  getAsFile(): File | null;
  webkitGetAsEntry?(): { readonly isDirectory: boolean } | null;
}

/** Decides over the items of a drop; call it within the event, after which the browser empties them. */
export function decideDrop(items: Iterable<DroppedItem>): FileDropDecision {
  const files: File[] = [];
  let folders = 0;
  for (const item of items) {
    if (item.kind !== 'file') continue;
    if (item.webkitGetAsEntry?.()?.isDirectory) {
      folders++;
      continue;
    }
    const file = item.getAsFile();
    if (file) files.push(file);
  }
  if (files.length > 0) return decideFiles(files);
  return {
    file: null,
    notice:
      folders > 0 ? 'That is a folder; drop the PLY file inside it.' : 'That is no file; drop a PLY file.',
  };
}

/** Opens the first PLY of several files: the viewer shows one scene at a time. */
export function decideFiles(files: readonly File[]): FileDropDecision {
  const file = files.find(({ name }) => /\.ply$/i.test(name)) ?? files[0] ?? null;
  const others = files.length - 1;
  if (!file || others < 1) return { file, notice: null };
  const left = others === 1 ? 'the other file was' : `the other ${others} files were`;
  return { file, notice: `One scene at a time: ${file.name} is opened, ${left} left out.` };
}
