// Proves: what readers of embedded frames and saved pages have: controls, and a wheel that is the page's.
import type { Frame, Page } from 'playwright-core';
import { describe, expect, it } from 'vitest';
import {
  CHEAP,
  cameraOnScreen,
  drawnCamera,
  framesAtRest,
  isAtRestAfter,
  redraw,
  textOf,
  viewerHarness,
} from './viewer-page.ts';

const harness = viewerHarness();
const WINDOW = { viewport: { width: 640, height: 400 } };
/** The path between them takes a minute, so that a busy machine sees it play. */
const VIEWS = 'view=0,0,0,2,0,1.4,next:60,name:From+the+front&view=0,0,0,2,0.4,1.2';
const ANNOTATION = 'annotation=0:0.2:0,0,0.2,0,2,0,1.4,words:The+vase%0AOld.';
const STORY = `${CHEAP}&noui&camera=0,0,0,3,0.2,1.3&${VIEWS}&${ANNOTATION}`;

const controls = (page: Page | Frame) => page.getByTestId('plain-controls');

describe('the controls of a picture without panels', () => {
  it('play the path, and show views, annotations, the first view and whose picture it is', async () => {
    const page = await harness.shareViewer(STORY, WINDOW);
    await controls(page).waitFor();
    const sent = await drawnCamera(page);
    expect(await controls(page).innerText()).toContain('Still life, small · WebSplatter');
    expect(await textOf(page, 'plain-hint')).toBe('Drag to turn, scroll to zoom');

    await redraw(page, () =>
      page.mouse.wheel(0, 0).then(() => page.getByTestId('viewport').press('ArrowLeft')),
    );
    expect((await drawnCamera(page)).viewMatrix).not.toEqual(sent.viewMatrix);
    expect(await page.getByTestId('plain-hint').count()).toBe(0);
    await redraw(page, () => page.getByTestId('plain-reset').click());
    expect((await drawnCamera(page)).viewMatrix).toEqual(sent.viewMatrix);

    await page.getByTestId('plain-views').click();
    const views = page.getByTestId('plain-views-list');
    expect(await views.getByRole('button').allInnerTexts()).toEqual(['From the front', 'View 2']);
    await redraw(page, () => views.getByText('View 2').click());
    await views.waitFor({ state: 'hidden' });
    expect((await drawnCamera(page)).viewMatrix).not.toEqual(sent.viewMatrix);

    await page.getByTestId('plain-annotations').click();
    await redraw(page, () => page.getByTestId('plain-annotations-list').getByText('1: The vase').click());
    expect(await textOf(page, 'annotation')).toContain('Old.');

    const play = page.getByTestId('plain-play');
    await play.click();
    await expect.poll(() => play.getAttribute('aria-label')).toBe('Pause');
    await play.click();
    await expect.poll(() => play.getAttribute('aria-label')).toBe('Play');
  });

  it('fade while nobody does anything, and stay while a key has focused them', async () => {
    const page = await harness.shareViewer(STORY, WINDOW);
    const opacity = () => controls(page).evaluate((element) => getComputedStyle(element).opacity);
    await expect.poll(opacity).toBe('0');
    await page.getByTestId('viewport').focus();
    await page.keyboard.press('Tab');
    // Markers of annotations come first.
    for (let i = 0; i < 5 && !(await hasFocus(page, 'plain-play')); i++) await page.keyboard.press('Tab');
    expect(await hasFocus(page, 'plain-play')).toBe(true);
    await page.locator('[data-testid=plain-controls][data-idle]').waitFor();
    expect(await opacity()).toBe('1');
    // Lists are reached by keys, and left by Escape.
    await page.keyboard.press('Tab');
    await page.keyboard.press('Enter');
    await page.getByTestId('plain-views-list').waitFor();
    await page.keyboard.press('Tab');
    expect(await page.evaluate(() => document.activeElement?.textContent)).toBe('From the front');
    await page.keyboard.press('Escape');
    await page.getByTestId('plain-views-list').waitFor({ state: 'hidden' });
  });

  it('are large enough for fingers, and the whole screen is theirs', async () => {
    const page = await harness.openViewer(STORY, {
      viewport: { width: 360, height: 640 },
      hasTouch: true,
      isMobile: true,
    });
    await controls(page).waitFor();
    const sizes = await controls(page)
      .getByRole('button')
      .evaluateAll((all) => all.map((each) => each.getBoundingClientRect()));
    expect(sizes).toHaveLength(5);
    for (const { width, height, right } of sizes) {
      expect(Math.min(width, height)).toBeGreaterThanOrEqual(44);
      expect(right).toBeLessThanOrEqual(360);
    }
    expect(await textOf(page, 'plain-hint')).toBe('Drag to turn, pinch to zoom');
    await page.getByTestId('plain-fullscreen').tap();
    await page.waitForFunction(() => document.fullscreenElement !== null);
    await expect
      .poll(() => page.getByTestId('plain-fullscreen').getAttribute('aria-label'))
      .toBe('Leave full screen');
  });
});

function hasFocus(page: Page, testId: string): Promise<boolean> {
  return page.getByTestId(testId).evaluate((element) => element === document.activeElement);
}

describe('a frame in a page', () => {
  async function openArticle(options = {}): Promise<{ page: Page; frame: Frame }> {
    const page = await harness.newPage({ ...WINDOW, ...options });
    const body = `<meta name="viewport" content="width=device-width"><body style="margin: 0"><iframe src="./${STORY}" title="A scene" width="400" height="300" style="border: 0" allow="fullscreen"></iframe><p style="height: 3000px">Words</p>`;
    await page.route('**/article.html', (route) =>
      route.fulfill({ body: `<!doctype html>${body}`, contentType: 'text/html' }),
    );
    await page.goto(`${harness.server.url}article.html`);
    await expect.poll(() => page.frames().length).toBe(2);
    const [, frame] = page.frames();
    await frame.waitForFunction(isAtRestAfter, 0);
    await frame.locator('html[data-framed]').waitFor();
    return { page, frame };
  }
  const cameraIn = async (frame: Frame) => (await frame.evaluate(cameraOnScreen))!;
  const framesIn = (frame: Frame) => frame.evaluate(framesAtRest);
  const scrolled = (page: Page) => page.evaluate(() => scrollY);

  it('lets a wheel scroll the page, says how it zooms, and zooms with Ctrl', async () => {
    const { page, frame } = await openArticle();
    expect(await frame.getByTestId('plain-hint').innerText()).toBe('Drag to turn, Ctrl + scroll to zoom');
    const before = await cameraIn(frame);
    await page.mouse.move(60, 60);
    await page.mouse.wheel(0, 60);
    await expect.poll(() => scrolled(page)).toBe(60);
    await frame.getByTestId('wheel-hint').getByText('Use Ctrl + scroll to zoom').waitFor();
    expect(await cameraIn(frame)).toEqual(before);

    const frames = await framesIn(frame);
    await page.keyboard.down('Control');
    await page.mouse.wheel(0, -100);
    await frame.waitForFunction(isAtRestAfter, frames);
    await page.keyboard.up('Control');
    expect(await scrolled(page)).toBe(60);
    // One notch: a seventh nearer, as without Ctrl in a page of its own.
    const [near, far] = [await cameraIn(frame), before].map(({ viewMatrix }) =>
      Math.hypot(...viewMatrix.slice(12, 15)),
    );
    expect(near / far).toBeCloseTo(Math.exp(-0.15), 2);
    await frame.getByTestId('wheel-hint').waitFor({ state: 'detached' });
  });

  it('lets one finger turn the picture sideways, and leaves up and down to the page', async () => {
    const { page, frame } = await openArticle({ hasTouch: true, isMobile: true });
    const viewport = frame.getByTestId('viewport');
    const touchAction = () => viewport.evaluate((canvas) => getComputedStyle(canvas).touchAction);
    await expect.poll(touchAction).toBe('pan-y');
    const before = await cameraIn(frame);
    const frames = await framesIn(frame);
    const session = await page.context().newCDPSession(page);
    await session.send('Input.synthesizeScrollGesture', {
      ...{ x: 250, y: 200, xDistance: -120, yDistance: 0, gestureSourceType: 'touch', speed: 400 },
    });
    await frame.waitForFunction(isAtRestAfter, frames);
    expect((await cameraIn(frame)).viewMatrix).not.toEqual(before.viewMatrix);
    expect(await scrolled(page)).toBe(0);
  });
});
