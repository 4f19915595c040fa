import type { Page } from 'playwright-core';

/** What the viewer writes on its canvas when it has come to rest (`data-camera`). */
export interface DrawnCamera {
  readonly viewMatrix: number[];
  readonly projectionMatrix: number[];
  readonly near: number;
  readonly far: number;
  /** Of each cloud; null for the identity. */
  readonly modelMatrices: (number[] | null)[];
  readonly background: [number, number, number];
}

export interface Screenshot {
  readonly widthPx: number;
  readonly heightPx: number;
  /** RGBA, top row first. */
  readonly data: Uint8Array;
}

/** Waits until the viewer is in `state` (`data-state` of the document), for a minute at most: SwiftShader is slow. */
export async function waitForState(page: Page, state: string): Promise<void> {
  await page.waitForSelector(`html[data-state="${state}"]`, { timeout: 60_000 });
}

export function frameCount(page: Page): Promise<number> {
  return page.getByTestId('viewport').evaluate((canvas) => Number(canvas.dataset.frames ?? 0));
}

/** Waits until the viewer has drawn more than `frames` pictures and has come to rest. */
export async function waitForFrameAfter(page: Page, frames: number): Promise<void> {
  await page.waitForFunction(
    (least) => Number(document.querySelector('canvas')?.dataset.frames ?? 0) > least,
    frames,
    { timeout: 60_000 },
  );
}

/** Waits for the first picture. */
export async function waitForPicture(page: Page): Promise<void> {
  await waitForState(page, 'ready');
  await waitForFrameAfter(page, 0);
}

export async function textOf(page: Page, testId: string): Promise<string> {
  return (await page.getByTestId(testId).textContent()) ?? '';
}

export function drawnCamera(page: Page): Promise<DrawnCamera> {
  return page.getByTestId('viewport').evaluate((canvas) => JSON.parse(canvas.dataset.camera ?? 'null'));
}

/** The picture as it is on the screen, without the interface over it. */
export async function screenshot(page: Page): Promise<Screenshot> {
  const style =
    '.overlay, .drop-overlay { visibility: hidden !important; } canvas { outline: none !important; }';
  const png = await page.screenshot({ style });
  // The browser decodes its own PNG, so that this needs no library.
  const { widthPx, heightPx, base64 } = await page.evaluate(async (encoded) => {
    const response = await fetch(`data:image/png;base64,${encoded}`);
    const bitmap = await createImageBitmap(await response.blob());
    const canvas = new OffscreenCanvas(bitmap.width, bitmap.height);
    const context = canvas.getContext('2d', { willReadFrequently: true });
    if (!context) throw new Error('no 2D context');
    context.drawImage(bitmap, 0, 0);
    const { data } = context.getImageData(0, 0, bitmap.width, bitmap.height);
    let binary = '';
    for (let i = 0; i < data.length; i += 8192) binary += String.fromCharCode(...data.subarray(i, i + 8192));
    return { widthPx: bitmap.width, heightPx: bitmap.height, base64: btoa(binary) };
  }, png.toString('base64'));
  return { widthPx, heightPx, data: new Uint8Array(Buffer.from(base64, 'base64')) };
}

/** Part of the pixels of which a channel differs by more than `tolerance` of 255. */
export function changedPart(a: Screenshot, b: Screenshot, tolerance = 8): number {
  if (a.data.length !== b.data.length) throw new RangeError('The screenshots differ in size.');
  let changed = 0;
  for (let i = 0; i < a.data.length; i += 4) {
    const difference = Math.max(...[0, 1, 2].map((c) => Math.abs(a.data[i + c] - b.data[i + c])));
    if (difference > tolerance) changed++;
  }
  return changed / (a.data.length / 4);
}

export interface DroppedFile {
  readonly name: string;
  readonly bytes: Uint8Array;
}

/** Drags `files` in over the canvas, lets `whileHovering` look, and drops them. */
export async function dropFiles(
  page: Page,
  files: readonly DroppedFile[],
  whileHovering: () => Promise<void> = async () => {},
): Promise<void> {
  const encoded = files.map(({ name, bytes }) => ({ name, base64: Buffer.from(bytes).toString('base64') }));
  const transfer = await page.evaluateHandle((list) => {
    const dataTransfer = new DataTransfer();
    for (const { name, base64 } of list) {
      const bytes = Uint8Array.from(atob(base64), (character) => character.charCodeAt(0));
      dataTransfer.items.add(new File([bytes], name));
    }
    return dataTransfer;
  }, encoded);
  const canvas = page.getByTestId('viewport');
  await canvas.dispatchEvent('dragenter', { dataTransfer: transfer });
  await canvas.dispatchEvent('dragover', { dataTransfer: transfer });
  await whileHovering();
  await canvas.dispatchEvent('drop', { dataTransfer: transfer });
}
