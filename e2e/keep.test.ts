// Proves: scenes on the disk, and streams, of several pages, without a network, without room, and of
// servers without ranges.
import { encodePly } from '@websplatter/core';
import { writeSplats } from '@websplatter/core/write';
import type { Page } from 'playwright-core';
import { describe, expect, it } from 'vitest';
import { appHarness } from './harness.ts';
import type {} from './keep/main.ts';
import { testScene } from './test-scene.ts';

/** Splats of a file that is arranged in several buckets. */
const LARGE = 160_000;
const city = await writeSplats(testScene(40_000), 'bricks');
/** More than the 64 MiB that are fetched whole: a scene, and zeros behind it, which nothing reads. */
const WHOLE_BYTES = 65 << 20;
const long = new Uint8Array(WHOLE_BYTES);
long.set(city);
const harness = appHarness('e2e/keep', {
  'large.ply': encodePly(testScene(LARGE)),
  'small.ply': encodePly(testScene(5000)),
  'city.bricks': city,
  // Of a server that answers requests for a part with all.
  'city.whole': long,
});
/** Bytes that keeping `large.ply` takes, and those that are kept of it. */
const [WORK_BYTES, KEPT_BYTES] = [136 * LARGE, 22 * LARGE];
/** A part of the work after which some of the bricks are made, and one that is done without any. */
const [SOME_BRICKS, LEAST_GONE_ON] = [0.3, 0.25];

async function openIn(page: Page): Promise<Page> {
  await page.goto(harness.server.url);
  await page.waitForFunction(() => 'keeping' in window);
  return page;
}

const open = async () => openIn(await harness.newPage());

/** Keeps a file of the server, as if it were on a disk; returns a hash of its bricks, or the error. */
const keep = (page: Page, path = 'large.ply', lastModified = 1e12) =>
  page.evaluate(
    async ([name, date]) => {
      try {
        const file = await window.keeping.fetchFile(name, date);
        return await window.keeping.hashOf(await window.keeping.keep(file));
      } catch (error) {
        return { ...(error as object) };
      }
    },
    [path, lastModified] as const,
  );
const partsOf = (page: Page) => page.evaluate(() => window.keeping.parts);
const untilSomeBricks = (page: Page) =>
  expect.poll(async () => (await partsOf(page)).at(-1) ?? 0, { interval: 20 }).toBeGreaterThan(SOME_BRICKS);
const kept = (page: Page) =>
  page.evaluate(async () =>
    (await window.keeping.keptScenes()).map(({ fileName, isWhole }) => ({ fileName, isWhole })),
  );
const WHOLE = { fileName: 'large.ply', isWhole: true };
const BEGUN = { ...WHOLE, isWhole: false };

/** Sets the storage of the page's origin, in bytes; without an argument, as the browser has it. */
async function limitStorage(page: Page, quotaSize?: number): Promise<void> {
  const session = await page.context().newCDPSession(page);
  const { origin } = new URL(harness.server.url);
  await session.send('Storage.overrideQuotaForOrigin', { origin, ...(quotaSize && { quotaSize }) });
}

/**
 * @fault Pages and packages: two keep the same file at once, and the one that works is closed
 * @consequence the other goes on where it was; the bricks are those of undisturbed work
 */
it('two pages keep one file: one works, the other waits, and goes on if the first closes', async () => {
  const first = await open();
  const second = await openIn(await harness.newTab(first));
  // The page is closed while it keeps the file.
  void keep(first).catch(() => {});
  await expect.poll(async () => (await partsOf(first)).length).toBeGreaterThan(0);
  const ends = [keep(second), keep(second)];
  await untilSomeBricks(first);
  expect(await partsOf(second)).toEqual([]);
  await first.close();
  const hashes = await Promise.all(ends);
  expect((await partsOf(second))[0]).toBeGreaterThan(LEAST_GONE_ON);
  expect(await kept(second)).toEqual([WHOLE]);
  const undisturbed = await keep(await open());
  expect(undisturbed).toMatch(/^[\da-f,]+$/);
  expect(hashes).toEqual([undisturbed, undisturbed]);
});

it('two engines and two pages show one kept scene, which stays until none of them uses it', async () => {
  const page = await open();
  await keep(page, 'small.ply');
  const other = await openIn(await harness.newTab(page));
  /** Pictures of the kept scene in two engines; null if there is none of the file. */
  const show = (each: Page, path = 'small.ply', lastModified = 1e12) =>
    each.evaluate(
      async ([name, date]) => {
        const bricks = await window.keeping.keptBricks(await window.keeping.fetchFile(name, date));
        if (!bricks) return null;
        const shown = await Promise.all([window.keeping.load(bricks), window.keeping.load(bricks)]);
        return Promise.all(shown.map(window.keeping.picture));
      },
      [path, lastModified] as const,
    );
  const pictures = [...(await show(page))!, ...(await show(other))!];
  expect(new Set(pictures).size).toBe(1);
  // A file that has changed on its server is another scene.
  expect(await show(page, 'small.ply', 2e12)).toBeNull();
  expect(await show(page, 'large.ply')).toBeNull();

  const remove = (each: Page) =>
    each.evaluate(async () => window.keeping.removeKept((await window.keeping.keptScenes())[0]));
  expect(await remove(page)).toBe(false);
  await page.close();
  expect(await remove(other)).toBe(false);
  await openIn(other);
  expect(await remove(other)).toBe(true);
  expect(await kept(other)).toEqual([]);
});

/**
 * @fault Pages and packages: the browser's storage is full before or in the middle of work
 * @consequence `StorageRoomError`; unused scenes are evicted if that helps; work goes on once there is room
 */
it('tells a lack of room at any time, goes on once there is some, and evicts what is not in use', async () => {
  const page = await open();
  const lack = { code: 'no-room', neededBytes: WORK_BYTES, availableBytes: expect.any(Number) };
  const end = keep(page);
  await untilSomeBricks(page);
  await limitStorage(page, 1e6);
  expect(await end).toMatchObject(lack);
  expect(await kept(page)).toEqual([BEGUN]);
  await limitStorage(page);
  await openIn(page);
  const hash = await keep(page);
  expect((await partsOf(page))[0]).toBeGreaterThan(LEAST_GONE_ON);

  // Another file, with this one in use, then without.
  await limitStorage(page, 1000);
  expect(await keep(page, 'large.ply', 2e12)).toMatchObject({ ...lack, availableBytes: 0 });
  await openIn(page);
  const { availableBytes } = (await keep(page, 'large.ply', 2e12)) as { availableBytes: number };
  expect(availableBytes).toBeGreaterThan(0.9 * KEPT_BYTES);
  expect(await kept(page)).toEqual([WHOLE]);
  await limitStorage(page, WORK_BYTES + 0.5 * KEPT_BYTES);
  expect(await keep(page, 'large.ply', 2e12)).toBe(hash);
  expect(await kept(page)).toEqual([WHOLE]);
});

describe('without a network', () => {
  it('a page that is loaded again shows what was kept', async () => {
    const page = await open();
    const show = async () => {
      const bricks = await window.keeping.keptBricks(await window.keeping.fetchFile('small.ply'));
      return bricks && window.keeping.picture(await window.keeping.load(bricks));
    };
    await keep(page, 'small.ply');
    const picture = await page.evaluate(show);
    await page.context().setOffline(true);
    // Takes the place of a service worker that has the page, and of a disk that has the file.
    await page.route(/\/(assets\/.*|small\.ply)?$/, async (route) =>
      route.fulfill({ response: await route.fetch() }),
    );
    await openIn(page);
    harness.expectProblem(/ERR_INTERNET_DISCONNECTED/);
    await expect(page.evaluate(() => window.keeping.fetchFile('large.ply'))).rejects.toThrow(
      'Failed to fetch',
    );
    expect(await page.evaluate(show)).toBe(picture);
    expect(picture).toMatch(/^[\da-f,]+$/);
  });

  it('a stream shows what is there, tells the error, and goes on with the network', async () => {
    harness.expectProblem(/ERR_INTERNET_DISCONNECTED/);
    harness.server.answerParts('hold');
    const page = await open();
    await page.evaluate(async () => {
      window.keeping.shown = await window.keeping.load('city.bricks', { request: { maxRetries: 1 } });
    });
    const report = () => page.evaluate(() => window.keeping.reportOf(window.keeping.shown!));
    await expect.poll(report).toMatchObject({ residentBricks: 2, missingBricks: 10, error: null });
    await expect.poll(() => harness.server.heldParts()).toBeGreaterThan(0);
    const coarse = await page.evaluate(() => window.keeping.pictureNow(window.keeping.shown!));
    await page.context().setOffline(true);
    harness.server.cutHeldParts();
    await expect.poll(report).toMatchObject({ residentBricks: 2, error: 'SplatSourceError', fetching: 0 });
    const look = () => page.evaluate(() => window.keeping.picture(window.keeping.shown!));
    expect(await look()).toBe(coarse);
    harness.server.answerParts('send');
    await page.context().setOffline(false);
    await expect.poll(report).toMatchObject({ residentBricks: 12, missingBricks: 0, error: null });
    const whole = await look();
    expect(whole).not.toBe(coarse);
    const loadWhole = async () =>
      window.keeping.picture(
        await window.keeping.load(await window.keeping.fetchFile('city.bricks'), { name: 'a.bricks' }),
      );
    expect(await page.evaluate(loadWhole)).toBe(whole);
  });
});

it('a file of more than 64 MiB without ranges is refused at once, and streams as a Blob', async () => {
  const page = await open();
  const found = await page.evaluate(async () => {
    const name = 'city.bricks';
    const refused = await window.keeping.load('city.whole', { name }).catch((error: Error) => error);
    const [part, blob] = [await fetch('city.bricks'), await (await fetch('city.whole')).blob()];
    const pictures = [];
    for (const each of [await part.blob(), blob])
      pictures.push(await window.keeping.picture(await window.keeping.load(each, { name })));
    return { message: (refused as Error).message, pictures, blobBytes: blob.size };
  });
  expect(found.message).toMatch(/answered 200 with the whole file, of more than 64 MiB.*websplatter split/);
  expect(found.blobBytes).toBe(WHOLE_BYTES);
  expect(found.pictures[0]).toBe(found.pictures[1]);
  const session = await page.context().newCDPSession(page);
  const { usedSize } = await session.send('Runtime.getHeapUsage');
  expect(usedSize).toBeLessThan(WHOLE_BYTES / 4);
});
