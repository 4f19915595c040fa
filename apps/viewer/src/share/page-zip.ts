import { zipFiles } from '@websplatter/core/write';
import { pathSegment } from '../ui/path-segment.ts';
import { type PageContents, type WritePageOptions, writePage } from './page-text.ts';

const POSTER = 'poster.png';

/**
 * Puts the page and the files of its scene, which then lie beside it, into a zip for any web host.
 *
 * @param poster PNG that the page shows until there is a picture.
 * @throws as `writePage`, and as `zipFiles` for a scene of several files.
 */
export async function zipPage(
  template: string,
  contents: PageContents,
  poster: Blob,
  options: WritePageOptions,
): Promise<Blob> {
  const beside: Record<string, Uint8Array> = {};
  const parts = [];
  // In folders of their own, as two files may have one name.
  for (const [i, part] of contents.parts.entries()) {
    const paths = Object.fromEntries(part.files.map(({ path, bytes }) => [path, bytes]));
    const [name, bytes] =
      part.files.length === 1
        ? [part.files[0].path, await bytesOf(part.files[0].bytes)]
        : // A scene of several files can be read by one address as an archive of them.
          [`${part.title}.zip`, zipFiles(await allBytesOf(paths))];
    const path = pathSegment(name);
    beside[`scene/${i + 1}/${path}`] = bytes;
    const address = `scene/${i + 1}/${encodeURIComponent(path)}`;
    parts.push({ ...part, files: [{ path, bytes: new Blob(), address }] });
    options.signal.throwIfAborted();
  }
  const page = await writePage(template, { ...contents, parts, poster: POSTER }, options);
  const files = { ...(await allBytesOf({ 'index.html': page, [POSTER]: poster })), ...beside };
  return new Blob([zipFiles(files)], { type: 'application/zip' });
}

async function allBytesOf(files: Readonly<Record<string, Blob>>): Promise<Record<string, Uint8Array>> {
  const entries = Object.entries(files).map(async ([path, blob]) => [path, await bytesOf(blob)]);
  return Object.fromEntries(await Promise.all(entries));
}

async function bytesOf(blob: Blob): Promise<Uint8Array> {
  return new Uint8Array(await blob.arrayBuffer());
}
