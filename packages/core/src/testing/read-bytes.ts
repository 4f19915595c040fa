import type { ReadFormat, SplatFormatOptions } from '../io/formats/splat-format.ts';
import { ByteReader } from '../io/sources/byte-reader.ts';
import { openSource } from '../io/sources/open-source.ts';
import type { PackedHarmonics } from '../packing/harmonics.ts';
import type { SplatSet } from '../splats/splat-set.ts';

/** Reads bytes with the code of one format, as exactly as they are: harmonics in float32. */
export async function readBytes(
  read: ReadFormat,
  bytes: Uint8Array,
  options: Partial<SplatFormatOptions> = {},
): Promise<SplatSet<PackedHarmonics>> {
  const opened = await openSource(bytes, { name: 'file' });
  const reader = new ByteReader(opened);
  const all = {
    shPrecision: 'f32',
    maxSplats: Number.POSITIVE_INFINITY,
    maxBytes: Number.POSITIVE_INFINITY,
  } as const;
  try {
    // Without a sink there is always a set.
    return (await read({ ...opened, reader }, { ...all, ...options }))!;
  } finally {
    reader.close();
  }
}
