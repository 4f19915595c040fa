// Proves: scenes are opened by an address, a link, a sample or from before; the tools are found.
import { encodePly } from '@websplatter/core';
import type { Page } from 'playwright-core';
import { describe, expect, it } from 'vitest';
import { testScene } from './test-scene.ts';
import {
  CHEAP,
  drawnCamera,
  redraw,
  textOf,
  viewerHarness,
  waitForImage,
  waitForNotice,
  waitForScene,
} from './viewer-page.ts';

const harness = viewerHarness({
  'test.ply': encodePly(testScene()),
  'page.html': new TextEncoder().encode('<!doctype html><title>A page</title>'),
});
const { shareViewer } = harness;
const WINDOW = { viewport: { width: 1200, height: 600 } };
/** The address of a file beside the page. */
const on = (page: Page, file: string) => new URL(file, page.url()).href;

/** Presses Tab until a control that is on its way has the focus. */
async function tabTo(page: Page, testId: string): Promise<void> {
  await page.getByTestId(testId).waitFor();
  const focused = () => page.evaluate(() => (document.activeElement as HTMLElement).dataset.testid);
  for (let presses = 0; (await focused()) !== testId; presses++) {
    expect(presses, `presses of Tab to ${testId}`).toBeLessThan(60);
    await page.keyboard.press('Tab');
  }
}

/** Pastes or drops `text` where `selector` is. */
function transfer(page: Page, how: 'paste' | 'drop', text: string, selector = '.viewport'): Promise<void> {
  return page.evaluate(
    ([kind, data, at]) => {
      const carried = new DataTransfer();
      carried.setData(kind === 'paste' ? 'text/plain' : 'text/uri-list', data);
      const init = { bubbles: true, cancelable: true };
      document
        .querySelector(at)
        ?.dispatchEvent(
          kind === 'paste'
            ? new ClipboardEvent('paste', { ...init, clipboardData: carried })
            : new DragEvent('drop', { ...init, dataTransfer: carried }),
        );
    },
    [how, text, selector] as const,
  );
}

describe('a scene on a server', () => {
  it('opens by its address, and says what is wrong with another one', async () => {
    const page = await shareViewer(CHEAP, WINDOW);
    await page.getByTestId('command-open').click();
    await page.getByTestId('address').fill('scene of mine');
    await page.keyboard.press('Enter');
    await page.getByText('This is no address.').waitFor();
    await page.getByTestId('address').fill(on(page, 'page.html'));
    await page.keyboard.press('Enter');
    await page.getByTestId('error').getByText('page.html is a web page').waitFor();
    await page.keyboard.press('Escape');
    await page.keyboard.press('o');
    await page.getByTestId('address').fill(on(page, 'test.ply'));
    await page.keyboard.press('Enter');
    await waitForScene(page, 'test.ply');
    expect(await page.getByTestId('open').count()).toBe(0);
    await expect.poll(() => new URL(page.url()).searchParams.get('src')).toBe(on(page, 'test.ply'));
  });

  it('opens by a link that is pasted or dropped, but not by one pasted into a field', async () => {
    const page = await shareViewer(CHEAP, WINDOW);
    await transfer(page, 'paste', 'some words');
    await waitForNotice(page, 'no address of a scene');
    await page.keyboard.press('o');
    await page.getByTestId('address').waitFor();
    await transfer(page, 'paste', on(page, 'test.ply'), '[data-testid=address]');
    await page.keyboard.press('Escape');
    expect(await textOf(page, 'scene-title')).toContain('Still life');
    await transfer(page, 'paste', on(page, 'test.ply'));
    await waitForScene(page, 'test.ply');
    await page.keyboard.press('o');
    await page.getByTestId('sample-still-life-small').click();
    await waitForScene(page, 'Still life, small');
    await transfer(page, 'drop', on(page, 'test.ply'));
    await waitForScene(page, 'test.ply');
  });
});

describe('the tools', () => {
  it('have buttons that are pressed while they are open, and panels that leave the picture in place', async () => {
    const page = await shareViewer(CHEAP, WINDOW);
    const button = (name: string) => page.getByTestId(`command-${name}`);
    await redraw(page, () => button('measure').click());
    await page.getByTestId('inspect-tab-distance').waitFor();
    expect(await button('measure').getAttribute('aria-pressed')).toBe('true');
    // The tooltip has gone with the press.
    expect(await button('measure').evaluate((e) => getComputedStyle(e, '::after').content)).toBe('none');
    const { viewMatrix, projectionMatrix } = await drawnCamera(page);
    for (const [key, panel] of [
      ['v', 'view'],
      ['e', 'effects'],
      ['7', 'inspect'],
      ['n', 'clouds'],
      ['c', 'accuracy'],
      ['o', 'open'],
      ['x', 'save'],
    ]) {
      await page.keyboard.press(key);
      await page.getByTestId(panel).waitFor();
      await waitForImage(page);
      expect(await drawnCamera(page), panel).toMatchObject({ viewMatrix, projectionMatrix });
    }
    await page.keyboard.press('7');
    expect(await button('crop').getAttribute('aria-pressed')).toBe('true');
    expect(await button('inspect').getAttribute('aria-pressed')).toBe('false');
    await page.keyboard.press('7');
    await page.getByTestId('inspect').waitFor({ state: 'detached' });
  });

  it('are found by words in the help, after the viewer has said what it is for, until the first gesture', async () => {
    const page = await shareViewer(CHEAP, WINDOW);
    await page.getByTestId('hint').getByText('what they cost').waitFor();
    await page.getByTestId('try-samples').click();
    await page.getByTestId('sample-still-life').waitFor();
    await page.mouse.click(300, 300);
    await page.getByTestId('hint').waitFor({ state: 'detached' });

    await page.keyboard.press('?');
    await page.getByTestId('help').getByText('Left drag').waitFor();
    await page.getByTestId('find-command').fill('xyzzy');
    await page.getByRole('button', { name: 'crop', exact: true }).click();
    await page.keyboard.press('Enter');
    await page.getByTestId('inspect-tab-crop').waitFor();
  });

  it('lead by keys alone from a file to a page that is saved', async () => {
    const page = await shareViewer(CHEAP, WINDOW);
    // A chooser with handles tells tests nothing.
    await page.evaluate(() => Object.assign(window, { showOpenFilePicker: undefined }));
    await page.keyboard.press('o');
    await tabTo(page, 'choose-files');
    const choosing = page.waitForEvent('filechooser');
    await page.keyboard.press('Enter');
    const buffer = Buffer.from(encodePly(testScene()));
    await (await choosing).setFiles({ name: 'own.ply', mimeType: '', buffer });
    await waitForScene(page, 'own.ply');
    await page.keyboard.press('x');
    await tabTo(page, 'save-html');
    const downloading = page.waitForEvent('download');
    await page.keyboard.press('Enter');
    expect((await downloading).suggestedFilename()).toBe('own.html');
    await waitForNotice(page, 'Saved own.html');
  });
});
