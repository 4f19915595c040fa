import { SplatFileError } from '../../data/errors.ts';
import type { SplatFormatOptions, SplatInput } from '../formats/read-format.ts';
import { ByteReader } from './byte-reader.ts';
import { shortName } from './known-source.ts';
import { openUrl } from './open-url.ts';
import { readAll } from './read-all.ts';
import { limitsOf } from './read-limits.ts';
import type { OpenedSource, RequestOptions } from './splat-source.ts';

type PartOptions = Pick<SplatFormatOptions, 'signal' | 'maxBytes'>;

/** Receives a file's size, if known; returns a callback for the number of bytes that have arrived. */
type BeginPart = (totalBytes: number | undefined) => (loadedBytes: number) => void;

/**
 * Reads another file of the scene of `input`.
 *
 * Rejects as `openPart`, and as `readSource` if the file cannot be read.
 *
 * @param path relative to the folder of `input`.
 * @param begin called once the file is open.
 */
export async function readPart(
  input: SplatInput,
  path: string,
  options: PartOptions,
  begin: BeginPart,
): Promise<Uint8Array<ArrayBuffer>> {
  return readOpenedPart(await openPart(input, path, options), options, begin);
}

/**
 * Opens another file of the scene of `input`.
 *
 * Rejects with SplatFileError 'missing-part' if the source is a single file or lacks this one; as
 * `openSource`; and with the signal's reason.
 *
 * @param path relative to the folder of `input`.
 */
export async function openPart(
  input: Pick<SplatInput, 'name' | 'fetched' | 'openPart'>,
  path: string,
  { signal }: PartOptions,
): Promise<OpenedSource> {
  return input.openPart ? input.openPart(path) : openFetched(input, path, signal);
}

/** Reads the result of `openPart`. @param begin see `readPart`. */
export async function readOpenedPart(
  opened: OpenedSource,
  { signal, maxBytes }: PartOptions,
  begin: BeginPart,
): Promise<Uint8Array<ArrayBuffer>> {
  const reader = new ByteReader(opened, signal, limitsOf({ maxBytes }, opened).maxBytes);
  try {
    const { isLocal, totalBytes } = opened;
    return await readAll(reader, Number.POSITIVE_INFINITY, isLocal ? totalBytes : 0, begin(totalBytes));
  } finally {
    reader.close();
  }
}

function openFetched(
  input: Pick<SplatInput, 'name' | 'fetched'>,
  path: string,
  signal: AbortSignal | undefined,
): Promise<OpenedSource> {
  const { url, request } = fetchedPart(input, path);
  return openUrl(url, { name: shortName(path), request, signal });
}

/**
 * URL of another file of a scene that was fetched. It must lie in the scene's folder, because
 * credentials are sent along.
 *
 * @param path relative to the folder of `input`.
 * @throws SplatFileError 'missing-part' if the scene was not fetched, or the path leaves its
 *   folder.
 */
export function fetchedPart(
  { name, fetched }: Pick<SplatInput, 'name' | 'fetched'>,
  path: string,
): { readonly url: string; readonly request: RequestOptions } {
  const missing = (message: string) => new SplatFileError('missing-part', name, message);
  if (!fetched)
    throw missing(`it needs ${path}, another file. Open all files of the scene together, or its address.`);
  const { url: base, request } = fetched;
  const url = URL.canParse(path, base) ? new URL(path, base) : null;
  const advice = 'Put all files of the scene together';
  if (url?.origin !== new URL(base).origin)
    throw missing(`it needs ${shortName(path)}, which lies on another server. ${advice}.`);
  if (!url.href.startsWith(new URL('.', base).href))
    throw missing(`it needs ${shortName(path)}, which lies outside of its folder. ${advice}.`);
  return { url: url.href, request };
}
