import { roundUp } from '../data/layout/gpu-struct.ts';
import { fromHalfBits } from '../data/layout/half.ts';
import { readBack } from './read-back.ts';

/** RGBA of a texture, top row first. */
export interface TextureImage {
  readonly widthPx: number;
  readonly heightPx: number;
  /** 4·width·height values. */
  readonly data: Float32Array;
}

/** How each format holds a channel. */
const CHANNELS = {
  rgba8unorm: { Words: Uint8Array, decode: (word: number) => word / 255 },
  rgba16float: { Words: Uint16Array, decode: fromHalfBits },
  rgba32float: { Words: Float32Array, decode: (word: number) => word },
} as const;

/**
 * Copies a texture in one of the `ColorTarget` formats to the CPU, in strips where it exceeds
 * `maxBufferSize`. Submits before it returns.
 *
 * @throws GpuLimitError if memory is lacking, or a row of pixels exceeds `maxBufferSize`;
 *   DestroyedError if the device ends before.
 */
export async function readTexture(device: GPUDevice, texture: GPUTexture): Promise<TextureImage> {
  const { width, height, format } = texture;
  if (!(format in CHANNELS)) throw new RangeError(`Textures of ${format} cannot be read back.`);
  const { Words, decode } = CHANNELS[format as keyof typeof CHANNELS];
  const rowValues = 4 * width;
  const bytesPerRow = roundUp(rowValues * Words.BYTES_PER_ELEMENT, 256);
  const stripRows = Math.max(1, Math.floor(device.limits.maxBufferSize / bytesPerRow));
  const strips = Array.from({ length: Math.ceil(height / stripRows) }, (_, strip) => {
    const y = strip * stripRows;
    const rows = Math.min(stripRows, height - y);
    return readBack(device, bytesPerRow * rows, (encoder, buffer) =>
      encoder.copyTextureToBuffer(
        { texture, origin: { x: 0, y } },
        { buffer, bytesPerRow },
        { width, height: rows },
      ),
    );
  });
  const contents = await Promise.all(strips);
  const data = new Float32Array(rowValues * height);
  for (let row = 0; row < height; row++) {
    const strip = contents[Math.floor(row / stripRows)];
    const words = new Words(strip, (row % stripRows) * bytesPerRow, rowValues);
    // `Float32Array.from` goes through an iterator, which takes several times as long.
    for (let i = 0; i < rowValues; i++) data[row * rowValues + i] = decode(words[i]);
  }
  return { widthPx: width, heightPx: height, data };
}
