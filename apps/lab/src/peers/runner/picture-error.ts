import { compareImages } from '@websplatter/core/reference';
import type { Picture } from '../page/protocol.ts';

/** PSNR of a picture against a reference of its size, both over black and in 8 bits; dB. */
export function psnrOf({ rgbaBase64, widthPx, heightPx }: Picture, reference: Float64Array): number {
  const actual = Float64Array.from(Buffer.from(rgbaBase64, 'base64'), (value) => value / 255);
  return compareImages(actual, reference, { widthPx, heightPx, quantize: 'png' }).psnrDb;
}
