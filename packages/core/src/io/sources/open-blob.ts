import type { OpenedSource } from './splat-source.ts';

export function openBlob(blob: Blob, name: string): OpenedSource {
  return { name, totalBytes: blob.size, totalBytesCertain: true, isHeld: true, stream: blob.stream() };
}
