import type { Harmonics } from '../data/packing/harmonics.ts';
import type { SplatSet } from '../data/splats/splat-set.ts';
import { FrameWriter, type FrameWriterOptions } from '../io/formats/frames/frame-writer.ts';

/** The bytes of a file of frames. */
export async function framesFile(
  frames: readonly SplatSet<Harmonics>[],
  options?: FrameWriterOptions,
): Promise<Uint8Array<ArrayBuffer>> {
  const writer = new FrameWriter(options);
  for (const frame of frames) await writer.add(frame);
  const parts: Uint8Array<ArrayBuffer>[] = [];
  await writer.finish(async (part) => {
    parts.push(part);
  });
  return new Uint8Array(await new Blob(parts).arrayBuffer());
}
