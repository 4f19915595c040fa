import { printable } from '@websplatter/core';
import { formatBytes } from '../ui/format.ts';

/** A `settings.json` with more bytes than this is something else. */
const MOST_BYTES = 16 * 2 ** 20;
/** Longest time for a server to send all of it, ms. */
const MOST_MS = 30_000;

/** The text at an address. Rejects with what to do where it cannot be read, is too large, or takes too long. */
export async function textAt(url: URL): Promise<string> {
  const name = printable(url.href);
  const stop = new AbortController();
  const timer = setTimeout(() => stop.abort(), MOST_MS);
  try {
    const response = await fetch(url, { signal: stop.signal });
    if (!response.ok) throw new Error(notRead(name, ` (${response.status})`));
    return await textOfStream(response.body ?? new Blob().stream(), name);
  } catch (error) {
    if (stop.signal.aborted) throw new Error(notRead(name, ` within ${MOST_MS / 1000} s`));
    throw error instanceof TypeError ? new Error(notRead(name, '')) : error;
  } finally {
    // What has not come yet is not wanted.
    stop.abort();
    clearTimeout(timer);
  }
}

/** The text of a file. Rejects where it is too large. */
export function textOf(file: File): Promise<string> {
  return textOfStream(file.stream(), file.name);
}

async function textOfStream(stream: ReadableStream<Uint8Array<ArrayBuffer>>, name: string): Promise<string> {
  const pieces: Uint8Array<ArrayBuffer>[] = [];
  let bytes = 0;
  const reader = stream.getReader();
  for (let read = await reader.read(); !read.done; read = await reader.read()) {
    pieces.push(read.value);
    bytes += read.value.length;
    if (bytes <= MOST_BYTES) continue;
    reader.cancel().catch(() => {});
    throw new Error(`${name} has more than ${formatBytes(MOST_BYTES)}: that is no settings.json.`);
  }
  return new Blob(pieces).text();
}

function notRead(name: string, why: string): string {
  return `${name} cannot be read${why}: check the address; the server must allow reading from this page.`;
}
