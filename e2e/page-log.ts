import type { Page } from 'playwright-core';

/** The log of a page of `e2e/react`. */
export const logOf = (page: Page) => page.evaluate(() => window.page.log);

/** Waits until the page has logged `entry`, `times` times. */
export async function waitForLog(page: Page, entry: string, times = 1): Promise<void> {
  await page
    .waitForFunction(([text, least]) => window.page.log.filter((each) => each === text).length >= least, [
      entry,
      times,
    ] as const)
    .catch(async (cause) => {
      const found = JSON.stringify([await logOf(page), await streamsOf(page)]);
      throw new Error(`No "${entry}" among ${found}`, { cause });
    });
}

/** Reports of the streams in the page's Canvas; undefined unless it has `hasStreams`. */
export const streamsOf = (page: Page) =>
  page.evaluate(() =>
    window.page.streams?.map(({ stream: _, error, ...report }) => ({
      ...report,
      error: error?.name ?? null,
    })),
  );
