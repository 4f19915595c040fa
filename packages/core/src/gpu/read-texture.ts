import { DestroyedError } from '../errors.ts';
import { roundUp } from '../layout/gpu-struct.ts';
import { fromHalfBits } from '../layout/half.ts';

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

/** Copies a texture in one of the `ColorTarget` formats to the CPU. @throws DestroyedError if the device ends before. */
export async function readTexture(device: GPUDevice, texture: GPUTexture): Promise<TextureImage> {
  const { width, height, format } = texture;
  if (!(format in CHANNELS)) throw new RangeError(`Textures of ${format} cannot be read back.`);
  const { Words, decode } = CHANNELS[format as keyof typeof CHANNELS];
  const rowValues = 4 * width;
  const bytesPerRow = roundUp(rowValues * Words.BYTES_PER_ELEMENT, 256);
  const buffer = device.createBuffer({
    label: 'read-back',
    size: bytesPerRow * height,
    usage: GPUBufferUsage.COPY_DST | GPUBufferUsage.MAP_READ,
  });
  const encoder = device.createCommandEncoder();
  encoder.copyTextureToBuffer({ texture }, { buffer, bytesPerRow }, { width, height });
  device.queue.submit([encoder.finish()]);
  await buffer.mapAsync(GPUMapMode.READ).catch((cause: Error) => {
    throw new DestroyedError('This image', cause.message);
  });
  const contents = buffer.getMappedRange();
  const data = new Float32Array(rowValues * height);
  for (let row = 0; row < height; row++) {
    const words = new Words(contents, row * bytesPerRow, rowValues);
    // `Float32Array.from` goes through an iterator, which takes several times as long.
    for (let i = 0; i < rowValues; i++) data[row * rowValues + i] = decode(words[i]);
  }
  buffer.unmap();
  buffer.destroy();
  return { widthPx: width, heightPx: height, data };
}
