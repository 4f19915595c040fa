/** An image as `ImageData` holds it. */
export interface LayerImage {
  readonly widthPx: number;
  readonly heightPx: number;
  readonly data: Uint8ClampedArray<ArrayBuffer>;
}
