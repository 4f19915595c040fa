import { isDeepStrictEqual } from 'node:util';
import type { Page } from 'playwright-core';

/** Long enough for requests of one of a page's frames to be drawn in the next ones. */
const QUIET_TURNS = 15;

/** Lets `page` run for `turns` animation frames, whether or not it draws in them. */
export async function passTurns(page: Page, turns = QUIET_TURNS): Promise<void> {
  // Unlike `evaluate`, it gives up where a page hangs.
  await page.waitForFunction(
    (count) =>
      new Promise<boolean>((resolve) => {
        const next = (left: number) => {
          if (left === 0) resolve(true);
          else requestAnimationFrame(() => next(left - 1));
        };
        next(count);
      }),
    turns,
  );
}

/** Waits until `read` gives the same before and after 15 animation frames of `page`; returns it. */
export async function atRest<T>(page: Page, read: () => Promise<T>): Promise<T> {
  for (;;) {
    const before = await read();
    await passTurns(page);
    if (isDeepStrictEqual(await read(), before)) return before;
  }
}
