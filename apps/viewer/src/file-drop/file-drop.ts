/** What to do with what was dropped or chosen: open a file, say why not, or both. */
export interface DropDecision {
  readonly file: File | null;
  readonly notice: string | null;
}

interface DroppedItem {
  readonly kind: string;
  getAsFile(): File | null;
  webkitGetAsEntry?(): { readonly isDirectory: boolean } | null;
}

/** Decides over the items of a drop; call it within the event, after which the browser empties them. */
export function decideDrop(items: Iterable<DroppedItem>): DropDecision {
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

/** Of several files the first PLY is opened: there is one scene at a time. */
export function decideFiles(files: readonly File[]): DropDecision {
  const file = files.find(({ name }) => /\.ply$/i.test(name)) ?? files[0] ?? null;
  const others = files.length - 1;
  if (!file || others < 1) return { file, notice: null };
  const left = others === 1 ? 'the other file was' : `the other ${others} files were`;
  return { file, notice: `One scene at a time: ${file.name} is opened, ${left} left out.` };
}
