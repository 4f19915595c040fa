import { fetchedPart } from '../../sources/read-part.ts';
import { checkPath } from '../scene-file-reader.ts';
import { imageNames } from './sog-images.ts';
import { parseMeta, parseSogMeta } from './sog-meta.ts';

/** A file of a scene that was fetched. */
export interface PartAddress {
  /** Path relative to the scene's folder, as in its metadata. */
  readonly path: string;
  readonly url: string;
}

/** See `sogImageAddresses` of `writers.ts`. */
export function imageAddresses(meta: Uint8Array, address: string): PartAddress[] {
  const names = imageNames(parseSogMeta(parseMeta(meta, address), address));
  return names.map((path) => {
    checkPath(path, address);
    return { path, url: fetchedPart({ name: address, fetched: { url: address, request: {} } }, path).url };
  });
}
