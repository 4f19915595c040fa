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
import { changedPart, screenshot } from './screenshot.ts';
import { testScene } from './test-scene.ts';
import type { DrawnCamera } from './viewer-page.ts';

/** More than a budget of a few bricks holds. */
const scene: SplatSet = testScene(40_000);
const city = await writeSplats(scene, 'bricks');
const plazaScene: SplatSet = testScene(12_000);
const plaza = await streamedSog({ set: plazaScene, filesOfLevel: [4, 2, 1], leafCount: 8 });
const harness = appHarness('e2e/react', {
  ...streamedSogFiles(plaza, 'plaza/'),
  'city.bricks': city,
  'town.bricks': city,
  'a.ply': encodePly(testScene()),
});

/** Room for all of the scene, and for a part of it: a brick takes 426 kB or less. */
const ROOM_BYTES = 1e8;
const LITTLE_ROOM_BYTES = 4e6;

beforeEach(() => harness.server.answerParts('send'));

const CITY: SplatsDescription = { id: 'city', src: 'city.bricks', budgetBytes: ROOM_BYTES, hasErrors: true };

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
  const page = await harness.open('');
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
  const page = await open({ detail: { maxErrorPx: 2 } });
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
  const page = await open({ splats: [{ ...CITY, id: 'plaza', src }], detail: { maxErrorPx: 1000 } });
  await waitForLog(page, 'plaza complete');
  const log = await logOf(page);
  expect(log.indexOf('canvas resumed')).toBeGreaterThan(log.indexOf('canvas suspended'));
  expect(harness.server.requests(`plaza/${ofCoarsest}`)).toBe(1);
  expect(harness.server.requests(`plaza/${ofFinest}`)).toBe(0);
  const coarse = await atRest(page, () => image(page));
  const [few] = (await streamsOf(page))!;
  expect(few.residentBricks).toBeLessThan(0.3 * few.bricks);

  await show(page, { splats: [{ ...CITY, id: 'plaza', src }], detail: 'full' });
  await waitForLog(page, 'plaza complete', 2);
  await expect
    .poll(() => streamsOf(page))
    .toMatchObject([{ isComplete: true, missingBricks: 0, error: null }]);
  expect(harness.server.requests(`plaza/${ofFinest}`)).toBe(1);
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
