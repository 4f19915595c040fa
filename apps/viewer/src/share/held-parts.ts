import { type PartAddress, sogImageAddresses } from '@websplatter/core/write';
import { baseName, formatBytes } from '@websplatter/kit/format';
import { localFiles } from '../engine/open/local-files.ts';
import { type SceneSource, titleOf } from '../engine/open/scene-source.ts';
import type { HeldFile, HeldPart } from './page-text.ts';

/** A page and its scene as one file, or as files for a web host in a zip. */
export type PageKind = 'html' | 'zip';

/** Most bytes of a scene: browsers hold a page's text, which is a third larger, or a zip as a whole. */
export const MOST_BYTES: Readonly<Record<PageKind, number>> = { html: 200e6, zip: 1e9 };

/** A scene cannot be embedded in a page; `advice` is the remedy. */
export class PageRefusal extends Error {
  readonly advice: string;

  constructor(message: string, advice: string) {
    super(message);
    this.advice = advice;
  }
}

export interface ReadPartsOptions {
  readonly kind: PageKind;
  readonly signal: AbortSignal;
  /** Called with the part that has been read, 0…1, or undefined where that is not known. */
  readonly onPart: (part: number | undefined) => void;
}

/**
 * The files of a scene as they came, so that a page of them shows the same picture.
 *
 * @throws PageRefusal where they are too large, cannot be fetched, or are not known one by one; the
 * signal's reason once that is aborted.
 */
export async function readParts(
  sources: readonly SceneSource[],
  { kind, signal, onPart }: ReadPartsOptions,
): Promise<HeldPart[]> {
  const parts: HeldPart[] = [];
  let leftBytes = MOST_BYTES[kind];
  for (const [i, source] of sources.entries()) {
    const onFile = (part: number | undefined) =>
      onPart(part === undefined ? undefined : (i + part) / sources.length);
    const files = await filesOf(source, leftBytes, { kind, signal, onPart: onFile });
    leftBytes -= files.reduce((sum, { bytes }) => sum + bytes.size, 0);
    if (leftBytes < 0) throw tooLarge(kind, 'The scene', MOST_BYTES[kind] - leftBytes);
    const builtin = source.kind === 'builtin' ? source.scene.name : null;
    parts.push({ title: titleOf(source), builtin, files });
  }
  return parts;
}

interface FetchedFile extends HeldFile {
  /** The address that answered. */
  readonly url: string;
}

async function filesOf(
  source: SceneSource,
  mostBytes: number,
  options: ReadPartsOptions,
): Promise<readonly HeldFile[]> {
  switch (source.kind) {
    case 'builtin':
      return [await fetchFile(source.scene.url, mostBytes, options)];
    case 'url':
      return fetchFiles(source.url, mostBytes, options);
    case 'file':
      return localFiles(source.source);
    case 'hard-case':
      throw new PageRefusal('This scene does not come from a file.', '');
  }
}

async function fetchFiles(url: URL, mostBytes: number, options: ReadPartsOptions): Promise<HeldFile[]> {
  const name = baseName(url.href);
  // These formats refer to other files, and not every reference can be found here.
  if (/^lod-meta\.json$|\.(gltf|rad)$/i.test(name))
    throw new PageRefusal(
      `${name} may refer to other files on its server.`,
      'Open its files from this device, all at once, and save the page then.',
    );
  const first = await fetchFile(url, mostBytes, options);
  if (!/\.json$/i.test(name)) return [first];
  // Archives are read by this name.
  const files: HeldFile[] = [{ ...first, path: 'meta.json' }];
  let leftBytes = mostBytes - first.bytes.size;
  for (const { path, url: partUrl } of await imagesOf(first)) {
    const { bytes } = await fetchFile(new URL(partUrl), leftBytes, options);
    leftBytes -= bytes.size;
    files.push({ path, bytes });
  }
  return files;
}

/** The images of a SOG: the files that the engine has read, and no others that its metadata may name. */
async function imagesOf({ path, bytes, url }: FetchedFile): Promise<PartAddress[]> {
  try {
    return await sogImageAddresses(new Uint8Array(await bytes.arrayBuffer()), url);
  } catch (error) {
    throw notRead(path, error);
  }
}

async function fetchFile(
  url: URL,
  mostBytes: number,
  { kind, signal, onPart }: ReadPartsOptions,
): Promise<FetchedFile> {
  const name = baseName(url.href);
  onPart(undefined);
  const response = await fetch(url, { signal }).catch((error: unknown) => {
    signal.throwIfAborted();
    throw notRead(name, error);
  });
  if (!response.ok || !response.body) throw notRead(name, `the server answers ${response.status}`);
  const totalBytes = Number(response.headers.get('content-length') ?? 0);
  if (totalBytes > mostBytes) throw tooLarge(kind, name, totalBytes);
  const pieces: Uint8Array<ArrayBuffer>[] = [];
  let readBytes = 0;
  try {
    const reader = response.body.getReader();
    for (let read = await reader.read(); !read.done; read = await reader.read()) {
      const piece = read.value;
      pieces.push(piece);
      readBytes += piece.length;
      if (readBytes > mostBytes) throw tooLarge(kind, name);
      // Content-Length counts compressed bytes, `readBytes` decompressed ones: the ratio may exceed 1.
      if (totalBytes > 0) onPart(Math.min(1, readBytes / totalBytes));
    }
  } catch (error) {
    signal.throwIfAborted();
    throw error instanceof PageRefusal ? error : notRead(name, error);
  }
  return { path: name, bytes: new Blob(pieces), url: response.url || url.href };
}

function notRead(name: string, reason: unknown): PageRefusal {
  const words = reason instanceof Error ? reason.message : String(reason);
  return new PageRefusal(
    `${name} cannot be read again: ${words}.`,
    'Check the connection, or open the file from this device.',
  );
}

function tooLarge(kind: PageKind, name: string, bytes?: number): PageRefusal {
  const size = bytes === undefined ? 'is too large' : `has ${formatBytes(bytes)}`;
  return new PageRefusal(
    `${name} ${size}: an .${kind} file holds at most ${formatBytes(MOST_BYTES[kind])}.`,
    'Save the scene as a smaller file (.spz, .sog or a crop), open that and save the page then. Or put the file on a web server and use the embed code.',
  );
}
