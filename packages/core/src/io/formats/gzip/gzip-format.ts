import type { SplatFormat } from '../splat-format.ts';

/** A scene that is packed by gzip, under any name. */
export const gzipFormat: SplatFormat = {
  name: 'gzip',
  title: 'gzip',
  extensions: ['.gz'],
  recognise: isGzip,
};

export function isGzip(firstBytes: Uint8Array): boolean {
  return firstBytes[0] === 0x1f && firstBytes[1] === 0x8b;
}
