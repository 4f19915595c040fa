import type { ImagePixels } from '../data/editing/splats-from-image.ts';

/** Colours that the fake context can read, by name. */
const COLORS: Readonly<Record<string, readonly [number, number, number]>> = {
  '#000': [0, 0, 0],
  '#fff': [255, 255, 255],
  white: [255, 255, 255],
  orange: [255, 165, 0],
};

/** An image that a `FakeCanvas` can draw. */
export interface DrawableImage {
  readonly width: number;
  readonly height: number;
  readonly pixels: Uint8ClampedArray;
}

/**
 * An OffscreenCanvas for tests in Node. Of a font it knows the size: each letter is a box half as wide
 * and three quarters as high as that, above the baseline, and a space is as wide. Edges fall on pixels
 * if the size is a multiple of 4.
 */
export class FakeCanvas {
  readonly width: number;
  readonly height: number;

  constructor(width: number, height: number) {
    this.width = width;
    this.height = height;
  }

  getContext() {
    const { width, height } = this;
    const data = new Uint8ClampedArray(4 * width * height);
    let [font, fillStyle] = ['10px sans-serif', '#000'];
    const sizePx = () => Number.parseFloat(/([\d.]+)px/.exec(font)![1]);
    return {
      get font() {
        return font;
      },
      set font(given: string) {
        if (/^\S+ [\d.]+px [\w", -]+$|^[\d.]+px serif$/.test(given)) font = given;
      },
      get fillStyle() {
        return fillStyle;
      },
      set fillStyle(given: string) {
        if (Object.hasOwn(COLORS, given)) fillStyle = given;
      },
      measureText(text: string) {
        const trimmed = text.trim();
        const advance = sizePx() / 2;
        return {
          width: text.length * advance,
          actualBoundingBoxLeft: trimmed ? -advance * text.indexOf(trimmed) : 0,
          actualBoundingBoxRight: trimmed ? advance * text.trimEnd().length : 0,
          actualBoundingBoxAscent: trimmed ? 0.75 * sizePx() : 0,
          actualBoundingBoxDescent: 0,
        };
      },
      fillText(text: string, left: number, baseline: number) {
        const advance = sizePx() / 2;
        for (const [i, letter] of [...text].entries()) {
          if (letter === ' ') continue;
          for (let y = baseline - 0.75 * sizePx(); y < baseline; y++)
            for (let x = left + i * advance; x < left + (i + 1) * advance; x++)
              data.set([...COLORS[fillStyle], 255], 4 * (y * width + x));
        }
      },
      drawImage({ pixels }: DrawableImage) {
        data.set(pixels);
      },
      getImageData: (): ImagePixels => ({ width, height, data, colorSpace: 'srgb' }),
    };
  }
}
