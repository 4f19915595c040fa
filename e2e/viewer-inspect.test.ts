// Proves: a splat explained; measuring, selecting, cropping, saving.
import { readFile } from 'node:fs/promises';
import { readSplats, type SplatSet } from '@websplatter/core';
import { builtinScenes } from '@websplatter/scenes';
import type { Page } from 'playwright-core';
import { describe, expect, it } from 'vitest';
import { differing } from './screenshot.ts';
import {
  CHEAP,
  type DrawnCamera,
  drawnCamera,
  press,
  redraw,
  textOf,
  viewerHarness,
  viewerScreenshot,
} from './viewer-page.ts';

const { shareViewer } = viewerHarness();

/** Splats of the scene. */
const COUNT = 10_000;

/** Places of marks over the image. */
const marks = (page: Page, selector: string) =>
  page
    .getByTestId('inspect-marks')
    .evaluate((svg, wanted) => [...svg.querySelectorAll(wanted)].map((mark) => mark.outerHTML), selector);

/** The number that a text begins with. */
const countIn = async (page: Page, testId: string) =>
  Number((await textOf(page, testId)).replaceAll(',', '').match(/^\d+/)?.[0]);

const WINDOW = { width: 660, height: 490 };

/** Opens the panel on one of its tabs, without the figures, which hide a part of the picture. */
async function openInspect(
  tab: 'splat' | 'distance' | 'histogram' | 'select' | 'crop',
  address = CHEAP,
  hasTouch = false,
) {
  const page = await shareViewer(address, { viewport: WINDOW, hasTouch });
  await page.keyboard.press('h');
  await redraw(page, () => page.keyboard.press('i'));
  await page.getByTestId('inspect').waitFor();
  if (tab !== 'splat') await page.getByTestId(`inspect-tab-${tab}`).click();
  return page;
}

async function drag(page: Page, from: [number, number], to: [number, number]): Promise<void> {
  await page.mouse.move(...from);
  await page.mouse.down();
  await page.mouse.move(...to);
  await page.mouse.up();
}

/** Selects splats in a rectangle, and returns how many. */
async function selectInRectangle(page: Page): Promise<number> {
  await redraw(page, () => drag(page, [120, 250], [240, 350]));
  await expect.poll(() => countIn(page, 'select-count')).toBeGreaterThan(10);
  return countIn(page, 'select-count');
}

/** Saves by the panel that is open, and counts the splats of the file. */
async function savedCount(page: Page): Promise<number> {
  const [download] = await Promise.all([
    page.waitForEvent('download'),
    page.getByTestId('save-file').click(),
  ]);
  return (await readSplats(await readFile(await download.path()))).count;
}

type Point = readonly [number, number];
type Place = readonly [number, number, number];

/** The scene's rows, as its file has them. */
const rowsOfFile = async () =>
  readSplats(await readFile(builtinScenes.find(({ name }) => name === 'still-life-small')!.url));

const times = (m: readonly number[], [x, y, z]: Place): Place =>
  [0, 1, 2].map((row) => m[row] * x + m[4 + row] * y + m[8 + row] * z + m[12 + row]) as unknown as Place;

/** Centres as the camera sees them: right, up, back. */
function viewPlaces(
  { count, positions, origin }: Pick<SplatSet, 'count' | 'positions' | 'origin'>,
  { viewMatrix, modelMatrices }: DrawnCamera,
): Place[] {
  return Array.from({ length: count }, (_, i) => {
    const center = origin.map((value, axis) => value + positions[3 * i + axis]) as unknown as Place;
    return times(viewMatrix, modelMatrices[0] ? times(modelMatrices[0], center) : center);
  });
}

/** How many centres are in a polygon of the window, by the angles under which its sides are seen. */
async function countInPolygon(page: Page, corners: readonly Point[]): Promise<number> {
  const camera = await drawnCamera(page);
  const { projectionMatrix: p } = camera;
  const seen = viewPlaces(await rowsOfFile(), camera).filter(([, , back]) => back < 0);
  const places = seen.map(([x, y, z]): Point => {
    const [right, up] = [(p[0] * x + p[8] * z) / -z, (p[5] * y + p[9] * z) / -z];
    return [((1 + right) / 2) * WINDOW.width, ((1 - up) / 2) * WINDOW.height];
  });
  return places.filter(([x, y]) => {
    const angles = corners.map(([cornerX, cornerY]) => Math.atan2(cornerY - y, cornerX - x));
    const turns = angles.map((angle, i) => {
      const turn = angles[(i + 1) % angles.length] - angle;
      return Math.atan2(Math.sin(turn), Math.cos(turn));
    });
    return Math.abs(turns.reduce((a, b) => a + b)) > 1;
  }).length;
}

/** Goes on by the Tab key to the element. */
async function tabTo(page: Page, testId: string): Promise<void> {
  const focused = () => page.evaluate(() => (document.activeElement as HTMLElement).dataset.testid);
  for (let i = 0; i < 40 && (await focused()) !== testId; i++) await page.keyboard.press('Tab');
  expect(await focused()).toBe(testId);
}

describe('inspecting a scene in the viewer', () => {
  it('explains the splat that is clicked, outlines it while the scene turns, and finds it by its row', async () => {
    const page = await openInspect('splat');
    const rowShown = async () => Number((await textOf(page, 'inspect-row')).replace(/\D/g, ''));
    // Another frame, in which the splat itself has another colour.
    await redraw(page, () => page.mouse.click(180, 300));
    await page.getByTestId('inspect-position').waitFor();
    const row = await rowShown();
    expect(row).toBeLessThan(COUNT);
    expect(await page.getByTestId('inspect-colors').locator('tr').count()).toBe(4);
    await expect.poll(() => marks(page, 'circle.mark-line')).not.toEqual([]);
    const [ellipse] = await marks(page, 'circle.mark-line');
    expect(ellipse).toContain('matrix(');
    // A drag turns the scene and inspects nothing else; the outline follows.
    await redraw(page, () => drag(page, [180, 300], [240, 300]));
    expect(await rowShown()).toBe(row);
    await expect.poll(() => marks(page, 'circle.mark-line')).not.toEqual([ellipse]);
    // The same splat by its row.
    const position = await textOf(page, 'inspect-position');
    await page.getByTestId('inspect-row-input').fill('99999');
    await page.keyboard.press('Enter');
    await page.getByTestId('inspect-problem').getByText('no splat in row 99999').waitFor();
    await page.getByTestId('inspect-row-input').fill(String(row));
    await page.keyboard.press('Enter');
    await page.getByTestId('inspect-position').waitFor();
    expect(await textOf(page, 'inspect-position')).toBe(position);
  });

  it('counts every splat in a histogram, marks those of a bar, measures a distance, and keeps its label in place', async () => {
    const page = await openInspect('histogram');
    await page.getByTestId('histogram-opacity').waitFor();
    const table = page.getByTestId('histogram-opacity').locator('details');
    await table.locator('summary').click();
    const counts = await table.locator('td').allTextContents();
    expect(counts.map((count) => Number(count.replaceAll(',', ''))).reduce((a, b) => a + b)).toBe(COUNT);
    await redraw(page, () => page.getByTestId('mark-opacity').press('End'));
    await page
      .getByTestId('histogram-opacity')
      .getByText(`0.95 to 1: ${counts.at(-1)} splats`)
      .waitFor();
    await page.getByTestId('inspect-tab-select').click();
    await page.getByTestId('select-marked').click();
    await page
      .getByTestId('select-count')
      .getByText(`${counts.at(-1)} of 10,000 splats are selected`)
      .waitFor();

    await page.getByTestId('inspect-tab-distance').click();
    await page.mouse.click(150, 300);
    await page.getByTestId('ruler-hint').getByText('Click the other end').waitFor();
    await page.mouse.click(250, 330);
    await page.getByTestId('ruler-length').getByText('units').waitFor();
    await page.getByTestId('known-length').fill('2.5');
    await page.getByTestId('set-length').click();
    await page.getByTestId('length-scale').waitFor();
    expect(await textOf(page, 'ruler-length')).toBe('2.5 m');
    await expect.poll(() => marks(page, 'text')).toEqual([expect.stringContaining('2.5 m')]);
    const [label] = await marks(page, 'text');
    await page.keyboard.press('+');
    await expect.poll(() => marks(page, 'text')).not.toEqual([label]);
    // Rulers stay in the picture, whatever panel is open, until they are removed.
    await page.getByTestId('inspect-tab-select').click();
    await expect.poll(() => marks(page, '[data-mark=ruler]')).toHaveLength(2);
    await redraw(page, () => page.keyboard.press('Escape'));
    await page.getByTestId('inspect').waitFor({ state: 'detached' });
    expect(await page.getByTestId('inspect-marks').isVisible()).toBe(true);
    expect(await marks(page, 'text')).toEqual([expect.stringContaining('2.5 m')]);
    await page.keyboard.press('ControlOrMeta+z');
    await page.keyboard.press('ControlOrMeta+z');
    await page.getByTestId('inspect-marks').waitFor({ state: 'detached' });
  });

  it('selects splats in a rectangle without a turn of the scene, deselects under a brush, and undoes that', async () => {
    const page = await openInspect('select');
    const before = await viewerScreenshot(page);
    const camera = await drawnCamera(page);
    await page.mouse.move(120, 250);
    await page.mouse.down();
    await page.mouse.move(240, 350);
    expect(await marks(page, '[data-mark=region]')).toHaveLength(3);
    await redraw(page, () => page.mouse.up());
    expect(await marks(page, '[data-mark=region]')).toEqual([]);
    // The drag has turned nothing.
    expect(await drawnCamera(page)).toEqual(camera);
    await expect.poll(() => countIn(page, 'select-count')).toBeGreaterThan(10);
    await page
      .getByTestId('select-count')
      .getByText(/About \d+ % of them lie behind others/)
      .waitFor();
    expect(differing(await viewerScreenshot(page), before)).toBeGreaterThan(1000);

    const selected = await countIn(page, 'select-count');
    await page.getByTestId('select-brush').click();
    await page.keyboard.down('Alt');
    await drag(page, [130, 300], [230, 300]);
    await page.keyboard.up('Alt');
    await expect.poll(() => countIn(page, 'select-count')).toBeLessThan(selected);
    await page.getByTestId('undo').click();
    await expect.poll(() => countIn(page, 'select-count')).toBe(selected);
  });

  it('selects what is in a polygon of clicks, whose corners are taken back and given up by keys', async () => {
    const page = await openInspect('select');
    await page.getByTestId('select-polygon').click();
    const corners: readonly Point[] = [
      [110, 240],
      [250, 260],
      [190, 300],
      [230, 370],
    ];
    const camera = await drawnCamera(page);
    for (const corner of corners) await page.mouse.click(...corner);
    await page.mouse.click(60, 200);
    expect(await marks(page, '.mark-dot')).toHaveLength(5);
    await page.keyboard.press('Backspace');
    expect(await marks(page, '.mark-dot')).toHaveLength(4);
    expect(await marks(page, '[data-mark=region]')).toHaveLength(3);
    // Near the first one.
    await redraw(page, () => page.mouse.click(113, 236));
    const expected = await countInPolygon(page, corners);
    expect(expected).toBeGreaterThan(100);
    expect(await countIn(page, 'select-count')).toBe(expected);
    expect(await marks(page, '.mark-dot')).toEqual([]);
    // Nothing has turned the scene; Escape leaves the panel and the selection.
    expect(await drawnCamera(page)).toEqual(camera);
    await page.mouse.click(60, 200);
    await page.keyboard.press('Escape');
    expect(await marks(page, '.mark-dot')).toEqual([]);
    expect(await countIn(page, 'select-count')).toBe(expected);
    await redraw(page, () => page.getByTestId('undo').click());
    expect(await countIn(page, 'select-count')).toBe(0);
    await redraw(page, () => page.getByTestId('redo').click());
    expect(await countIn(page, 'select-count')).toBe(expected);
  });

  it('selects what is in a polygon by keys alone', async () => {
    const page = await shareViewer(CHEAP, { viewport: WINDOW });
    await page.keyboard.press('h');
    await page.keyboard.press('Control+k');
    await page.getByTestId('find-command').waitFor();
    await page.keyboard.type('polygon');
    await redraw(page, () => page.keyboard.press('Enter'));
    await page.getByTestId('select-polygon').waitFor();
    await tabTo(page, 'polygon-cross');
    const place = await page.getByTestId('polygon-cross').boundingBox();
    const [x, y] = [place!.x + place!.width / 2, place!.y + place!.height / 2];
    const camera = await drawnCamera(page);
    await page.keyboard.press('Space');
    await page.keyboard.press('Shift+ArrowRight');
    await page.keyboard.press('Space');
    for (const key of ['Shift+ArrowDown', 'ArrowDown', 'ArrowLeft']) await page.keyboard.press(key);
    await page.keyboard.press('Space');
    expect(await marks(page, '.mark-dot')).toHaveLength(3);
    await redraw(page, () => page.keyboard.press('Enter'));
    const expected = await countInPolygon(page, [
      [x, y],
      [x + 80, y],
      [x + 72, y + 88],
    ]);
    expect(expected).toBeGreaterThan(50);
    expect(await countIn(page, 'select-count')).toBe(expected);
    expect(await drawnCamera(page)).toEqual(camera);
  });

  it('selects what is in a polygon of taps', async () => {
    const page = await openInspect('select', CHEAP, true);
    await page.getByTestId('select-polygon').tap();
    const corners: readonly Point[] = [
      [110, 240],
      [250, 260],
      [230, 370],
    ];
    for (const corner of corners) await page.touchscreen.tap(...corner);
    // A finger is less exact.
    await redraw(page, () => page.touchscreen.tap(125, 228));
    expect(await countIn(page, 'select-count')).toBe(await countInPolygon(page, corners));
  });

  it('selects what is in a sphere around a splat, as far as a drag or a number reaches', async () => {
    // A pixel of the image is one of the window.
    const page = await openInspect('splat', CHEAP.replace('0.25', '1'));
    const [x, y]: Point = [180, 300];
    await redraw(page, () => page.mouse.click(x, y));
    await page.getByTestId('inspect-position').waitFor();
    const row = Number((await textOf(page, 'inspect-row')).replace(/\D/g, ''));
    await redraw(page, () => page.getByTestId('inspect-tab-select').click());
    await page.keyboard.press('4');
    const before = await drawnCamera(page);
    const [p0, p5, p8, p9] = [0, 5, 8, 9].map((i) => before.projectionMatrix[i]);
    const places = viewPlaces(await rowsOfFile(), before);
    const depth = -places[row][2];
    const center: Place = [
      (depth * ((2 * (x + 0.5)) / WINDOW.width - 1 + p8)) / p0,
      (depth * (1 - (2 * (y + 0.5)) / WINDOW.height + p9)) / p5,
      -depth,
    ];
    const countWithin = (radius: number) =>
      places.filter((place) => Math.hypot(...place.map((value, axis) => value - center[axis])) <= radius)
        .length;
    const radius = async () => Number(await page.getByTestId('select-radius').inputValue());
    await page.mouse.move(x, y);
    await page.mouse.down();
    await page.mouse.move(x + 30, y + 10);
    await page.mouse.move(x + 30, y + 40);
    await expect.poll(() => marks(page, '[data-mark=sphere]')).toHaveLength(2);
    await redraw(page, () => page.mouse.up());
    expect(await drawnCamera(page)).toEqual(before);
    const dragged = await radius();
    expect(dragged).toBeCloseTo((50 * 2 * depth) / (WINDOW.height * p5), 3);
    expect(await marks(page, '.mark-label')).toEqual([expect.stringContaining(`${dragged} units`)]);
    expect(await countIn(page, 'select-count')).toBe(countWithin(dragged));
    // None of them is so near the surface that float32 matters.
    expect(countWithin(dragged * (1 + 1e-5))).toBe(countWithin(dragged * (1 - 1e-5)));
    const wider = 1.5 * dragged;
    await redraw(page, () => page.getByTestId('select-radius').fill(String(wider)));
    expect(countWithin(wider)).toBeGreaterThan(countWithin(dragged));
    expect(await countIn(page, 'select-count')).toBe(countWithin(wider));
    // Both are one step.
    await redraw(page, () => page.getByTestId('undo').click());
    expect(await countIn(page, 'select-count')).toBe(0);
    expect(await marks(page, '[data-mark=sphere]')).toEqual([]);
  });

  it('selects splats of about one colour, and counts floaters before it selects them and adds another kind', async () => {
    const page = await openInspect('select');
    await page.getByTestId('select-color').click();
    await redraw(page, () => page.mouse.click(180, 300));
    const color = (await textOf(page, 'select-base-color')).split(',').map(Number);
    const { colorDc, opacityLogits, logScales, count } = await rowsOfFile();
    const bytes = Array.from(colorDc, (value) =>
      Math.round(255 * Math.min(1, Math.max(0, 0.5 + value * Math.sqrt(1 / (4 * Math.PI))))),
    );
    const countOfTolerance = (tolerance: number) =>
      Array.from({ length: count }, (_, i) => bytes.slice(3 * i, 3 * i + 3)).filter((each) =>
        each.every((channel, k) => Math.abs(channel - color[k]) <= tolerance),
      ).length;
    expect(countOfTolerance(0)).toBeGreaterThan(0);
    expect(await countIn(page, 'select-count')).toBe(countOfTolerance(16));
    for (const tolerance of [17, 18]) {
      await redraw(page, () => page.getByTestId('select-tolerance').press('ArrowRight'));
      expect(await countIn(page, 'select-count')).toBe(countOfTolerance(tolerance));
    }
    // Those of another colour are added with Shift.
    const selected = await countIn(page, 'select-count');
    await page.keyboard.down('Shift');
    await redraw(page, () => page.mouse.click(92, 325));
    await page.keyboard.up('Shift');
    expect(await countIn(page, 'select-count')).toBeGreaterThan(selected);

    await redraw(page, () => page.getByTestId('select-none').click());
    const rows = Array.from({ length: count }, (_, i) => i);
    const opacity = (i: number) => 1 / (1 + Math.exp(-opacityLogits[i]));
    const isNeedle = (i: number, ratio: number) => {
      const [, middle, longest] = logScales.slice(3 * i, 3 * i + 3).sort();
      return longest - middle >= Math.log(ratio);
    };
    await page.getByTestId('floaters').click();
    await page.getByTestId('floaters-faint').click();
    await page.getByTestId('floaters-limit').fill('60');
    const faint = rows.filter((i) => opacity(i) <= 0.6);
    expect(faint.length).toBeGreaterThan(10);
    const would = (found: number, left = count) =>
      page
        .getByTestId('floaters-count')
        .getByText(`Would select ${found.toLocaleString('en')} of ${left.toLocaleString('en')} splats.`)
        .waitFor();
    await would(faint.length);
    expect(await countIn(page, 'select-count')).toBe(0);
    await redraw(page, () => page.getByTestId('floaters-select').click());
    expect(await countIn(page, 'select-count')).toBe(faint.length);
    await page.getByTestId('select-mode-add').click();
    await page.getByTestId('floaters-needle').click();
    await page.getByTestId('floaters-limit').fill('0');
    const needles = rows.filter((i) => isNeedle(i, 2));
    await would(needles.length);
    const both = new Set([...faint, ...needles]).size;
    expect(both).toBeGreaterThan(faint.length);
    await redraw(page, () => page.getByTestId('floaters-select').click());
    expect(await countIn(page, 'select-count')).toBe(both);
    // Removed splats are found no more.
    await redraw(page, () => page.keyboard.press('Delete'));
    await would(0, count - both);
    await page.getByTestId('floaters-far').click();
    await page.getByTestId('floaters-count').getByText('Would select').waitFor();
  });

  it('removes what is selected and brings it back by keys, makes it a file of its own, and saves either', async () => {
    const page = await openInspect('select');
    const before = await viewerScreenshot(page);
    const selected = await selectInRectangle(page);
    const removal = page
      .getByTestId('select-count')
      .getByText(`${selected.toLocaleString('en')} splats removed`);
    await redraw(page, () => page.keyboard.press('Delete'));
    await removal.waitFor();
    await redraw(page, () => page.keyboard.press('ControlOrMeta+z'));
    expect(await countIn(page, 'select-count')).toBe(selected);
    await redraw(page, () => page.keyboard.press('ControlOrMeta+Shift+z'));
    await removal.waitFor();
    expect(differing(await viewerScreenshot(page), before)).toBeGreaterThan(1000);
    await page.getByTestId('select-save-left').click();
    await page.getByTestId('save-edited').waitFor();
    expect(await savedCount(page)).toBe(COUNT - selected);
    await page.keyboard.press('0');
    await redraw(page, () => page.getByTestId('undo').click());
    await redraw(page, () => page.getByTestId('select-none').click());
    expect(differing(await viewerScreenshot(page), before)).toBe(0);

    // The file of its own is moved by handles.
    await selectInRectangle(page);
    await page.getByTestId('select-split').click();
    await page.getByTestId('gizmo-y').waitFor();
    await redraw(page, () => page.getByTestId('gizmo-y').press('Shift+ArrowUp'));
    expect(
      differing(await viewerScreenshot(page, '.axis-handles { visibility: hidden }'), before),
    ).toBeGreaterThan(1000);
    await page.keyboard.press('x');
    await page.getByTestId('save-tab-file').click();
    // Splats that have moved are saved once.
    expect(await savedCount(page)).toBe(COUNT);
    await redraw(page, () => page.keyboard.press('ControlOrMeta+z'));
    await redraw(page, () => page.keyboard.press('ControlOrMeta+z'));
  });

  it('crops to a box or to what is around it, saves what stays, and moves faces by handles, pointer and keys', async () => {
    const page = await openInspect('crop');
    const whole = await viewerScreenshot(page);
    await redraw(page, () => page.getByTestId('crop-begin').click());
    // The box begins around everything.
    await page.getByTestId('crop-count').getByText('10,000 of 10,000 splats stay').waitFor();
    expect(differing(await viewerScreenshot(page), whole)).toBe(0);
    await redraw(page, () => page.getByTestId('crop-max-x').press('PageDown'));
    await expect.poll(() => marks(page, '[data-mark=box]')).toHaveLength(2);
    await redraw(page, () => page.getByTestId('crop-max-x-number').fill('0'));
    const cropCount = page.getByTestId('crop-count');
    await cropCount.getByText('splats stay').waitFor();
    const kept = await countIn(page, 'crop-count');
    expect(kept).toBeLessThan(COUNT);
    expect(differing(await viewerScreenshot(page), whole)).toBeGreaterThan(1000);
    await redraw(page, () => page.getByTestId('crop-outside').click());
    await cropCount.getByText(`${(COUNT - kept).toLocaleString('en')} of 10,000 splats stay`).waitFor();
    await page.getByTestId('crop-save').click();
    await page.getByTestId('save-cropped').waitFor();
    expect(await savedCount(page)).toBe(COUNT - kept);

    // What is removed inside of the crop is not left either, and all say the same number.
    await page.keyboard.press('1');
    await drag(page, [100, 60], [200, 200]);
    await expect.poll(() => countIn(page, 'select-count')).toBeGreaterThan(0);
    const selected = await countIn(page, 'select-count');
    const left = (COUNT - kept - selected).toLocaleString('en');
    await page.keyboard.press('Delete');
    await expect.poll(() => textOf(page, 'select-count')).toContain(`0 of ${left} splats are selected`);
    await page.keyboard.press('7');
    await cropCount.getByText(`${left} of 10,000 splats stay`).waitFor();
    await page.locator('.caption-figures', { hasText: `${left} of 10,000 splats` }).waitFor();
    await page.keyboard.press('h');
    await press(page, 'hud-more');
    await expect.poll(() => textOf(page, 'left-splats')).toBe(left);
    await page.keyboard.press('h');

    // The crop outlives its panel, and ends with a click.
    await redraw(page, () => page.getByTestId('crop-end').click());
    await expect.poll(() => marks(page, '[data-mark=box]')).toEqual([]);

    // Handles in the picture; each step is undone.
    await redraw(page, () => page.getByTestId('crop-begin').click());
    // Faces around everything lie outside of this picture.
    await redraw(page, () => page.getByTestId('crop-to-subject').click());
    const maxX = async () => Number(await page.getByTestId('crop-max-x-number').inputValue());
    const begun = await maxX();
    const handle = page.getByTestId('crop-handle-max-x');
    const mark = (await handle.locator('span').boundingBox())!;
    const [x, y] = [mark.x + mark.width / 2, mark.y + mark.height / 2];
    await page.mouse.move(x, y);
    await page.mouse.down();
    // Two steps of one drag, towards the middle of the box.
    await redraw(page, () => page.mouse.move(x - 20, y));
    await redraw(page, () => page.mouse.move(x - 40, y));
    await page.mouse.up();
    const dragged = await maxX();
    expect(dragged).toBeLessThan(begun);
    // It has the keyboard now.
    await redraw(page, () => page.keyboard.press('Shift+ArrowRight'));
    expect(await maxX()).toBeGreaterThan(dragged);
    await redraw(page, () => page.keyboard.press('ControlOrMeta+z'));
    expect(await maxX()).toBe(dragged);
    await redraw(page, () => page.getByTestId('undo').click());
    expect(await maxX()).toBe(begun);
  });
});
