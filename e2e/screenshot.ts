import { setTimeout } from 'node:timers/promises';
import type { CDPSession, Locator, Page } from 'playwright-core';
import { type DecodedImage, decodePng } from './png.ts';

export type Screenshot = DecodedImage;

/**
 * Least time from one picture of a page to the next. Polls that look again at once take
 * the processor from the page, whose next picture they wait for.
 */
const APART_MS = 150;
/** When a page was last captured. */
const capturedMs = new WeakMap<Page, number>();

const sessions = new WeakMap<Page, Promise<CDPSession>>();

function sessionOf(page: Page): Promise<CDPSession> {
  const session = sessions.get(page) ?? page.context().newCDPSession(page);
  sessions.set(page, session);
  return session;
}

/**
 * Captures a page, or an element of it, as shown on the screen; `style` (CSS) may hide parts.
 * Adopted style sheets, because a strict content security policy blocks style elements. Chromium is
 * asked directly: Playwright would have the PNG compressed as well as can be, which takes longer
 * than all else.
 */
export async function screenshot(shown: Page | Locator, style = ''): Promise<Screenshot> {
  const page = 'page' in shown ? shown.page() : shown;
  const session = await sessionOf(page);
  const leftMs = (capturedMs.get(page) ?? 0) + APART_MS - performance.now();
  if (leftMs > 0) await setTimeout(leftMs);
  const added = await page.evaluateHandle((css) => {
    const sheet = new CSSStyleSheet();
    sheet.replaceSync(css);
    document.adoptedStyleSheets.push(sheet);
    return sheet;
  }, style);
  const clip = 'page' in shown ? await shown.evaluate(placeInDocument) : undefined;
  const { data } = await session.send('Page.captureScreenshot', {
    format: 'png',
    optimizeForSpeed: true,
    clip,
  });
  await added.evaluate((sheet) => {
    const sheets = document.adoptedStyleSheets;
    sheets.splice(sheets.indexOf(sheet), 1);
  });
  capturedMs.set(page, performance.now());
  return decodePng(Buffer.from(data, 'base64'));
}

/** Runs in the page: the whole CSS pixels that `element` covers. */
function placeInDocument(element: Element) {
  const { left, top, right, bottom } = element.getBoundingClientRect();
  const [x, y] = [Math.floor(left), Math.floor(top)];
  const size = { width: Math.ceil(right) - x, height: Math.ceil(bottom) - y };
  return { x: x + scrollX, y: y + scrollY, ...size, scale: 1 };
}

/** Share of the pixels with a channel that differs by more than `tolerance` of 255. */
export function changedPart(a: Screenshot, b: Screenshot, tolerance = 8): number {
  if (a.data.length !== b.data.length) throw new RangeError('The screenshots differ in size.');
  let changed = 0;
  for (let i = 0; i < a.data.length; i += 4) {
    const isChannelChanged = (c: number) => Math.abs(a.data[i + c] - b.data[i + c]) > tolerance;
    if (isChannelChanged(0) || isChannelChanged(1) || isChannelChanged(2)) changed++;
  }
  return changed / (a.data.length / 4);
}

/** Number of different colours. */
export function colorsIn({ data }: Screenshot): number {
  const colors = new Set<number>();
  for (let i = 0; i < data.length; i += 4) colors.add((data[i] << 16) | (data[i + 1] << 8) | data[i + 2]);
  return colors.size;
}

/** How near two images of the same size are, in decibels over all three channels. */
export function psnrOf(a: Pick<DecodedImage, 'data'>, b: Pick<DecodedImage, 'data'>): number {
  if (a.data.length !== b.data.length) throw new RangeError('The images differ in size.');
  let sum = 0;
  for (let i = 0; i < a.data.length; i++) sum += i % 4 === 3 ? 0 : ((a.data[i] - b.data[i]) / 255) ** 2;
  return -10 * Math.log10(sum / (0.75 * a.data.length));
}

/** How many pixels differ between two screenshots. */
export function differing(a: { data: Uint8Array }, b: { data: Uint8Array }): number {
  let count = 0;
  for (let i = 0; i < a.data.length; i += 4)
    if (a.data[i] !== b.data[i] || a.data[i + 1] !== b.data[i + 1]) count++;
  return count;
}
