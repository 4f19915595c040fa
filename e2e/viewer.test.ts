// Proves: opening, loading, dropping, moving, errors, loss of the device, rest.
import { createHash } from 'node:crypto';
import { readFileSync } from 'node:fs';
import { basename, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { gzipSync } from 'node:zlib';
import { encodePly, readSplats } from '@websplatter/core';
import type { Page, Worker } from 'playwright-core';
import { describe, expect, it } from 'vitest';
import { atRest, passTurns } from './at-rest.ts';
import { skipRecoveryWaits } from './recovery-waits.ts';
import { MIN_PSNR_DB, psnrAgainstReference } from './reference.ts';
import { changedPart, colorsIn } from './screenshot.ts';
import { CONTENT_SECURITY_POLICY } from './server.ts';
import { slowScene, testScene } from './test-scene.ts';
import {
  CHEAP,
  CHEAPLY,
  drawnCamera,
  dropFiles,
  frameCount,
  loseDeviceOnDemand,
  openSaveTab,
  press,
  redraw,
  SMALL,
  showFigures,
  textOf,
  type ViewerWindow,
  viewerHarness,
  viewerScreenshot,
  waitForImage,
  waitForNotice,
  waitForScene,
  waitForState,
} from './viewer-page.ts';

/** For images that are compared bit for bit: their rasteriser must not follow from times. */
const BY_TILES =
  '?scene=still-life-small&accuracy=balanced,rasterizer:tiles,resolutionScale:0.25&detail=full';

/** One scene in several formats, written by other programs. */
const FIXTURES = fileURLToPath(new URL('../packages/core/src/testing/fixtures/', import.meta.url));
const fixture = (end: string) => new Uint8Array(readFileSync(`${FIXTURES}degree-2.${end}`));

/** Core as it is shipped. */
const CORE = fileURLToPath(new URL('../packages/core/dist/', import.meta.url));

const harness = viewerHarness();
const { newPage, openViewer, shareViewer } = harness;
/** For scenes whose picture is compared. */
const TINY = { viewport: { width: 160, height: 120 } };

/** Drops a file, and waits until it is shown. */
async function openFile(page: Page, name: string, bytes: Uint8Array): Promise<void> {
  await dropFiles(page, [{ name, bytes }]);
  await waitForScene(page, name);
}

/** Columns of a set whose bits are compared. */
const COLUMNS = ['positions', 'logScales', 'rotations', 'opacityLogits', 'colorDc'] as const;

/** Decodes the images of a SOG in the browser, and in Node by our decoder; values must agree. */
async function expectSameSplats(page: Page, sog: Uint8Array<ArrayBuffer>): Promise<void> {
  await page.route('**/core-dist/*', (route) => {
    const file = basename(new URL(route.request().url()).pathname);
    if (file === 'scene.sog') return route.fulfill({ body: Buffer.from(sog) });
    return route.fulfill({ path: join(CORE, file), contentType: 'text/javascript' });
  });
  await page.evaluate("import('/core-dist/index.js').then((core) => Object.assign(window, { core }))");
  const found = await page.evaluate(async (columns) => {
    let decoded = 0;
    const { decode } = ImageDecoder.prototype;
    ImageDecoder.prototype.decode = function (...options) {
      decoded++;
      return decode.apply(this, options);
    };
    const { core } = window as unknown as { core: { readSplats: typeof readSplats } };
    const set = await core.readSplats('/core-dist/scene.sog', { shPrecision: 'f32' });
    const digests = [...columns.map((name) => set[name]), set.harmonics.words].map(async (column) => {
      const digest = await crypto.subtle.digest('SHA-256', column as Float32Array<ArrayBuffer>);
      return Array.from(new Uint8Array(digest));
    });
    return { decoded, digests: await Promise.all(digests) };
  }, COLUMNS);
  const set = await readSplats(sog, { shPrecision: 'f32' });
  const digests = [...COLUMNS.map((name) => set[name]), set.harmonics.words].map((column) => [
    ...createHash('sha256').update(column).digest(),
  ]);
  // One of them is the decoder's probe.
  expect(found).toEqual({ decoded: 8, digests });
}

/** Waits for the first measurement. A slow frame takes over a second, written with a comma. */
async function waitForTimes(page: Page): Promise<void> {
  await page.waitForFunction(() => {
    const text = document.querySelector('[data-testid=total-ms]')?.textContent ?? '';
    return Number(text.replaceAll(',', '')) > 0;
  });
}

/** The holder of the keyboard; undefined for elements that tests do not know. */
const focusedTestId = (page: Page) =>
  page.evaluate(() => (document.activeElement as HTMLElement | null)?.dataset.testid);

const send = (page: Page, event: string) =>
  page.evaluate((type) => void dispatchEvent(new Event(type)), event);

/** For `addInitScript`: counts the frames that the page requests. */
function countRequestedFrames(): void {
  const request = requestAnimationFrame;
  const counter = window as unknown as { requestedFrames: number };
  counter.requestedFrames = 0;
  window.requestAnimationFrame = (callback) => {
    counter.requestedFrames++;
    return request(callback);
  };
}

/** For `addInitScript`: between `adapters-go` and `adapters-come-back` there is no GPU. */
function loseAdaptersOnDemand(): void {
  const { requestAdapter } = GPU.prototype;
  addEventListener('adapters-go', () => {
    GPU.prototype.requestAdapter = async () => null;
  });
  addEventListener('adapters-come-back', () => {
    GPU.prototype.requestAdapter = requestAdapter;
  });
}

interface HeldGpu {
  readonly heldPipelines: number;
  /** Resolves when the queue has told of all work that it was asked about. */
  readonly releaseWork: () => Promise<unknown>;
  readonly releasePipelines: () => void;
}

/**
 * For `addInitScript`: the queue keeps back that its work is done, and the device its pipelines,
 * until they are released. Workers get their jobs when somebody has begun to wait for the queue.
 */
function holdBackGpu(): void {
  const barrier = () => {
    let open = () => {};
    const opened = new Promise<void>((resolve) => {
      open = resolve;
    });
    return { open, opened };
  };
  const [work, waiting, pipelines] = [barrier(), barrier(), barrier()];
  const asked: Promise<unknown>[] = [];
  let heldPipelines = 0;

  const { onSubmittedWorkDone } = GPUQueue.prototype;
  GPUQueue.prototype.onSubmittedWorkDone = function () {
    const done = work.opened.then(() => onSubmittedWorkDone.apply(this));
    asked.push(done);
    waiting.open();
    return done;
  };
  const { createComputePipelineAsync, createRenderPipelineAsync } = GPUDevice.prototype;
  GPUDevice.prototype.createComputePipelineAsync = function (descriptor) {
    heldPipelines++;
    return pipelines.opened.then(() => createComputePipelineAsync.call(this, descriptor));
  };
  GPUDevice.prototype.createRenderPipelineAsync = function (descriptor) {
    heldPipelines++;
    return pipelines.opened.then(() => createRenderPipelineAsync.call(this, descriptor));
  };
  const { postMessage } = Worker.prototype;
  Worker.prototype.postMessage = function (this: Worker, ...message: unknown[]) {
    void waiting.opened.then(() => Reflect.apply(postMessage, this, message));
  };
  Object.defineProperty(window, 'heldPipelines', { get: () => heldPipelines });
  Object.assign(window, {
    releaseWork: () => {
      work.open();
      return Promise.all(asked);
    },
    releasePipelines: pipelines.open,
  });
}

/**
 * @fault Pages and packages: a strict content security policy
 * @consequence everything works, nothing is blocked
 */
describe('viewer', () => {
  it('opens on its scene, with the figures of each stage', async () => {
    const page = await shareViewer('?scene=still-life-small');
    expect(await page.title()).toContain('Still life');
    const { headers } = await fetch(harness.server.url);
    expect(headers.get('content-security-policy')).toBe(CONTENT_SECURITY_POLICY);
    const shot = await viewerScreenshot(page);
    expect(colorsIn(shot), 'different colours').toBeGreaterThan(500);
    await showFigures(page);
    await waitForTimes(page);
    for (const stage of ['preprocess-ms', 'sort-ms', 'rasterize-ms', 'total-ms']) {
      expect(Number((await textOf(page, stage)).replaceAll(',', '')), stage).toBeGreaterThan(0);
    }
    expect(await textOf(page, 'timing-source')).toBe('GPU timestamps');
    expect(await textOf(page, 'rasterizer')).toMatch(/^(tiles|quads)$/);
    const reason = await textOf(page, 'rasterizer-reason');
    expect(reason).toMatch(/^[A-Z].*(compared|timed|room)/);
    expect(await page.getByTitle(reason).innerText()).toContain('Rasteriser');
    expect(await textOf(page, 'loaded-splats')).toBe('10,000');
    const visible = Number((await textOf(page, 'visible-splats')).replaceAll(',', ''));
    expect(visible).toBeGreaterThan(1000);
    expect(visible).toBeLessThanOrEqual(10_000);
    expect(await textOf(page, 'adapter')).toMatch(/swiftshader/i);
    expect(await textOf(page, 'resolution')).toBe('480 × 320');
  });

  it('counts no frame while the shaders of its first one compile, and asks for none while nothing happens', async () => {
    const page = await newPage(SMALL);
    await page.addInitScript(holdBackGpu);
    await page.addInitScript(countRequestedFrames);
    await page.goto(`${harness.server.url}?scene=still-life-small`);
    // The wait of an empty page goes on until the first frame is requested.
    await page.waitForFunction(() => (window as unknown as HeldGpu).heldPipelines > 0);
    await page.evaluate(() => (window as unknown as HeldGpu).releaseWork());
    expect(await frameCount(page)).toBe(0);
    await page.evaluate(() => (window as unknown as HeldGpu).releasePipelines());
    await waitForImage(page);
    expect(colorsIn(await viewerScreenshot(page)), 'different colours').toBeGreaterThan(500);

    await showFigures(page);
    // The first measurement arrives after the frame, and checks whether there is more to draw.
    await waitForTimes(page);
    const requested = () =>
      page.evaluate(() => (window as unknown as { requestedFrames: number }).requestedFrames);
    expect(await requested()).toBeGreaterThan(0);
    /** Frames that the viewer itself requests in so many turns. */
    const requestedIn = async (turns: number) => {
      const before = await requested();
      await passTurns(page, turns);
      return (await requested()) - before - turns;
    };
    await expect.poll(() => requestedIn(15)).toBe(0);
    const framesBefore = await frameCount(page);
    expect(await requestedIn(60)).toBe(0);
    expect(await frameCount(page)).toBe(framesBefore);
  });

  it('reads files of all formats in workers, frames them in another, and says what splats lack and which are left out', async () => {
    const page = await shareViewer(CHEAP);
    const started: string[] = [];
    const note = (worker: Worker) => started.push(worker.url());
    page.on('worker', note);
    for (const { name, bytes, workers } of [
      { name: 'a.ply.gz', bytes: gzipSync(encodePly(testScene(260))), workers: ['formats'] },
      { name: 'misnamed.spz', bytes: encodePly(testScene(260)), workers: ['formats'] },
      { name: 'misnamed.ply', bytes: fixture('sog'), workers: ['ply', 'formats'] },
      { name: 'a.sog', bytes: fixture('sog'), workers: ['formats'] },
      { name: 'a.spz', bytes: fixture('spz'), workers: ['formats'] },
      { name: 'a.compressed.ply', bytes: fixture('compressed.ply'), workers: ['formats'] },
      { name: 'a.splat', bytes: fixture('splat'), workers: ['formats'] },
      { name: 'a.ksplat', bytes: fixture('ksplat'), workers: ['formats'] },
      { name: 'a.glb', bytes: fixture('glb'), workers: ['formats'] },
    ]) {
      started.length = 0;
      await openFile(page, name, bytes);
      const kinds = started.map((url) => /([a-z-]+)-worker/.exec(url)?.[1]);
      expect(kinds, name).toEqual([...workers, 'framing']);
      expect(await textOf(page, 'scene'), name).toContain('260 splats');
    }
    page.off('worker', note);

    const flat = Buffer.from(encodePly(testScene(20)));
    flat.write('scale_x', flat.indexOf('scale_2'));
    await openFile(page, 'flat.ply', flat);
    expect(await textOf(page, 'scene')).toContain('no third scale (2DGS)');

    const set = testScene();
    // Rows 0, 2, 4, … have no position, row 1 no opacity, row 3 an infinite colour.
    for (let i = 0; i < set.count; i += 2) set.positions[3 * i + 1] = Number.NaN;
    set.opacityLogits[1] = Number.NaN;
    set.colorDc[3 * 3] = Number.POSITIVE_INFINITY;
    await dropFiles(page, [{ name: 'half.ply', bytes: encodePly(set) }]);
    await waitForScene(page, 'half.ply');
    expect(await textOf(page, 'scene')).toContain('198 splats · view-dependent colour (SH 1) · 202 left out');
    expect(await textOf(page, 'warning')).toContain('More than half of the splats were left out');
    expect(await textOf(page, 'warning')).toContain('202 of the 400 rows in half.ply');
    expect(await page.getByRole('status').getByTestId('warning').isVisible()).toBe(true);

    const button = page.getByTestId('dropped');
    const reasons = page.getByTestId('dropped-reasons');
    expect(await reasons.isVisible()).toBe(false);
    await button.focus();
    await page.keyboard.press('Enter');
    expect(await button.getAttribute('aria-expanded')).toBe('true');
    expect(await reasons.locator('div').allTextContents()).toEqual([
      'Position is not a finite number200',
      'Opacity is not a number1',
      'Colour is not a finite number1',
    ]);
    await page.keyboard.press('Escape');
    expect(await reasons.isVisible()).toBe(false);
    expect(await button.getAttribute('aria-expanded')).toBe('false');
    // The first Escape closes the list and leaves the warning, which matters more, to the next one.
    expect(await page.getByTestId('warning').isVisible()).toBe(true);
    await page.keyboard.press('Escape');
    expect(await page.getByTestId('warning').count()).toBe(0);

    await dropFiles(page, [{ name: 'whole.ply', bytes: encodePly(testScene()) }]);
    await waitForScene(page, 'whole.ply');
    expect(await page.getByTestId('dropped').count()).toBe(0);
  });

  it('decodes the images of a SOG by the browser to the values of our own decoder', async () => {
    // Any page of the viewer's origin does.
    const page = await harness.open('third-party-licenses.txt');
    await expectSameSplats(page, fixture('sog'));
  });

  it('shows a PLY in gzip as the float64 reference does, turns it over, and saves it as glTF', async () => {
    const page = await shareViewer('?scene=still-life-small', TINY);
    await openFile(page, 'test scene.ply.gz', gzipSync(encodePly(testScene())));
    expect(
      psnrAgainstReference(await viewerScreenshot(page), await drawnCamera(page), [testScene()]),
    ).toBeGreaterThan(MIN_PSNR_DB);
    // Files have y down and are turned; the button tells of a person's turns.
    await redraw(page, () => page.keyboard.press('v'));
    const flip = page.getByTestId('flip');
    expect(await flip.getAttribute('aria-pressed')).toBe('false');
    await redraw(page, () => page.keyboard.press('u'));
    expect(await flip.getAttribute('aria-pressed')).toBe('true');
    const flipped = await drawnCamera(page);
    expect(flipped.modelMatrices).toEqual([null]);
    expect(psnrAgainstReference(await viewerScreenshot(page), flipped, [testScene()])).toBeGreaterThanOrEqual(
      MIN_PSNR_DB,
    );

    // This way up, as glTF wants it, nothing is turned.
    await openSaveTab(page, 'file');
    await press(page, 'save-gltf');
    const [saved] = await Promise.all([
      page.waitForEvent('download'),
      waitForNotice(page, 'Saved test scene.glb'),
      press(page, 'save-file'),
    ]);
    expect(saved.suggestedFilename()).toBe('test scene.glb');
    const { positions } = await readSplats(readFileSync(await saved.path()), { name: 'saved' });
    expect(positions).toEqual(testScene().positions);
  });

  it('shows what has arrived of a file, can be moved, and goes back to a whole scene if the rest is cancelled', async () => {
    const page = await harness.openShared('?file=/slow.ply', TINY);
    await page.waitForFunction(
      () => document.querySelector('[data-testid=scene-title]')?.textContent === 'slow.ply',
    );
    const part = async () =>
      Number(/([\d,]+) splats/.exec(await textOf(page, 'scene'))![1].replaceAll(',', ''));
    await expect.poll(part).toBeGreaterThan(10_000);
    expect(await part()).toBeLessThan(slowScene().count);
    await waitForState(page, 'loading');
    expect(await page.getByTestId('load').isVisible()).toBe(true);
    await expect.poll(async () => colorsIn(await viewerScreenshot(page))).toBeGreaterThan(50);
    // The file arrives in several parts.
    const early = await atRest(page, () => viewerScreenshot(page));
    await page.keyboard.press('ArrowRight');
    await expect.poll(async () => changedPart(early, await viewerScreenshot(page))).toBeGreaterThan(0.02);

    await page.evaluate(() => {
      const titles: (string | undefined)[] = [];
      Object.assign(window, { titlesAtRest: titles });
      const { store } = window as unknown as ViewerWindow;
      store.subscribe(
        ({ restedFrames }) => restedFrames,
        () => titles.push(store.getState().scene?.title),
      );
      // The button lies outside of so small a window.
      document.querySelector<HTMLElement>('[data-testid=cancel-load]')!.click();
    });
    await waitForScene(page, 'Still life, small');
    const whole = await viewerScreenshot(page);
    expect(colorsIn(whole), 'different colours').toBeGreaterThan(500);
    expect(changedPart(early, whole)).toBeGreaterThan(0.1);
    // It never says that an image stands while there is none.
    const titles = await page.evaluate(
      () => (window as unknown as { titlesAtRest: (string | undefined)[] }).titlesAtRest,
    );
    expect(titles).not.toEqual([]);
    for (const title of titles) expect(title).toContain('Still life');
  });

  /**
   * @fault Files: a file is cut off
   * @consequence the error names the row and the byte; the viewer keeps its scene
   */
  it('keeps its scene while a file is loading, opens several, and says what is wrong with one that is cut off', async () => {
    const page = await shareViewer(CHEAP);
    const title = await textOf(page, 'scene-title');
    await page.evaluate(() => {
      const post = Worker.prototype.postMessage;
      // Holds the loading worker's job back until the test releases it.
      Worker.prototype.postMessage = function (this: Worker, ...message: unknown[]) {
        Worker.prototype.postMessage = post;
        Object.assign(window, { release: () => Reflect.apply(post, this, message) });
      };
    });
    await dropFiles(page, [{ name: 'later.ply', bytes: encodePly(testScene()) }]);
    await page.waitForFunction(() => 'release' in window);
    expect(await page.getByTestId('load').isVisible()).toBe(true);

    const before = await viewerScreenshot(page);
    await redraw(page, () => page.keyboard.press('ArrowRight'));
    expect(changedPart(before, await viewerScreenshot(page))).toBeGreaterThan(0.05);
    expect(await textOf(page, 'scene-title')).toBe(title);
    await waitForState(page, 'loading');

    await page.evaluate(() => (window as unknown as { release: () => void }).release());
    await waitForScene(page, 'later.ply');
    expect(await textOf(page, 'scene-title')).toBe('later.ply');

    const bytes = encodePly(testScene());
    await dropFiles(page, [
      { name: 'readme.txt', bytes: new Uint8Array(3) },
      { name: 'a.ply', bytes },
      { name: 'b.ply', bytes },
    ]);
    await waitForNotice(page, 'is left out: its name');
    await waitForScene(page, 'a.ply and b.ply');
    expect(await textOf(page, 'scene-title')).toBe('a.ply and b.ply');

    const several = await viewerScreenshot(page);
    await dropFiles(page, [{ name: 'cut.ply', bytes: bytes.subarray(0, Math.floor(bytes.length * 0.6)) }]);
    await waitForState(page, 'error');
    expect(await textOf(page, 'error')).toContain('cut.ply is incomplete');
    expect(await textOf(page, 'error-message')).toMatch(/^[\d.]+ of [\d.]+ kB arrived\.$/);
    expect(await textOf(page, 'error-details')).toMatch(/cut\.ply.*vertex/);
    expect(await page.getByRole('alert').getByTestId('error').isVisible()).toBe(true);
    expect(await textOf(page, 'scene-title')).toBe('a.ply and b.ply');
    expect(changedPart(several, await viewerScreenshot(page), 0)).toBe(0);

    await page.getByTestId('dismiss-error').click();
    await waitForState(page, 'ready');
    expect(await page.getByTestId('error').count()).toBe(0);
  });

  /**
   * @fault Arguments: a URL in the viewer leads to no splats
   * @consequence the reason, and the built-in scene
   * @fault Arguments: the viewer's URL names an unknown accuracy
   * @consequence the default accuracy, and a notice
   */
  it('says so where the address leads to no splats, or asks for no accuracy, and draws the built-in scene', async () => {
    const page = await harness.openShared(
      '?scene=still-life-small&accuracy=minPsnrDb:1e999&file=index.html',
      TINY,
    );
    await waitForNotice(page, 'minPsnrDb:1e999');
    await waitForScene(page, 'Still life, small', 'error');
    expect(await textOf(page, 'error')).toContain('index.html is a web page or XML');
    expect(await textOf(page, 'scene-title')).toContain('Still life');
  });

  it('draws in device pixels, also after the window has changed', async () => {
    const page = await openViewer(CHEAP, { viewport: { width: 200, height: 120 }, deviceScaleFactor: 2 });
    const backingSize = () =>
      page.getByTestId('viewport').evaluate((canvas: HTMLCanvasElement) => [canvas.width, canvas.height]);
    expect(await backingSize()).toEqual([400, 240]);
    await redraw(page, () => page.setViewportSize({ width: 150, height: 190 }));
    expect(await backingSize()).toEqual([300, 380]);
    const { projectionMatrix } = await drawnCamera(page);
    expect(projectionMatrix[5] / projectionMatrix[0]).toBeCloseTo(150 / 190);
  });

  it('lists its keys, hides its figures, moves the view by keys, mouse and wheel, and goes back', async () => {
    const page = await shareViewer(BY_TILES);
    await page.getByTestId('hint').getByText('Drag to orbit').waitFor({ state: 'attached' });
    await page.keyboard.press('?');
    await page.getByTestId('help').waitFor();
    expect(await page.getByTestId('hint').count()).toBe(0);
    await page.keyboard.press('Escape');
    await page.getByTestId('help').waitFor({ state: 'hidden' });
    // A command is found by its words, and run.
    await page.keyboard.press('Control+k');
    await page.getByTestId('find-command').fill('cost eff');
    expect(await page.locator('[data-testid^=run-]').count()).toBe(1);
    await page.keyboard.press('Enter');
    await page.getByTestId('effects').waitFor();
    await page.keyboard.press('Escape');
    await page.getByTestId('effects').waitFor({ state: 'detached' });
    const scheme = () => page.evaluate(() => document.documentElement.dataset.theme);
    await redraw(page, () => page.keyboard.press('t'));
    expect(await scheme()).toBe('dark');
    await redraw(page, () => page.keyboard.press('t'));
    expect(await scheme()).toBeUndefined();
    await page.keyboard.press('h');
    await page.getByTestId('hud').waitFor({ state: 'detached' });
    await page.keyboard.press('h');
    await page.getByTestId('hud').waitFor();
    expect(await textOf(page, 'hud-headline')).toMatch(/^[\d,.]+ ms to draw, at rest$/);
    // Figures nearly reach the middle of so small a window, and further in frames above a second.
    await page.keyboard.press('h');
    await page.getByTestId('hud').waitFor({ state: 'detached' });
    const start = await viewerScreenshot(page);
    const act = async (what: string, action: () => Promise<void>) => {
      const before = await viewerScreenshot(page);
      await redraw(page, action);
      const after = await viewerScreenshot(page);
      expect(changedPart(before, after), what).toBeGreaterThan(0.05);
      return after;
    };
    await act('arrow key', () => page.keyboard.press('ArrowRight'));
    await act('left drag', async () => {
      await page.mouse.move(240, 200);
      await page.mouse.down();
      await page.mouse.move(300, 190);
      await page.mouse.up();
    });
    await act('right drag', async () => {
      await page.mouse.down({ button: 'right' });
      await page.mouse.move(240, 220);
      await page.mouse.up({ button: 'right' });
    });
    await act('wheel', () => page.mouse.wheel(0, -240));
    const end = await act('reset', () => page.keyboard.press('r'));
    expect(changedPart(start, end, 0)).toBe(0);
  });

  /**
   * @fault Devices and engines: there is no WebGPU
   * @consequence the viewer says what is missing
   */
  it('says what is missing where there is no WebGPU', async () => {
    const page = await newPage();
    await page.addInitScript(() =>
      Object.defineProperty(Navigator.prototype, 'gpu', { get: () => undefined }),
    );
    await page.goto(harness.server.url);
    await waitForState(page, 'unavailable');
    const message = await textOf(page, 'webgpu-unavailable');
    expect(message).toContain('needs WebGPU');
    for (const name of ['Chrome', 'Safari', 'Firefox']) expect(message).toContain(name);
  });

  /**
   * @fault Devices and engines: the code of the engine cannot be fetched in the viewer
   * @consequence a page with the reason and a button
   */
  it.each([
    ['engine', /The code of the engine could not be fetched/],
    ['viewer', /Failed to fetch dynamically imported module/],
    ['view of a link', /Failed to fetch dynamically imported module/, 'address'],
  ])('says so where the code of the %s cannot be fetched', async (name, problem, script = name) => {
    harness.expectProblem(/Failed to load resource/);
    harness.expectProblem(problem);
    const page = await newPage();
    await page.route(`**/${script}-*.js`, (route) => route.abort());
    await page.goto(harness.server.url + CHEAP);
    await waitForState(page, 'unavailable');
    expect(await textOf(page, 'page-failed')).toContain('could not be loaded');
    await page.unroute(`**/${script}-*.js`);
    await page.getByRole('button', { name: 'Try again' }).click();
    await waitForState(page, 'ready');
  });

  /**
   * @fault Devices and engines: WebGPU is there, but no GPU
   * @consequence a page with the reason and a button
   */
  it('says so where there is WebGPU but no GPU for it', async () => {
    const page = await newPage();
    await page.addInitScript(() => {
      Object.assign(window, { request: GPU.prototype.requestAdapter });
      GPU.prototype.requestAdapter = async () => null;
    });
    await page.goto(harness.server.url + CHEAP);
    await waitForState(page, 'unavailable');
    expect(await textOf(page, 'status-reason')).toContain('no GPU');
    await page.evaluate(() => {
      GPU.prototype.requestAdapter = (window as unknown as { request: GPU['requestAdapter'] }).request;
    });
    await expect.poll(() => focusedTestId(page)).toBe('retry');
    await page.keyboard.press('Enter');
    await waitForImage(page);
  });

  /**
   * @fault Devices and engines: the GPU process ends, and no adapter is found
   * @consequence a page over the viewer takes the focus, and at last waits for a person; scene and camera
   *   come back, bit for bit
   */
  it('recovers the scene and the view after the device was lost', async () => {
    const page = await newPage();
    for (const script of [loseDeviceOnDemand, skipRecoveryWaits, loseAdaptersOnDemand])
      await page.addInitScript(script);
    await page.goto(`${harness.server.url}${BY_TILES}`);
    await waitForImage(page);
    await redraw(page, () => page.keyboard.press('ArrowLeft'));
    const before = await viewerScreenshot(page);

    // The GPU process ends, and there is no adapter from then on.
    harness.expectProblem(/external Instance reference|WebGPU Device Lost/);
    await page.keyboard.press('?');
    await page.getByTestId('help').waitFor();
    await send(page, 'adapters-go');
    const session = await harness.browser.newBrowserCDPSession();
    // The browser does not answer once its GPU process has crashed.
    await session.send('Browser.crashGpuProcess' as never).catch(() => {});
    await waitForNotice(page, 'GPU was lost');
    // All attempts have failed: it is left to a person.
    await page.getByTestId('prospect').getByText('Several attempts').waitFor();
    expect(await textOf(page, 'status-reason')).toContain('no GPU');
    expect(await page.getByTestId('help').isVisible()).toBe(false);
    // The page stays, has the keyboard, and keeps it.
    for (const key of ['Escape', 'Escape']) await page.keyboard.press(key);
    await expect.poll(() => focusedTestId(page)).toBe('recover');
    await page.getByTestId('viewport').focus();
    expect(await focusedTestId(page)).toBe('recover');
    for (const [key, reached] of [
      ['Tab', 'open-small-scene'],
      ['Tab', 'reload'],
      ['Shift+Tab', 'open-small-scene'],
      ['Shift+Tab', 'recover'],
    ]) {
      await page.keyboard.press(key);
      expect(await focusedTestId(page)).toBe(reached);
    }
    await send(page, 'adapters-come-back');
    await page.keyboard.press('Enter');
    await waitForScene(page, 'Still life, small');
    expect(await focusedTestId(page)).toBe('viewport');
    expect(changedPart(before, await viewerScreenshot(page), 0)).toBe(0);

    // By itself, with the file that was being opened.
    await page.evaluate(() => {
      // The device goes when a worker is to read the file; the worker gets its job with the next
      // device.
      const { postMessage } = Worker.prototype;
      Worker.prototype.postMessage = () => void dispatchEvent(new Event('lose-device'));
      const { requestDevice } = GPUAdapter.prototype;
      GPUAdapter.prototype.requestDevice = function (...options) {
        Worker.prototype.postMessage = postMessage;
        return requestDevice.apply(this, options);
      };
    });
    await dropFiles(page, [{ name: 'asked.ply', bytes: encodePly(testScene()) }]);
    await waitForNotice(page, 'GPU was lost');
    await waitForScene(page, 'asked.ply');

    // A scene that takes the GPU down can be left.
    await send(page, 'adapters-go');
    await send(page, 'lose-device');
    await page.getByTestId('prospect').getByText('Several attempts').waitFor();
    await send(page, 'adapters-come-back');
    await page.getByTestId('open-small-scene').click();
    await waitForScene(page, 'Still life, small');
    expect(await textOf(page, 'scene-title')).toBe('Still life, small');
  });

  it('stops a load that is cancelled, and shows the built-in scene in place of the file', async () => {
    const page = await harness.openShared(`${CHEAP}&file=/endless.ply`);
    await page.getByTestId('load-figures').getByText('of 100 MB').waitFor();
    expect(await page.evaluate(() => document.documentElement.dataset.state)).toBe('loading');
    // Before anything else is shown: a reload, or a copy of the address, does not download it again.
    const isResting = await page.getByTestId('cancel-load').evaluate(async (button: HTMLElement) => {
      button.click();
      while (location.search.includes('file=')) await new Promise(requestAnimationFrame);
      const { viewer } = window as unknown as ViewerWindow;
      return viewer!.isAtRest && viewer!.shownFrame !== null;
    });
    expect(isResting).toBe(false);
    await harness.server.whenEndlessFileIsDropped();
    await waitForScene(page, 'Still life, small');
    expect(await textOf(page, 'scene-title')).toContain('Still life');
    expect(await page.getByTestId('load').count()).toBe(0);
    expect(await page.getByTestId('error').count()).toBe(0);
    expect(new URL(page.url()).searchParams.has('file')).toBe(false);
  });

  it('stops a load when another file is dropped', async () => {
    const page = await harness.openShared(`?${CHEAPLY}&file=/endless.ply`);
    await page.getByTestId('load-figures').getByText('of 100 MB').waitFor();
    await dropFiles(page, [{ name: 'next.ply', bytes: encodePly(testScene()) }]);
    await harness.server.whenEndlessFileIsDropped();
    await waitForScene(page, 'next.ply');
    expect(await textOf(page, 'scene-title')).toBe('next.ply');
  });
});
