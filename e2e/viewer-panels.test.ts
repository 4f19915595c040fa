// Proves: effects: switched, slid, moved by a handle, linked, reset.
import type { Page } from 'playwright-core';
import { describe, expect, it } from 'vitest';
import { changedPart, colorsIn } from './screenshot.ts';
import { CHEAP, redraw, textOf, viewerHarness, viewerScreenshot, waitForNotice } from './viewer-page.ts';

const harness = viewerHarness();

/** The image without the volume's handle. */
const picture = (page: Page) => viewerScreenshot(page, '.volume-gizmo { visibility: hidden !important; }');

/** The smallest in which a panel leaves the middle of the picture free. */
const SIZE = { viewport: { width: 800, height: 490 } };
/** The smallest in which the picture makes no room for the toolbar: it is as without any interface. */
const WIDE = {
  viewport: { width: 1100, height: 490 },
  permissions: ['clipboard-read', 'clipboard-write'],
};
const effectsIn = (page: Page) => new URL(page.url()).searchParams.get('effects');

/** Opens the panel without the figures, which hide a part of the picture. */
async function openEffects(effects = ''): Promise<Page> {
  const page = await harness.shareViewer(effects ? `${CHEAP}&effects=${effects}` : CHEAP, SIZE);
  await page.keyboard.press('h');
  await redraw(page, () => page.keyboard.press('e'));
  return page;
}

const click = (page: Page, testId: string) => page.getByTestId(testId).click();

async function switchOn(page: Page, name: string): Promise<void> {
  await redraw(page, () => click(page, `switch-${name}`));
}

/** Reveals splats as far as the middle of the scene: some are left out, and enough are not. */
async function reveal(page: Page): Promise<void> {
  await switchOn(page, 'reveal');
  await redraw(page, () => click(page, 'reveal-from-camera'));
  await page.getByTestId('reveal-radius').focus();
  await redraw(page, async () => {
    for (const key of ['Home', 'PageUp', 'PageUp', 'PageUp', 'PageUp']) await page.keyboard.press(key);
  });
}

describe('effects that are asked for', () => {
  it('are switched in the picture and in the address, and say what they lack and cost', async () => {
    const page = await openEffects();
    const first = await picture(page);
    expect(await textOf(page, 'request-highlight')).toContain('Not available: no splats are selected');
    await switchOn(page, 'volumes');
    expect(changedPart(first, await picture(page), 2)).toBeGreaterThan(0.1);
    await page.waitForURL(/effects=volumes:plane:/);
    expect(await textOf(page, 'cost-volumes')).toBe('cost not measured');
    await redraw(page, () => click(page, 'switch-volumes'));
    expect(await page.getByTestId('volume-gizmo').count()).toBe(0);
    // Keys keep their meaning where a switch has the focus.
    await page.getByTestId('switch-volumes').focus();
    await page.keyboard.press('e');
    await page.getByTestId('effects').waitFor({ state: 'detached' });
  });

  it('are moved by a handle along the normal of a plane only, take another shape and size, and are reset', async () => {
    const page = await openEffects();
    await switchOn(page, 'volumes');
    await page.waitForURL(/effects=volumes:plane:/);
    const place = () => effectsIn(page)?.split(':').slice(2, 5).map(Number) ?? [];
    const [x, y, z] = place();
    const handle = page.getByTestId('volume-handle');
    const box = await handle.boundingBox();
    if (!box) throw new Error('The handle is not in the picture.');
    await page.mouse.move(box.x + 22, box.y + 22);
    await page.mouse.down();
    await redraw(page, () => page.mouse.move(box.x + 50, box.y + 62));
    await page.mouse.up();
    await expect.poll(() => place()[1]).toBeLessThan(y);
    expect([place()[0], place()[2]]).toEqual([x, z]);
    const dragged = place()[1];
    await redraw(page, () => page.keyboard.press('Shift+ArrowDown'));
    await expect.poll(() => place()[1]).toBeLessThan(dragged);

    const cut = await picture(page);
    await redraw(page, () => click(page, 'volumes-shape-sphere'));
    const radius = page.getByTestId('volumes-radius');
    await radius.focus();
    await redraw(page, () => page.keyboard.press('Home'));
    expect(await radius.getAttribute('aria-valuetext')).toBe('0.000 units');
    expect(changedPart(await picture(page), cut, 2)).toBeGreaterThan(0.1);
    await page.waitForURL(/effects=volumes:sphere:/);
    await redraw(page, () => click(page, 'reset-volumes'));
    await page.waitForURL(/effects=volumes:plane:/);
  });

  it('are slid, do not play where less motion is asked for, and are reset together with those of the address', async () => {
    const page = await openEffects('tint:ff8000');
    const first = await picture(page);
    await reveal(page);
    expect(await page.getByTestId('play-reveal').isDisabled()).toBe(true);
    const revealed = await picture(page);
    expect(colorsIn(revealed), 'different colours').toBeGreaterThan(500);
    expect(changedPart(first, revealed, 2)).toBeGreaterThan(0.1);
    await page.waitForURL(/effects=reveal:[^&]*,tint:ff8000/);
    await redraw(page, () => click(page, 'reset-effects'));
    await page.waitForURL((url) => !url.searchParams.has('effects'));
    expect(await page.getByTestId('switch-reveal').isChecked()).toBe(false);
    expect(await page.getByTestId('switch-tint').isChecked()).toBe(false);
  });

  it('are in a link that shows the same elsewhere', async () => {
    const page = await harness.shareViewer(CHEAP, WIDE);
    await page.keyboard.press('h');
    await redraw(page, () => page.keyboard.press('e'));
    await reveal(page);
    await switchOn(page, 'tint');
    await redraw(page, () => page.getByTestId('tint-color').fill('#ff8000'));
    await page.waitForURL(/effects=reveal:camera:[^&]*,tint:ff8000(&|$)/);
    const beside = await picture(page);
    await page.keyboard.press('l');
    await waitForNotice(page, 'The link is copied');
    const link = await page.evaluate(() => navigator.clipboard.readText());
    // The panel has moved the picture aside, and a page without it has not.
    await redraw(page, () => page.keyboard.press('e'));
    const shown = await picture(page);
    // In a browser that has kept nothing, into which the page cannot write while it is left either.
    await page.goto('about:blank');
    const linked = await picture(await harness.shareViewer(`${new URL(link).search}&noui`, WIDE));
    expect(changedPart(beside, shown, 2)).toBeGreaterThan(0.1);
    expect(colorsIn(shown), 'different colours').toBeGreaterThan(500);
    expect(Buffer.from(linked.data).equals(Buffer.from(shown.data))).toBe(true);
  });
});
