import { roundUp } from '../layout/gpu-struct.ts';
import { fromHalfBits } from '../layout/half.ts';

/** RGBA of a texture, top row first. */
export interface TextureImage {
  readonly widthPx: number;
  readonly heightPx: number;
  /** 4·width·height values. */
  readonly data: Float32Array;
}

const DECODERS: Partial<
  Record<GPUTextureFormat, (row: ArrayBuffer, byteOffset: number, values: number) => ArrayLike<number>>
> = {
  rgba8unorm: (row, byteOffset, values) =>
    Float32Array.from(new Uint8Array(row, byteOffset, values), (v) => v / 255),
  rgba16float: (row, byteOffset, values) =>
    Float32Array.from(new Uint16Array(row, byteOffset, values), fromHalfBits),
  rgba32float: (row, byteOffset, values) => new Float32Array(row, byteOffset, values),
};

/** Copies a texture in one of the `ColorTarget` formats to the CPU. */
export async function readTexture(device: GPUDevice, texture: GPUTexture): Promise<TextureImage> {
  const { width, height, format } = texture;
  const decode = DECODERS[format];
  if (!decode) throw new RangeError(`Textures of ${format} cannot be read back.`);
  const bytesPerPixel = format === 'rgba8unorm' ? 4 : format === 'rgba16float' ? 8 : 16;
  const bytesPerRow = roundUp(width * bytesPerPixel, 256);
  const buffer = device.createBuffer({
    label: 'read-back',
    size: bytesPerRow * height,
    usage: GPUBufferUsage.COPY_DST | GPUBufferUsage.MAP_READ,
  });
  const encoder = device.createCommandEncoder();
  encoder.copyTextureToBuffer({ texture }, { buffer, bytesPerRow }, { width, height });
  device.queue.submit([encoder.finish()]);
  await buffer.mapAsync(GPUMapMode.READ);
  const contents = buffer.getMappedRange();
  const data = new Float32Array(4 * width * height);
  for (let row = 0; row < height; row++)
    data.set(decode(contents, row * bytesPerRow, 4 * width), row * 4 * width);
  buffer.unmap();
  buffer.destroy();
  return { widthPx: width, heightPx: height, data };
}
