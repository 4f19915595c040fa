import type { Locator, Page } from 'playwright-core';

export interface Screenshot {
  readonly widthPx: number;
  readonly heightPx: number;
  /** RGBA, top row first. */
  readonly data: Uint8Array;
}

/**
 * Captures a page, or an element of it, as shown on the screen; `style` (CSS) may hide parts. Adopted style sheets and the
 * caret as it is, because a strict content security policy blocks the style elements that Playwright would write.
 */
export async function screenshot(shown: Page | Locator, style = ''): Promise<Screenshot> {
  const page = 'page' in shown ? shown.page() : shown;
  const added = await page.evaluateHandle((css) => {
    const sheet = new CSSStyleSheet();
    sheet.replaceSync(css);
    document.adoptedStyleSheets.push(sheet);
    return sheet;
  }, style);
  const png = await shown.screenshot({ caret: 'initial' });
  await added.evaluate((sheet) => {
    const sheets = document.adoptedStyleSheets;
    sheets.splice(sheets.indexOf(sheet), 1);
  });
  return decodePng(png.toString('base64'), (decode, encoded) => page.evaluate(decode, encoded));
}

interface Decoded {
  readonly widthPx: number;
  readonly heightPx: number;
  readonly base64: string;
}

/**
 * Decodes a PNG by the browser that has made it, which needs no library.
 *
 * @param png the file in base64.
 * @param inPage evaluates a function of one argument in a page.
 */
export async function decodePng(
  png: string,
  inPage: (decode: (png: string) => Promise<Decoded>, png: string) => Promise<Decoded>,
): Promise<Screenshot> {
  const { widthPx, heightPx, base64 } = await inPage(async (encoded) => {
    const bytes = Uint8Array.from(atob(encoded), (character) => character.charCodeAt(0));
    const bitmap = await createImageBitmap(new Blob([bytes]));
    const canvas = new OffscreenCanvas(bitmap.width, bitmap.height);
    const context = canvas.getContext('2d', { willReadFrequently: true });
    if (!context) throw new Error('no 2D context');
    context.drawImage(bitmap, 0, 0);
    const { data } = context.getImageData(0, 0, bitmap.width, bitmap.height);
    let binary = '';
    for (let i = 0; i < data.length; i += 8192) binary += String.fromCharCode(...data.subarray(i, i + 8192));
    return { widthPx: bitmap.width, heightPx: bitmap.height, base64: btoa(binary) };
  }, png);
  return { widthPx, heightPx, data: new Uint8Array(Buffer.from(base64, 'base64')) };
}

/** Share of the pixels with a channel that differs by more than `tolerance` of 255. */
export function changedPart(a: Screenshot, b: Screenshot, tolerance = 8): number {
  if (a.data.length !== b.data.length) throw new RangeError('The screenshots differ in size.');
  let changed = 0;
  for (let i = 0; i < a.data.length; i += 4) {
    const difference = Math.max(...[0, 1, 2].map((c) => Math.abs(a.data[i + c] - b.data[i + c])));
    if (difference > tolerance) changed++;
  }
  return changed / (a.data.length / 4);
}

/** Number of different colours. */
export function colorsIn({ data }: Screenshot): number {
  const colors = new Set<number>();
  for (let i = 0; i < data.length; i += 4) colors.add((data[i] << 16) | (data[i + 1] << 8) | data[i + 2]);
  return colors.size;
}
