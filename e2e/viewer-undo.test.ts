// Proves: whatever a visitor changes, undoing all of it gives the first picture, and redoing all of it the last.
import { encodePly } from '@websplatter/core';
import { splatsFromArrays } from '@websplatter/core/own-data';
import type { Page } from 'playwright-core';
import { expect, it } from 'vitest';
import { passTurns } from './at-rest.ts';
import { Choices } from './choices.ts';
import { changedPart } from './screenshot.ts';
import { CHEAPLY, press, type ViewerWindow, viewerHarness, viewerScreenshot } from './viewer-page.ts';

/** Panels are beside the picture. */
const WINDOW = { viewport: { width: 480, height: 320 } };
const OPERATIONS = 100;
/** Others choose a tool, a button that is on already, or select nothing. */
const LEAST_STEPS = 40;

/** A ring of splats in the colours of the rainbow around `x`, over a disc of grey ones. */
function ring(x: number): Uint8Array {
  const angles = Array.from({ length: 90 }, (_, i) => (2 * Math.PI * i) / 45);
  const isRing = (i: number) => i < 45;
  return encodePly(
    splatsFromArrays({
      positions: angles.flatMap((angle, i) => {
        const radius = isRing(i) ? 1 : 0.6;
        return [
          x + radius * Math.cos(angle),
          isRing(i) ? 0.3 * Math.sin(2 * angle) : 0.4,
          radius * Math.sin(angle),
        ];
      }),
      scales: new Float32Array(3 * angles.length).fill(0.12),
      colors: angles.flatMap((angle, i) =>
        isRing(i) ? [0.5 + 0.5 * Math.cos(angle), 0.5 + 0.5 * Math.sin(angle), 0.4] : [0.6, 0.6, 0.6],
      ),
    }),
  );
}

const { shareViewer } = viewerHarness({ 'a.ply': ring(-1), 'b.ply': ring(1) });

/** Keys that open panels with settings of the picture, by how often they are opened. */
const PANELS = ['v', 'v', 'e', 'e', 'e', 'n', 'n', '7', '7', '0', '0', 'c'] as const;
/** Keys that change the picture by themselves. */
const KEYS = ['u', 'm', 'm', 'r'] as const;

/** Buttons after which the camera, the page or the disk has changed, but no picture and no scene. */
const NO_CHANGES =
  /^(undo|redo|theme|fullscreen|fly|walk|outside|inside|focus-middle|annotate|add-files|show-path|play-.*|saved-view-\d+|measure.*|sweep|target-.*|.*-tab-.*|select-save.*|crop-save|floaters.*|ruler-middle|select-middle)$/;

/** A control of the open panel, and what is done with it. */
interface Handled {
  readonly testId: string;
  readonly kind: string;
}

/** For `evaluate`: handles the control at `pick` (0…1) of those that the open panel has, with a value at `part` of its range. */
function handleControl({
  pick,
  part,
  leftOut,
}: {
  pick: number;
  part: number;
  leftOut: string;
}): Handled | null {
  const isLeftOut = new RegExp(leftOut);
  const all = [...document.querySelectorAll<HTMLElement>('.dock :is(button, input, select)')].filter(
    (each) => {
      const { testid = '' } = each.dataset;
      const isOff = each.matches(':disabled') || each.getAttribute('aria-disabled') === 'true';
      return testid !== '' && !isOff && !isLeftOut.test(testid);
    },
  );
  // There are many more buttons than sliders and fields.
  const fields = all.filter((each) => each.matches('input:not([type=checkbox]), select'));
  const listed = fields.length > 0 && part < 0.5 ? fields : all;
  const control = listed[Math.floor(pick * listed.length)];
  if (!control) return null;
  const { testid: testId = '' } = control.dataset;
  control.focus();
  if (control instanceof HTMLButtonElement || control.matches('[type=checkbox]')) {
    control.click();
    return { testId, kind: 'click' };
  }
  const set = (value: string, event: string) => {
    const { prototype } = control instanceof HTMLSelectElement ? HTMLSelectElement : HTMLInputElement;
    Object.getOwnPropertyDescriptor(prototype, 'value')!.set!.call(control, value);
    control.dispatchEvent(new Event(event, { bubbles: true }));
  };
  if (control instanceof HTMLSelectElement) {
    set(control.options[Math.floor(part * control.options.length)].value, 'change');
    return { testId, kind: 'choice' };
  }
  const input = control as HTMLInputElement;
  // A drag passes other values.
  for (const way of [0.5, 1]) {
    const at = 0.5 + way * (part - 0.5);
    if (input.type === 'color')
      set(
        `#${Math.floor(at * 0xffffff)
          .toString(16)
          .padStart(6, '0')}`,
        'input',
      );
    else if (input.type === 'range')
      set(String(Number(input.min) + at * (Number(input.max) - Number(input.min))), 'input');
    else if (input.type === 'number') set(String(0.5 + at), 'input');
    else set(`a name ${part}`, 'input');
  }
  return { testId, kind: `${input.type} ${part.toFixed(2)}` };
}

/** Drags a handle of the picture, or a rectangle that selects. */
async function drag(page: Page, choices: Choices): Promise<string> {
  const handles = page.locator(':is(.axis-handle, .volume-handle):not([hidden])');
  const count = await handles.count();
  const box = count > 0 ? await handles.nth(choices.below(count)).boundingBox() : null;
  // Another drag would move the camera, which undo leaves where it is.
  if (!box) await page.keyboard.press('1');
  const from = box ? [box.x + box.width / 2, box.y + box.height / 2] : [40 + 60 * choices.next(), 90];
  await page.mouse.move(from[0], from[1]);
  await page.mouse.down();
  for (const step of [1, 2, 3]) await page.mouse.move(from[0] + 12 * step, from[1] + 9 * step);
  await page.mouse.up();
  return box ? 'drag of a handle' : 'rectangle';
}

async function operate(page: Page, choices: Choices): Promise<string> {
  const kind = choices.next();
  // Keys would be typed into a field.
  await blur(page);
  if (kind < 0.12) {
    const key = choices.of(KEYS);
    await page.keyboard.press(key);
    return `key ${key}`;
  }
  if (kind < 0.4 || (await page.locator('.dock').count()) === 0) {
    await closeDock(page);
    const panel = choices.of(PANELS);
    await page.keyboard.press(panel);
    await page.locator('.dock .dock-body').waitFor({ state: 'attached' });
    if (panel === 'c') await press(page, `accuracy-tab-${choices.of(['compare', 'settings'])}`);
  }
  if (kind > 0.9) return drag(page, choices);
  const [pick, part] = [choices.next(), choices.next()];
  const handled = await page.evaluate(handleControl, { pick, part, leftOut: NO_CHANGES.source });
  return handled ? `${handled.testId} (${handled.kind})` : 'nothing';
}

const blur = (page: Page) => page.evaluate(() => (document.activeElement as HTMLElement | null)?.blur());

async function closeDock(page: Page): Promise<void> {
  await blur(page);
  while ((await page.locator('.dock').count()) > 0) {
    await page.keyboard.press('Escape');
    await passTurns(page, 2);
  }
}

/** Takes all steps back, or makes them again; returns their names. */
async function step(page: Page, button: 'undo' | 'redo'): Promise<string[]> {
  await page.keyboard.press('0');
  await page.getByTestId(button).waitFor({ state: 'attached' });
  const names = await page.getByTestId(button).evaluate(async (element: HTMLElement) => {
    const made: string[] = [];
    while (element.getAttribute('aria-disabled') !== 'true') {
      made.push(element.textContent ?? '');
      element.click();
      await new Promise(requestAnimationFrame);
    }
    return made;
  });
  await closeDock(page);
  return names;
}

/** The picture at rest without any panel, and the address, which holds all that the picture depends on. */
async function seen(page: Page) {
  await closeDock(page);
  const read = () =>
    page.evaluate(() => {
      const { state } = document.documentElement.dataset;
      const { viewer } = window as unknown as ViewerWindow;
      // A file that was opened again is written with its whole address, behind the others.
      const parts = [...new URLSearchParams(location.search)].map(([name, value]) =>
        name === 'src' ? `src=${new URL(value, location.href)}` : `${name}=${value}`,
      );
      const address = parts.toSorted().join('&');
      return state === 'ready' && viewer?.isAtRest ? address : null;
    });
  await expect
    .poll(async () => {
      const before = await read();
      await passTurns(page, 40);
      return before !== null && before === (await read());
    })
    .toBe(true);
  const caption = await page.locator('.caption-figures').first().textContent();
  return { address: await read(), caption, image: await viewerScreenshot(page) };
}

/**
 * @fault Order: a person changes many things of a scene and its picture, and takes all of it back
 * @consequence the first picture again, bit for bit; after all was made again, the last one
 */
it('gives the first picture back after a hundred changes of all kinds, and then the last', async () => {
  const choices = new Choices();
  const address = `?src=a.ply&src=b.ply&${CHEAPLY}`;
  const page = await shareViewer(address, WINDOW);
  const first = await seen(page);
  const log: string[] = [];
  while (log.length < OPERATIONS) {
    log.push(await operate(page, choices));
    // Files that are opened again are changes, too.
    await page.locator('html[data-state=ready]').waitFor();
  }
  const last = await seen(page);
  const undone = await step(page, 'undo');
  const told = `seed ${choices.seed}, operations: ${log.join(', ')}; undone: ${undone.join(', ')}`;
  const back = await seen(page);
  expect(back.address, told).toBe(first.address);
  expect(back.caption, told).toBe(first.caption);
  expect(changedPart(first.image, back.image, 0), told).toBe(0);
  expect(undone.length, told).toBeGreaterThan(LEAST_STEPS);
  // The picture has been another one meanwhile.
  expect(changedPart(first.image, last.image, 0), told).toBeGreaterThan(0);
  expect(await step(page, 'redo')).toHaveLength(undone.length);
  const again = await seen(page);
  expect(again.address, told).toBe(last.address);
  expect(again.caption, told).toBe(last.caption);
  expect(changedPart(last.image, again.image, 0), told).toBe(0);
});

/**
 * @fault Order: a person changes an effect and the up axis, and presses Ctrl+Z
 * @consequence the newest change is taken back, not an older one; a drag of a slider is one step
 */
it('names each change of an effect, and takes a drag of its slider back at once', async () => {
  const page = await shareViewer(`?src=a.ply&${CHEAPLY}`, { viewport: { width: 1440, height: 300 } });
  const undo = page.getByTestId('command-undo');
  const labels = async (...expected: string[]) => {
    for (const label of expected) {
      await expect.poll(() => undo.getAttribute('aria-label')).toBe(label);
      await page.keyboard.press('Control+z');
    }
    await expect.poll(() => undo.isDisabled()).toBe(true);
  };
  const first = await seen(page);
  await page.keyboard.press('e');
  await press(page, 'switch-grade');
  const slider = page.getByTestId('grade-saturation');
  await slider.scrollIntoViewIfNeeded();
  const { x, y, width, height } = (await slider.boundingBox())!;
  await page.mouse.move(x + width / 2, y + height / 2);
  await page.mouse.down();
  for (const part of [0.6, 0.7, 0.8, 0.9]) await page.mouse.move(x + part * width, y + height / 2);
  await page.mouse.up();
  await page.mouse.move(x + width / 4, y + height / 2);
  await page.mouse.down();
  await page.mouse.up();
  await closeDock(page);
  await page.keyboard.press('u');
  await page.keyboard.press('v');
  await press(page, 'orthographic');
  await press(page, 'up-z');
  await closeDock(page);
  expect(changedPart(first.image, (await seen(page)).image)).toBeGreaterThan(0);
  await labels('Undo up axis', 'Undo projection', 'Undo up axis', 'Undo grade', 'Undo grade', 'Undo grade');
  const back = await seen(page);
  expect(back.address).toBe(first.address);
  expect(changedPart(first.image, back.image, 0)).toBe(0);
});

/**
 * @fault Order: a person tries the axes that may be up, and resets the view
 * @consequence the first view again, bit for bit, with no camera in the address
 */
it('resets the view to the very first, whichever axes were tried', async () => {
  const page = await shareViewer(`?src=a.ply&${CHEAPLY}`, WINDOW);
  const first = await seen(page);
  for (const axes of [['z', '-y'], ['z'], ['-z', 'y', 'z']]) {
    await page.keyboard.press('v');
    for (const axis of axes) await press(page, `up-${axis}`);
    await closeDock(page);
    await page.keyboard.press('ArrowRight');
    await page.waitForURL(/[?&]camera=/);
    await page.keyboard.press('r');
    const home = await seen(page);
    expect(home.address, axes.join()).toBe(first.address);
    expect(changedPart(first.image, home.image, 0), axes.join()).toBe(0);
  }
});
