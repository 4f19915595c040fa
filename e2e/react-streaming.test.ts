import { encodePly, type SplatSet } from '@websplatter/core';
import { writeSplats } from '@websplatter/core/write';
import type { Page } from 'playwright-core';
import { beforeEach, expect, it } from 'vitest';
import { streamedSog, streamedSogFiles } from '../packages/core/src/testing/streamed-sog-fixture.ts';
import { atRest } from './at-rest.ts';
import { appHarness } from './harness.ts';
import { logOf, streamsOf, waitForLog } from './page-log.ts';
import type { CanvasDescription, SplatsDescription } from './react/main.tsx';
import { psnrAgainstReference } from './reference.ts';
import { changedPart, colorsIn, screenshot } from './screenshot.ts';
import { testScene } from './test-scene.ts';
import type { DrawnCamera } from './viewer-page.ts';

/** More than a budget of a few bricks holds. */
const scene: SplatSet = testScene(40_000);
const city = await writeSplats(scene, 'bricks');
const plazaScene: SplatSet = testScene(12_000);
const plaza = await streamedSog({ set: plazaScene, filesOfLevel: [4, 2, 1], leafCount: 8 });
const harness = appHarness('e2e/react', {
  ...streamedSogFiles(plaza, 'plaza/'),
  ...streamedSogFiles(plaza, 'market/'),
  'city.bricks': city,
  'town.bricks': city,
  'a.ply': encodePly(testScene()),
});

/** Room for all of the scene, and for a part of it: a brick takes 426 kB or less. */
const ROOM_BYTES = 1e8;
const LITTLE_ROOM_BYTES = 4e6;

beforeEach(() => {
  harness.server.answerParts('send');
  harness.server.answerFiles('send', /^/);
});

const LOGGED = { hasErrors: true, hasComplete: true } as const;
const CITY: SplatsDescription = { id: 'city', src: 'city.bricks', budgetBytes: ROOM_BYTES, ...LOGGED };

/** For images that are compared pixel by pixel: their rasteriser must not follow from times. */
const BY_TILES = { rasterizer: 'tiles' } as const;

/** Streamed SOGs side by side, without budgets of their own. */
const PLAZA: SplatsDescription = { id: 'plaza', src: 'plaza/lod-meta.json', ...LOGGED };
const MARKET: SplatsDescription = {
  id: 'market',
  src: 'market/lod-meta.json',
  position: [0, -2, 0],
  ...LOGGED,
};
/** Together: room for the coarsest level of each leaf of both, and for some finer ones. */
const SHARED_BYTES = 2e6;

const show = (page: Page, changes: Partial<CanvasDescription> = {}) =>
  page.evaluate((described) => window.page.show([described]), {
    id: 'canvas',
    kind: 'splats',
    frameloop: 'demand',
    background: 'black',
    hasStreams: true,
    splats: [CITY],
    ...changes,
  } as const);

async function open(changes?: Partial<CanvasDescription>): Promise<Page> {
  const page = await harness.openShared('');
  await page.waitForFunction(() => 'page' in window);
  await show(page, changes);
  return page;
}

async function drawnCamera(page: Page): Promise<DrawnCamera> {
  const camera = await page.evaluate(() => {
    const { matrixWorldInverse, projectionMatrix, near, far } = window.page.canvases.get('canvas')!.camera;
    const [viewMatrix, projection] = [matrixWorldInverse.elements, projectionMatrix.elements];
    return { viewMatrix, projectionMatrix: projection, near, far, modelMatrices: [null] };
  });
  return { ...camera, background: [0, 0, 0] };
}

const image = (page: Page) => screenshot(page.getByTestId('canvas'));
const resourcesOf = (page: Page) =>
  page.evaluate(() => ({
    ...window.page.countResources(),
    engineBytes: window.page.engine('canvas').memory().totalBytes,
  }));
it('shows the coarsest part of a scene first, then what the view needs, and tells when that is there', async () => {
  harness.server.answerParts('hold');
  const page = await open({ detail: { maxErrorPx: 1 } });
  await waitForLog(page, 'city firstframe');
  const log = await logOf(page);
  expect(log.indexOf('canvas resumed')).toBeGreaterThan(log.indexOf('canvas suspended'));
  expect(log).not.toContain('city complete');
  // The first request brings two bricks.
  await expect.poll(() => streamsOf(page)).toMatchObject([{ residentBricks: 2, isComplete: false }]);
  const first = await image(page);
  expect(changedPart(first, await image(page))).toBe(0);
  harness.server.answerParts('send');
  await waitForLog(page, 'city complete');
  expect(changedPart(first, await image(page))).toBeGreaterThan(0.01);
  await expect.poll(() => streamsOf(page)).toMatchObject([{ isComplete: true, fetching: 0, error: null }]);
  const [coarse] = (await streamsOf(page))!;

  // Another look, or a finer one, may need more: it is complete once more then.
  harness.server.answerParts('hold');
  await show(page, { detail: 'full' });
  await expect.poll(() => streamsOf(page)).toMatchObject([{ isComplete: false }]);
  expect((await logOf(page)).filter((entry) => entry === 'city complete')).toHaveLength(1);
  harness.server.answerParts('send');
  await waitForLog(page, 'city complete', 2);
  await expect.poll(() => streamsOf(page)).toMatchObject([{ isComplete: true, missingBricks: 0 }]);
  const [all] = (await streamsOf(page))!;
  expect(all.residentBricks).toBe(all.bricks);
  expect(all.fetchedBytes).toBeGreaterThan(coarse.fetchedBytes);
  const drawn = await drawnCamera(page);
  const shot = await atRest(page, () => image(page));
  // Files in bricks round more than other files do.
  expect(psnrAgainstReference(shot, drawn, [scene])).toBeGreaterThan(40);
});

it('keeps what is there where parts cannot be fetched, and goes on when told to', async () => {
  harness.server.answerParts('refuse');
  harness.expectProblem(/403/);
  const page = await open();
  await waitForLog(page, 'city error SplatsStreamError');
  await expect.poll(() => streamsOf(page)).toMatchObject([{ error: 'SplatSourceError', residentBricks: 2 }]);
  const coarse = await atRest(page, () => image(page));
  expect(await logOf(page)).not.toContain('city complete');
  harness.server.answerParts('send');
  await page.evaluate(() => window.page.streamError!.retry());
  await waitForLog(page, 'city complete');
  expect(changedPart(coarse, await image(page))).toBeGreaterThan(0.01);
  await expect.poll(() => streamsOf(page)).toMatchObject([{ error: null, missingBricks: 0 }]);

  // Where nothing is there, the load itself fails.
  harness.server.answerParts('refuse', 0);
  await show(page, { splats: [{ ...CITY, id: 'town', src: 'town.bricks' }] });
  await waitForLog(page, 'town error SplatSourceError');
});

it('leaves nothing behind where it is unmounted while parts are read', async () => {
  const page = await open({ splats: [{ id: 'a', src: 'a.ply' }] });
  await waitForLog(page, 'a firstframe');
  let mounts = 0;
  /** @param from byte from which parts are held: 0 for the header, 1 for bricks. */
  const mountAndUnmount = async (from: 0 | 1) => {
    harness.server.answerParts('hold', from);
    const id = `city${++mounts}`;
    await show(page, { splats: [{ ...CITY, id }] });
    if (from === 1) await waitForLog(page, `${id} firstframe`);
    await expect.poll(() => harness.server.heldParts()).toBeGreaterThan(0);
    await show(page, { splats: [] });
    await expect.poll(() => harness.server.heldParts()).toBe(0);
    await expect.poll(() => resourcesOf(page)).toMatchObject({ engineBytes: 0, workers: 0 });
    await expect.poll(() => page.evaluate(() => window.page.engine('canvas').clouds.length)).toBe(0);
  };
  // The first mount makes what all others share.
  await mountAndUnmount(1);
  const before = await atRest(page, () => resourcesOf(page));
  for (const from of [0, 1, 0, 1] as const) await mountAndUnmount(from);
  await expect.poll(() => resourcesOf(page)).toEqual(before);
});

it('keeps each of two scenes within its budget, and frees it with the last of its users', async () => {
  const little = { ...CITY, budgetBytes: LITTLE_ROOM_BYTES };
  const town: SplatsDescription = { ...CITY, id: 'town', src: 'town.bricks', position: [0, -2, 0] };
  const page = await open({ splats: [little, town] });
  await waitForLog(page, 'city complete');
  await waitForLog(page, 'town complete');
  /** Bytes of each cloud on the GPU, by name. */
  const memory = () =>
    page.evaluate(() => {
      const { clouds } = window.page.engine('canvas').memory().scene;
      return Object.fromEntries(clouds.map(({ name, totalBytes }) => [name.slice(-11), totalBytes]));
    });
  const bytes = await memory();
  expect(bytes['city.bricks']).toBeLessThanOrEqual(LITTLE_ROOM_BYTES);
  expect(bytes['town.bricks']).toBeGreaterThan(LITTLE_ROOM_BYTES);
  expect(bytes['town.bricks']).toBeLessThanOrEqual(ROOM_BYTES);
  const ofStreams = async () => (await streamsOf(page))!.toSorted((a, b) => a.name.localeCompare(b.name));
  await expect.poll(ofStreams).toMatchObject([{ isComplete: true }, { isComplete: true }]);
  const [first, second] = await ofStreams();
  expect(first.residentBricks).toBeLessThanOrEqual(first.mostBricks);
  expect(first.refusedBricks).toBeGreaterThan(0);
  expect(second).toMatchObject({ missingBricks: 0, residentBricks: second.bricks });
  await show(page, { splats: [little] });
  await expect.poll(memory).toEqual({ 'city.bricks': bytes['city.bricks'] });
  await show(page, { splats: [] });
  await expect.poll(memory).toEqual({});
  await expect.poll(() => resourcesOf(page)).toMatchObject({ engineBytes: 0 });
});

it('shows a streamed SOG by its address, within its budget, and tells when that is all there', async () => {
  // The first file of the finest level tells how many harmonics there are.
  const { lods } = plaza.meta.tree.children[1].children.at(-1);
  const ofCoarsest = plaza.meta.filenames[lods[2].file];
  const ofFinest = plaza.meta.filenames[lods[0].file];
  const src = 'plaza/lod-meta.json';
  const requestsOf = (file: string) => harness.server.requests(`plaza/${file}`);
  const [coarsestBefore, finestBefore] = [ofCoarsest, ofFinest].map(requestsOf);
  const page = await open({ splats: [{ ...CITY, id: 'plaza', src }], detail: { maxErrorPx: 1000 } });
  await waitForLog(page, 'plaza complete');
  const log = await logOf(page);
  expect(log.indexOf('canvas resumed')).toBeGreaterThan(log.indexOf('canvas suspended'));
  expect(requestsOf(ofCoarsest)).toBe(coarsestBefore + 1);
  expect(requestsOf(ofFinest)).toBe(finestBefore);
  const coarse = await atRest(page, () => image(page));
  const [few] = (await streamsOf(page))!;
  expect(few.residentBricks).toBeLessThan(0.3 * few.bricks);

  await show(page, { splats: [{ ...CITY, id: 'plaza', src }], detail: 'full' });
  await waitForLog(page, 'plaza complete', 2);
  await expect
    .poll(() => streamsOf(page))
    .toMatchObject([{ isComplete: true, missingBricks: 0, error: null }]);
  expect(requestsOf(ofFinest)).toBe(finestBefore + 1);
  const fine = await atRest(page, () => image(page));
  const psnrOf = async (shot: typeof fine) =>
    psnrAgainstReference(shot, await drawnCamera(page), [plazaScene]);
  expect(await psnrOf(fine)).toBeGreaterThan(35);
  expect(await psnrOf(coarse)).toBeLessThan(30);

  // Room for the coarsest level of each leaf, and for some finer ones.
  const budgetBytes = 1_000_000;
  await show(page, {
    splats: [{ ...CITY, id: 'little', src: `${src}?little`, budgetBytes }],
    detail: 'full',
  });
  await waitForLog(page, 'little complete');
  await expect.poll(() => streamsOf(page)).toMatchObject([{ isComplete: true }]);
  const [{ refusedBricks }] = (await streamsOf(page))!;
  expect(refusedBricks).toBeGreaterThan(0);
  const bytes = await page.evaluate(() => window.page.engine('canvas').memory().scene.totalBytes);
  expect(bytes).toBeLessThanOrEqual(budgetBytes);
});

/** How often the page has logged `entry`. */
const timesLogged = async (page: Page, entry: string) =>
  (await logOf(page)).filter((each) => each === entry).length;

/** Reports of the streamed SOGs in the page, by folder. */
const sogsOf = async (page: Page) =>
  Object.fromEntries((await streamsOf(page))!.map((report) => [folderOf(report.name), report]));

/** Bytes of each streamed SOG on the GPU, by folder. */
async function bytesOf(page: Page): Promise<Record<string, number>> {
  const { clouds } = await page.evaluate(() => window.page.engine('canvas').memory().scene);
  return Object.fromEntries(clouds.map(({ name, totalBytes }) => [folderOf(name), totalBytes]));
}

/**
 * One image of each file of all levels but the coarsest. If more requests were held, they would take
 * all six connections of Chromium to a server.
 */
const finerLevelsOf = (folder: string) => new RegExp(`^${folder}/[01]_./means_l[.]webp$`);

const folderOf = (name: string) => name.split('/').at(-2)!;

it('shows the fallback until the coarsest level of a streamed SOG is there, and is complete with all others', async () => {
  harness.server.answerFiles('hold', /^plaza\/.*\.webp$/);
  const page = await open({ splats: [{ ...PLAZA, budgetBytes: ROOM_BYTES }] });
  await expect.poll(() => harness.server.heldParts()).toBeGreaterThan(0);
  const fallbacks = async () =>
    (await timesLogged(page, 'canvas suspended')) - (await timesLogged(page, 'canvas resumed'));
  expect(await atRest(page, fallbacks)).toBe(1);
  expect(colorsIn(await image(page))).toBe(1);

  harness.server.answerFiles('hold', finerLevelsOf('plaza'));
  await waitForLog(page, 'plaza firstframe');
  await expect.poll(() => harness.server.heldParts()).toBeGreaterThan(0);
  expect(await fallbacks()).toBe(0);
  await expect.poll(() => sogsOf(page)).toMatchObject({ plaza: { isComplete: false } });
  const coarse = await atRest(page, () => image(page));
  expect(colorsIn(coarse)).toBeGreaterThan(100);
  expect(await logOf(page)).not.toContain('plaza complete');

  harness.server.answerFiles('send', /^/);
  await waitForLog(page, 'plaza complete');
  await expect.poll(() => sogsOf(page)).toMatchObject({ plaza: { isComplete: true, missingBricks: 0 } });
  expect(changedPart(coarse, await atRest(page, () => image(page)))).toBeGreaterThan(0.01);
  expect(await timesLogged(page, 'plaza complete')).toBe(1);
});

it('draws two streamed SOGs that share a budget as the engine alone does', async () => {
  const splats = [PLAZA, MARKET];
  const page = await open({ splats, streamBudgetBytes: SHARED_BYTES, accuracy: BY_TILES });
  for (const { id } of splats) await waitForLog(page, `${id} complete`);
  const isComplete = { isComplete: true, error: null };
  await expect.poll(() => sogsOf(page)).toMatchObject({ plaza: isComplete, market: isComplete });
  const shot = await atRest(page, () => image(page));
  const bytes = await bytesOf(page);
  for (const [folder, report] of Object.entries(await sogsOf(page))) {
    expect(bytes[folder]).toBeLessThanOrEqual(SHARED_BYTES / 2);
    expect(report.residentBricks).toBeLessThanOrEqual(report.mostBricks);
    expect(report.refusedBricks).toBeGreaterThan(0);
  }
  const options = { streamBudgetBytes: SHARED_BYTES, accuracy: BY_TILES };
  const data = await page.evaluate(
    ([scenes, drawnWith]) => window.page.drawnByEngine('canvas', scenes, drawnWith),
    [splats.map(({ src, position }) => ({ src, position })), options] as const,
  );
  const drawnAlone = { ...shot, data: Buffer.from(data) };
  // Rounding to 8 bits may differ between the canvas and the engine's floats.
  expect(changedPart(shot, drawnAlone, 1)).toBe(0);
});

it('gives the room of a streamed SOG that is unmounted to the other, and ends its requests', async () => {
  const drawnWith = { streamBudgetBytes: SHARED_BYTES, accuracy: BY_TILES };
  const page = await open({ splats: [PLAZA], ...drawnWith });
  await waitForLog(page, 'plaza complete');
  const all = { isComplete: true, missingBricks: 0, refusedBricks: 0 };
  await expect.poll(() => sogsOf(page)).toMatchObject({ plaza: all });
  const alone = await atRest(page, () => image(page));
  const { mostBricks, residentBricks } = (await sogsOf(page)).plaza;

  harness.server.answerFiles('hold', finerLevelsOf('market'));
  await show(page, { splats: [PLAZA, MARKET], ...drawnWith });
  await waitForLog(page, 'market firstframe');
  await expect.poll(() => harness.server.heldParts()).toBeGreaterThan(0);
  await expect.poll(async () => (await sogsOf(page)).plaza.mostBricks).toBeLessThan(mostBricks);
  await expect.poll(() => sogsOf(page)).toMatchObject({ plaza: { isComplete: true } });
  const { plaza: shared } = await sogsOf(page);
  expect(shared.residentBricks).toBeLessThan(residentBricks);
  expect((await bytesOf(page)).plaza).toBeLessThanOrEqual(SHARED_BYTES / 2);

  await show(page, { splats: [PLAZA], ...drawnWith });
  await expect.poll(() => harness.server.heldParts()).toBe(0);
  await expect.poll(() => sogsOf(page)).toMatchObject({ plaza: { ...all, mostBricks, residentBricks } });
  expect(changedPart(alone, await atRest(page, () => image(page)), 0)).toBe(0);
  expect(Object.keys(await bytesOf(page))).toEqual(['plaza']);
  expect(await logOf(page)).not.toContain('market complete');
});

it('reports what the server refuses of a streamed SOG, and shows the other as if it were alone', async () => {
  const page = await open({ splats: [PLAZA] });
  await waitForLog(page, 'plaza complete');
  harness.server.answerFiles('refuse', finerLevelsOf('market'));
  await show(page, { splats: [PLAZA, MARKET] });
  await waitForLog(page, 'market error SplatsStreamError');
  // A refusal that arrives after the retry would be another error.
  await expect
    .poll(() => sogsOf(page))
    .toMatchObject({
      plaza: { isComplete: true, missingBricks: 0, error: null },
      market: { isComplete: false, error: 'SplatSourceError', fetching: 0 },
    });
  expect(await logOf(page)).not.toContain('market complete');
  expect(await logOf(page)).not.toContain('plaza error SplatsStreamError');

  harness.server.answerFiles('send', /^/);
  await page.evaluate(() => window.page.streamError!.retry());
  await waitForLog(page, 'market complete');
  await expect.poll(() => sogsOf(page)).toMatchObject({ market: { missingBricks: 0, error: null } });
});
