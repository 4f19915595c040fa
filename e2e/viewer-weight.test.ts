// Proves: the viewer as one file, embedded; SuperSplat's settings; small windows.
import { readFile } from 'node:fs/promises';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';
import { encodePly } from '@websplatter/core';
import type { Frame, Page } from 'playwright-core';
import { beforeAll, describe, expect, it } from 'vitest';
import { builtApp } from './server.ts';
import { testScene } from './test-scene.ts';
import {
  CHEAP,
  CHEAPLY,
  type DrawnCamera,
  drawnCamera,
  isAtRestAfter,
  redraw,
  textOf,
  type ViewerWindow,
  viewerHarness,
  waitForImage,
  waitForScene,
} from './viewer-page.ts';

const SETTINGS = {
  version: 2,
  background: { color: [1, 0.5, 0] },
  cameras: [{ initial: { position: [1, 2, 3], target: [0, 0, 0], fov: 60 } }],
  animTracks: [],
  startMode: 'default',
};
const json = (value: object) => new TextEncoder().encode(JSON.stringify(value));
const PLY = encodePly(testScene());
const harness = viewerHarness({
  'scene.ply': PLY,
  'settings.json': json(SETTINGS),
  'broken.json': json({ ...SETTINGS, background: 1 }),
});
const SMALL_WINDOW = { viewport: { width: 320, height: 240 } };

/** How often, and after how many milliseconds, the page has noted its first picture. */
function firstPictures(page: Page): Promise<number[]> {
  return page.evaluate(() => performance.getEntriesByName('first picture').map(({ duration }) => duration));
}

describe('the viewer as one file', () => {
  let file: string;
  beforeAll(async () => {
    file = join(await builtApp('apps/viewer/vite.embed.config.ts'), 'embed.html');
  });

  it('works from a disk, with workers and panels, and notes when its first picture was there', async () => {
    const page = await harness.newPage(SMALL_WINDOW);
    await page.goto(pathToFileURL(file).href);
    await waitForImage(page);
    expect(await textOf(page, 'scene-title')).toContain('Still life');
    const [afterMs, ...others] = await firstPictures(page);
    expect(afterMs).toBeGreaterThan(0);
    expect(others).toEqual([]);
    await page.keyboard.press('e');
    await page.getByTestId('effects').waitFor();
    await page.getByTestId('file-input').setInputFiles({
      name: 'a.ply',
      mimeType: 'application/octet-stream',
      buffer: Buffer.from(PLY),
    });
    await waitForScene(page, 'a.ply');
    expect(await page.title()).toMatch(/^a\.ply/);
  });

  it('ends with the licences of the packages in it', async () => {
    expect((await readFile(file, 'utf8')).slice(-50_000)).toMatch(/## mediabunny - .*## zustand - /s);
  });

  it('shows a file of the page that embeds it, without an interface', async () => {
    const page = await harness.newPage(SMALL_WINDOW);
    const embedding = '<iframe src="embed.html?src=scene.ply&noui" title="A scene"></iframe>';
    // Browsers ask for an icon.
    await page.route('https://pages.example/**', (route) => route.fulfill({ status: 204 }));
    await page.route('**/index.html', (route) =>
      route.fulfill({ body: embedding, contentType: 'text/html' }),
    );
    await page.route('**/embed.html?*', (route) => route.fulfill({ path: file, contentType: 'text/html' }));
    await page.route('**/scene.ply', (route) => route.fulfill({ body: Buffer.from(PLY) }));
    await page.goto('https://pages.example/index.html');
    const frame = page.frames().find((each) => each !== page.mainFrame()) as Frame;
    await frame.waitForFunction(isAtRestAfter, 0);
    expect(await frame.title()).toBe('scene.ply · WebSplatter');
    expect(await frame.getByRole('toolbar').count()).toBe(0);
  });
});

describe('the settings.json of SuperSplat', () => {
  it('gives the first scene its camera and its background, or is refused in words', async () => {
    const page = await harness.shareViewer(`?src=scene.ply&settings=settings.json&${CHEAPLY}`, SMALL_WINDOW);
    const isAsked = ({ background, viewMatrix }: DrawnCamera) => {
      // Where the camera stands: SuperSplat's [1, 2, 3], which turns the file another way.
      const position = [0, 1, 2].map((row) =>
        [0, 1, 2].reduce((sum, k) => sum - viewMatrix[4 * row + k] * viewMatrix[12 + k], 0),
      );
      return (
        background[0] === 1 && [-1, 2, -3].every((value, axis) => Math.abs(position[axis] - value) < 1e-4)
      );
    };
    await waitForImage(page);
    await expect.poll(async () => isAsked(await drawnCamera(page))).toBe(true);
    await harness.openShared(`?src=scene.ply&settings=broken.json&${CHEAPLY}`, SMALL_WINDOW);
    await page.getByTestId('error').waitFor();
    expect(await textOf(page, 'error-message')).toBe('background is 1, but must be an object.');
  });
});

describe('the toolbar of small windows', () => {
  it('has a menu of the commands that do not fit, for fingers and keys, and gamepads move the view', async () => {
    const page = await harness.openViewer(CHEAP, { viewport: { width: 360, height: 640 }, hasTouch: true });
    const focused = () => page.evaluate(() => (document.activeElement as HTMLElement).dataset.testid);
    const more = page.getByTestId('more');
    const menu = page.getByTestId('more-menu');
    const small = await page.evaluate(() =>
      [...document.querySelectorAll('nav button:not(.menu-item)')]
        .map((button) => button.getBoundingClientRect())
        .filter(({ width, height }) => Math.min(width, height) < 44),
    );
    expect(small, 'buttons that are too small for fingers').toEqual([]);
    expect(await page.getByTestId('toolbar').innerText()).toBe('Open\nView\nAccuracy\nSave\nHelp\nMore');
    await more.focus();
    await page.keyboard.press('ArrowDown');
    await menu.waitFor();
    expect(await focused()).toBe('command-clouds');
    for (const [key, reached] of [
      ['ArrowDown', 'command-frame'],
      ['End', 'command-annotate'],
      ['ArrowDown', 'command-clouds'],
      ['ArrowUp', 'command-annotate'],
      ['Home', 'command-clouds'],
    ]) {
      await page.keyboard.press(key);
      expect(await focused(), key).toBe(reached);
    }
    await page.keyboard.press('Escape');
    expect(await menu.isVisible()).toBe(false);
    expect(await focused()).toBe('more');

    // A key runs its command here too, and closes the menu.
    await page.keyboard.press('Enter');
    await menu.waitFor();
    // The picture goes where the panel leaves room.
    await redraw(page, () => page.keyboard.press('v'));
    expect(await menu.isVisible()).toBe(false);
    await page.getByTestId('view').waitFor();
    await more.tap();
    await page.getByTestId('command-inspect').tap();
    await page.getByTestId('inspect').waitFor();
    await more.tap();
    expect(await page.getByTestId('command-inspect').getAttribute('aria-checked')).toBe('true');
    // A tap beside it closes it.
    await page.touchscreen.tap(180, 40);
    expect(await menu.isVisible()).toBe(false);
    await waitForImage(page);
    // A gamepad whose right stick is held to the right turns the view.
    const before = await drawnCamera(page);
    await page.evaluate(() => {
      const buttons = Array.from({ length: 17 }, () => ({ value: 0, pressed: false, touched: false }));
      const pad = { index: 0, connected: true, mapping: 'standard', axes: [0, 0, 1, 0], buttons };
      let polls = 0;
      navigator.getGamepads = () => {
        document.documentElement.dataset.polls = `${++polls}`;
        return (pad.connected ? [pad] : []) as unknown as Gamepad[];
      };
      addEventListener('let-go', () => {
        pad.connected = false;
      });
      dispatchEvent(new Event('gamepadconnected'));
    });
    // No time has passed at the first refresh that asks for the stick, so that the view turns later.
    await page.waitForFunction(() => Number(document.documentElement.dataset.polls) > 2);
    await page.waitForFunction(() => !(window as unknown as ViewerWindow).viewer!.isAtRest);
    await page.evaluate(() => void dispatchEvent(new Event('let-go')));
    await page.waitForFunction(isAtRestAfter, 0);
    expect((await drawnCamera(page)).viewMatrix).not.toEqual(before.viewMatrix);
    // Wider windows have all buttons.
    await page.setViewportSize({ width: 1440, height: 600 });
    await more.waitFor({ state: 'detached' });
    expect(await page.getByTestId('command-help').isVisible()).toBe(true);
  });
});
