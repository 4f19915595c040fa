import { SplatFileError } from '../../../data/errors.ts';
import type { Turns } from '../../../data/turns.ts';
import { FewRequests } from '../../sources/few-requests.ts';
import { folderOf } from '../../sources/inner-path.ts';
import { shortName } from '../../sources/known-source.ts';
import { openUrl } from '../../sources/open-url.ts';
import { fetchedPart } from '../../sources/read-part.ts';
import type { OpenedSource, ReadOptions } from '../../sources/splat-source.ts';
import { checkCount } from '../rows/splat-counts.ts';
import { checkPath } from '../scene-file-reader.ts';
import type { SogFile } from './pack-leaves.ts';
import { type ReadSceneFile, readOpened } from './scene-files.ts';
import { imageNames } from './sog-images.ts';
import { MAX_META_BYTES, parseMeta, parseSogMeta } from './sog-meta.ts';

/** Parallel requests for the images of a file. */
export const REQUESTS_OF_FILE = 4;
/** Bytes that are told of together: each message takes some of the page's time. */
const TOLD_BYTES = 1 << 17;

/** Facts about a file, according to the scene's metadata. */
export interface PromisedFile extends Pick<SogFile, 'path' | 'shDegree' | 'origin' | 'maxBytes'> {
  /** Number of splats. */
  readonly count: number;
  readonly maxSplats: number | undefined;
}

/** The scene of a file to fetch. Can be posted. */
export interface FetchedScene extends Pick<OpenedSource, 'name' | 'fetched'> {}

/** A file, still compressed. Can be posted. */
export interface ReadFile extends Pick<SogFile, 'images'> {
  /** Its metadata. */
  readonly json: unknown;
}

/**
 * Fetches a file of a streamed scene, and tells of the bytes as they come.
 *
 * Rejects as `readSogFile`.
 */
export async function fetchSogFile(
  { scene, promised }: { readonly scene: FetchedScene; readonly promised: PromisedFile },
  { signal }: Turns,
  onProgress: (bytes: number) => void,
): Promise<ReadFile> {
  let untoldBytes = 0;
  const tell = (most: number) => {
    if (untoldBytes < most) return;
    onProgress(untoldBytes);
    untoldBytes = 0;
  };
  const count = (bytes: number) => {
    untoldBytes += bytes;
    tell(TOLD_BYTES);
  };
  try {
    return await readSogFile(partsAt(scene, promised), promised, signal, count);
  } finally {
    tell(1);
  }
}

/** Returns a function that fetches files beside a file that was fetched. */
export function partsAt(scene: FetchedScene, { maxBytes }: Pick<ReadOptions, 'maxBytes'>): ReadSceneFile {
  return async (path, signal, onBytes) => {
    const { url, request } = fetchedPart(scene, path);
    let before = 0;
    const count = (loadedBytes: number) => {
      onBytes?.(loadedBytes - before);
      before = loadedBytes;
    };
    const part = await openUrl(url, { name: shortName(path), request, signal });
    return new Blob([await readOpened(part, { signal, maxBytes }, Number.POSITIVE_INFINITY, count)]);
  };
}

/** The JSON of a file's metadata. Rejects as `read`, and with SplatFileError if it is none. */
export async function readJson(
  read: ReadSceneFile,
  path: string,
  signal?: AbortSignal,
  onBytes?: (bytes: number) => void,
): Promise<unknown> {
  const blob = await read(path, signal, onBytes);
  const bytes = new Uint8Array(await blob.slice(0, MAX_META_BYTES + 1).arrayBuffer());
  return parseMeta(bytes, path);
}

/**
 * Reads a file of a streamed scene.
 *
 * Rejects as `read`, and with SplatFileError for wrong metadata, and 'damaged' if the file
 * contradicts the scene's.
 */
export async function readSogFile(
  read: ReadSceneFile,
  { path, count, maxSplats }: PromisedFile,
  signal: AbortSignal | undefined,
  onBytes: (bytes: number) => void,
): Promise<ReadFile> {
  const json = await readJson(read, path, signal, onBytes);
  const meta = parseSogMeta(json, path);
  if (meta.count !== count) {
    const message = `it has ${meta.count} splats, where the scene says ${count}. Export the scene again.`;
    throw new SplatFileError('damaged', path, message);
  }
  checkCount(count, path, maxSplats ?? Number.POSITIVE_INFINITY);
  const paths = imageNames(meta).map((name) => folderOf(path) + name);
  for (const image of paths) checkPath(image, path);
  const requests = new FewRequests(REQUESTS_OF_FILE);
  const readImage = (image: string) => requests.run(() => read(image, signal, onBytes), signal);
  const blobs = await Promise.all(paths.map(readImage));
  return { json, images: new Map(paths.map((image, i) => [image, blobs[i]])) };
}
