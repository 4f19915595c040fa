import { SplatSourceError } from '@websplatter/core';
import type { Loader } from 'three/webgpu';

/** Fetches `address` with the headers and credentials of a loader. @throws SplatSourceError if the server refuses. */
export async function fetchGuarded(
  address: string,
  { requestHeader, withCredentials }: Pick<Loader, 'requestHeader' | 'withCredentials'>,
  signal: AbortSignal,
): Promise<ReadableStream<Uint8Array>> {
  const credentials = withCredentials ? 'include' : 'same-origin';
  const response = await fetch(address, { headers: requestHeader, credentials, signal });
  if (response.ok && response.body) return response.body;
  throw new SplatSourceError(address, `the server answered ${response.status}`, response.status);
}
