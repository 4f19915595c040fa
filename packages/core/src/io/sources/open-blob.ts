import type { OpenedSource } from './splat-source.ts';

export function openBlob(blob: Blob, name: string): OpenedSource {
  const reopen = () => blob.stream();
  return { name, totalBytes: blob.size, totalBytesCertain: true, isHeld: true, stream: reopen(), reopen };
}
