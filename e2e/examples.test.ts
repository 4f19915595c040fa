// Proves: each example runs and does what it says.
import { encodePly, perspectiveCamera, type SplatSet, type Vec3 } from '@websplatter/core';
import { brightness, opacity, tint, type Volume, volumes } from '@websplatter/core/effects';
import type { EffectReference } from '@websplatter/core/reference';
import { splatNode, splatOpacity } from '@websplatter/three/tsl';
import { LONG_PATIENCE_MS } from '@websplatter/tools/patience';
import type { BrowserContextOptions, Page } from 'playwright-core';
import { afterEach, describe, expect, it } from 'vitest';
import { ring } from '../apps/examples/scenes/ring.ts';
import { windSway } from '../apps/examples/src/effects/wind-sway.ts';
import { windSwayReference } from '../apps/examples/src/effects/wind-sway-reference.ts';
import { atRest, passTurns } from './at-rest.ts';
import { appHarness } from './harness.ts';
import { drawnBy, MIN_PSNR_DB, type ReferenceEffects, referenceImage } from './reference.ts';
import { changedPart, colorsIn, type Screenshot, screenshot } from './screenshot.ts';
import { slowDisplay } from './slow-display.ts';
import { decoded, encoded } from './srgb.ts';
import { testScene } from './test-scene.ts';
import { splatSet } from './three/splats.ts';
import type { DrawnCamera } from './viewer-page.ts';

/** Scenes for which tests have others. Routing pages would turn off Chromium's caches of compiled scripts. */
const SCENES = ['still-life.sog', 'figures.ply', 'knot.ply', 'meadow.ply', 'terrain.ply'];
const served: Record<string, Uint8Array | null> = {};
const serveScenes = (bytes: Uint8Array | null) => {
  for (const name of SCENES) served[name] = bytes;
};
serveScenes(null);
const harness = appHarness('apps/examples', served, slowDisplay);

afterEach(() => {
  serveScenes(null);
  harness.server.answerFiles('send', /^/);
});

/** For screenshots: SwiftShader draws these pages at a few frames per second. */
const SELDOM = { interval: 250 };

/** Pages are small, since SwiftShader takes its time for every pixel. */
const SMALL = { viewport: { width: 240, height: 160 } };
/** For clicks that a panel would cover on a small page. */
const LARGE = { viewport: { width: 480, height: 320 } };

/** Colour of the page behind a canvas in the light theme. */
const PAGE_COLOR = [0xf4 / 255, 0xf5 / 255, 0xf7 / 255] as const;

/** Opens the page of an example, with `scene` in place of its own. */
function openExample(name: string, scene: SplatSet, size: BrowserContextOptions = SMALL): Promise<Page> {
  serveScenes(encodePly(scene));
  return harness.openShared(`?example=${name}`, size);
}

/** Takes a screenshot of the canvas without its controls, even before it has its final size. */
function image(page: Page): Promise<Screenshot> {
  return screenshot(page.locator('.stage'), '.panel, .view-names { visibility: hidden !important; }');
}

/** More colours than a page has without its splats, whose labels and edges of meshes have some hundred. */
const COLORS_OF_SPLATS = 1_000;

/**
 * The image once it shows splats and is alike before and after 15 frames: temporal effects come to rest
 * after frames. The empty page is alike, too, while a file loads or shaders compile.
 */
async function settled(page: Page): Promise<Screenshot> {
  let last = await image(page);
  const colors = async () => {
    last = await image(page);
    return colorsIn(last);
  };
  await expect.poll(colors, SELDOM).toBeGreaterThan(COLORS_OF_SPLATS);
  const change = async () => {
    const before = last;
    // On a busy machine, two pictures in a row may show the same frame.
    await passTurns(page);
    last = await image(page);
    return changedPart(before, last, 2);
  };
  await expect.poll(change, SELDOM).toBeLessThan(0.01);
  return last;
}

/** Clicks on the canvas until `isDone`. */
async function clickUntil(page: Page, x: number, y: number, isDone: () => Promise<boolean>): Promise<void> {
  const click = async () => {
    await page.locator('canvas').click({ position: { x, y } });
    return isDone();
  };
  await expect.poll(click, SELDOM).toBe(true);
}

type Size = Pick<Screenshot, 'widthPx' | 'heightPx'>;

const sizeOf = async (page: Page): Promise<Size> => image(page);

/** The reference over the page's colour, without transforms; by default from the usual position. */
function drawnFrom(
  position: Vec3,
  { widthPx, heightPx }: Size,
  { target = [0, 0, 0], fovYDegrees = 50, near = 0.05, far = 1000 }: Partial<CameraOptions> = {},
): DrawnCamera {
  const aspect = widthPx / heightPx;
  const camera = perspectiveCamera({ position, target, fovYDegrees, aspect, near, far });
  return drawnBy(camera, [...PAGE_COLOR]);
}

interface CameraOptions {
  readonly target: Vec3;
  readonly fovYDegrees: number;
  readonly near: number;
  readonly far: number;
}

/** Column-major: a scaling, then a turn about x, then a move along x. */
function modelMatrix(x: number, angleX = 0, scale: Vec3 = [1, 1, 1]): number[] {
  const [sine, cosine] = [Math.sin(angleX), Math.cos(angleX)];
  const columns = [
    [scale[0], 0, 0, 0],
    [0, scale[1] * cosine, scale[1] * sine, 0],
    [0, -scale[2] * sine, scale[2] * cosine, 0],
    [x, 0, 0, 1],
  ];
  return columns.flat();
}

function colorAt({ widthPx, data }: Screenshot, xPx: number, yPx: number): number[] {
  const offset = 4 * (Math.round(yPx) * widthPx + Math.round(xPx));
  return [...data.subarray(offset, offset + 3)];
}

describe('examples', () => {
  it('are listed, reached by keyboard, and show their source', async () => {
    const page = await harness.openShared('');
    const links = page.getByRole('listitem').getByRole('link');
    await expect.poll(() => links.count()).toBe(48);
    const hrefs = await links.evaluateAll((list) => list.map((link) => link.getAttribute('href')));
    await page.keyboard.press('Tab');
    await page.keyboard.press('Enter');
    await page.waitForURL(`**/${hrefs[0]}`);
    await expect.poll(() => page.title()).toContain('A first splat');
    await page.getByRole('button', { name: 'Source' }).click();
    const source = page.getByRole('dialog');
    await source.getByText('export default function FirstSplat').waitFor();
    await page.keyboard.press('Escape');
    await source.waitFor({ state: 'hidden' });
    await page.getByRole('link', { name: 'Examples' }).click();
    await links.first().waitFor();
    await page.goto(`${harness.server.url}?example=second-splat`);
    expect(await page.getByRole('alert').textContent()).toContain('second-splat');
  });

  it('say what is missing where there is no WebGPU', async () => {
    const withoutGpu = () => Object.defineProperty(Navigator.prototype, 'gpu', { get: () => undefined });
    const page = await harness.sharedPage({}, [withoutGpu]);
    // React logs the error that a boundary has caught.
    harness.expectProblem(/WebGpuUnavailableError/);
    await page.goto(`${harness.server.url}?example=first-splat`);
    expect(await page.getByRole('alert').textContent()).toContain('WebGPU');
  });

  it('first-splat shows the file as the float64 reference does', async () => {
    const page = await openExample('first-splat', testScene());
    const size = await sizeOf(page);
    const psnrDb = referenceImage(drawnFrom([0.12, 0.45, 1.44], size), [testScene()], size);
    await expect.poll(async () => psnrDb(await image(page)), SELDOM).toBeGreaterThanOrEqual(MIN_PSNR_DB);
  });

  it('mesh-through-splats: a mesh in front hides splats, one behind shows through', async () => {
    // A sheet of white fog through the middle of the ball's path.
    const page = await openExample('mesh-through-splats', splatSet([{ opacity: 0.5 }]));
    const size = await sizeOf(page);
    const camera = drawnFrom([0.1, 0.35, 1.5], size);
    const ballColorAt = async (z: number) => {
      await page.getByRole('slider').evaluate((slider: HTMLInputElement, value) => {
        slider.value = String(value);
      }, z);
      const { xPx, yPx } = projected(camera, [0, 0.18, z], size);
      return async () => colorAt(await image(page), xPx, yPx);
    };
    const inFront = await ballColorAt(0.5);
    await expect.poll(inFront, SELDOM).toSatisfy(([red, green]) => red > 1.5 * green);
    const bare = await inFront();
    const veiled = bare.map((value) => 0.5 * value + 0.5 * 255);
    await expect
      .poll(await ballColorAt(-0.5), SELDOM)
      .toSatisfy((color: number[]) => color.every((value, i) => Math.abs(value - veiled[i]) < 12));
  });

  it('two-clouds sorts both as one, each with its transform and opacity', async () => {
    const page = await openExample('two-clouds', testScene());
    const size = await sizeOf(page);
    const drawn: DrawnCamera = {
      ...drawnFrom([0, 1.3, 4], size, { near: 0.1 }),
      modelMatrices: [modelMatrix(-0.55), modelMatrix(0.55, Math.PI / 2, [-0.85, 0.85, 0.85])],
    };
    const psnrAs = (changes: Partial<DrawnCamera> = {}) => {
      const psnrDb = referenceImage({ ...drawn, ...changes }, [ring(), ring()], size);
      return async () => psnrDb(await image(page));
    };
    await expect.poll(psnrAs(), SELDOM).toBeGreaterThanOrEqual(MIN_PSNR_DB);
    // Make sure that the comparison can fail: with the second ring not mirrored, it does.
    const unmirrored = [drawn.modelMatrices[0], modelMatrix(0.55, Math.PI / 2, [0.85, 0.85, 0.85])];
    expect(await psnrAs({ modelMatrices: unmirrored })()).toBeLessThan(MIN_PSNR_DB);

    await page.getByRole('slider').fill('0.5');
    await expect.poll(psnrAs({ opacities: [1, 0.5] }), SELDOM).toBeGreaterThanOrEqual(MIN_PSNR_DB);
  });

  it('picking says which splat was clicked and puts a marker on it', async () => {
    const scale = [0.08, 0.08, 0.08] as const;
    const opacity = 0.97;
    const rows: Vec3[] = [
      [0.3, 0.1, 0],
      // Behind the row that comes after it, as the camera sees it.
      [-0.12, -0.45, -1.44],
      [0, 0, 0],
      [-0.3, 0, 0.2],
    ];
    const page = await openExample(
      'picking',
      splatSet(rows.map((position) => ({ position, scale, opacity, color: [0, 0.3, 0.6] }))),
      LARGE,
    );
    const size = await sizeOf(page);
    const camera = drawnFrom([0.12, 0.45, 1.44], size);
    await expect
      .poll(async () => colorAt(await image(page), size.widthPx / 2, size.heightPx / 2), SELDOM)
      .toSatisfy(([red, , blue]) => blue > red + 60);
    for (const row of [2, 0, 3]) {
      const { xPx, yPx, depthView } = projected(camera, rows[row], size);
      // Rays miss splats for a moment after the first frame.
      const found = page.getByText(`Row ${row} · depth ${depthView.toFixed(3)}`);
      await clickUntil(page, xPx, yPx, () => found.isVisible());
      await expect
        .poll(async () => colorAt(await image(page), xPx, yPx), SELDOM)
        .toSatisfy(([red, green, blue]) => red > 200 && green < 120 && blue < 200);
    }
  });

  it('labels hides one while splats lie before it', async () => {
    const page = await openExample('labels', splatSet([{ opacity: 0.98, position: [0, 0, 0.2] }]));
    await page.getByText('Above the table').waitFor({ state: 'attached' });
    const areShown = () =>
      Promise.all(['Before', 'Behind'].map((where) => page.getByText(`${where} the vase`).isVisible()));
    await expect.poll(areShown, SELDOM).toEqual([true, false]);
  });

  it('demand-loop draws one frame for each that is asked for, and none besides', async () => {
    const page = await openExample('demand-loop', testScene());
    const frames = async () => Number(await page.locator('output').textContent());
    await expect.poll(async () => new Set((await image(page)).data).size, SELDOM).toBeGreaterThan(100);
    // Shaders and data request frames when they become ready.
    const before = await atRest(page, frames);
    await passTurns(page, 60);
    expect(await frames()).toBe(before);
    const shotAtRest = await image(page);
    for (const more of [1, 2, 3]) {
      await page.getByRole('button', { name: 'Draw one more' }).click();
      expect(await atRest(page, frames)).toBe(before + more);
    }
    expect(changedPart(shotAtRest, await image(page), 0)).toBe(0);
  });

  it('suspense shows a placeholder and a progress bar until the file is there', async () => {
    harness.server.answerFiles('hold', /^still-life/);
    const page = await openExample('suspense', testScene());
    const bar = page.getByRole('progressbar', { name: 'Loading still-life.sog' });
    await bar.waitFor();
    const pageColor = PAGE_COLOR.map((value) => 255 * value);
    await expect.poll(async () => part(await image(page), pageColor), SELDOM).toBeLessThan(0.99);
    harness.server.answerFiles('send', /^/);
    await bar.waitFor({ state: 'detached' });
    const size = await sizeOf(page);
    const psnrDb = referenceImage(drawnFrom([0.12, 0.45, 1.44], size), [testScene()], size);
    await expect.poll(async () => psnrDb(await image(page)), SELDOM).toBeGreaterThanOrEqual(MIN_PSNR_DB);
  });

  it('accuracy takes settings by name, or an outcome, and says what it chose for that and why', async () => {
    // Splats so small that half the resolution does not suffice.
    const scale = [0.01, 0.01, 0.01] as const;
    const positions = Array.from({ length: 25 }, (_, i): Vec3 => [(i % 5) / 5 - 0.4, i / 25 - 0.4, 0]);
    const color = [0.1, 0.2, 0.4] as const;
    const scene = splatSet(positions.map((position) => ({ position, scale, color, opacity: 0.9 })));
    const page = await openExample('accuracy', scene);
    const size = await sizeOf(page);
    const psnrDb = referenceImage(drawnFrom([0.12, 0.45, 1.44], size), [scene], size);
    const shownDb = async () => psnrDb(await image(page));
    await expect.poll(shownDb, SELDOM).toBeGreaterThanOrEqual(MIN_PSNR_DB);
    const request = page.getByRole('combobox', { name: 'Accuracy' });
    await request.selectOption('Half the resolution');
    await expect.poll(shownDb, SELDOM).toBeLessThan(MIN_PSNR_DB);
    await request.selectOption('At least 45 dB');
    const why = page.getByRole('status');
    expect(await why.textContent()).toContain('Measuring');
    await expect
      .poll(() => why.textContent(), { ...SELDOM, timeout: LONG_PATIENCE_MS })
      .toMatch(/^Of \d+ settings measured, .*45 dB.*: .* in .* ms/);
    await expect.poll(shownDb, SELDOM).toBeGreaterThanOrEqual(44);
    await request.selectOption('Balanced');
    await why.waitFor({ state: 'detached' });
    await expect.poll(shownDb, SELDOM).toBeGreaterThanOrEqual(MIN_PSNR_DB);
  });

  it('several-views shows each camera its own image', async () => {
    const page = await openExample('several-views', testScene());
    const positions: Vec3[] = [
      [0.1, 0.45, 1.5],
      [-1.45, 0.5, 0.6],
      [0, 1.8, 0.3],
    ];
    const { widthPx, heightPx } = await sizeOf(page);
    const size = { widthPx: widthPx / positions.length, heightPx };
    const views = positions.map((position) => {
      const camera = { target: [0, 0.2, 0] as const, fovYDegrees: 45, far: 400 };
      return referenceImage(drawnFrom(position, size, camera), [testScene()], size);
    });
    const worstPsnrDb = async () => {
      const shot = await image(page);
      const strips = views.map((_, i) => columnsOf(shot, i * size.widthPx, size.widthPx));
      return Math.min(...views.map((psnrDb, i) => psnrDb(strips[i])));
    };
    await expect.poll(worstPsnrDb, SELDOM).toBeGreaterThanOrEqual(MIN_PSNR_DB);
  });
});

describe('examples of effects', () => {
  /** Opens an example with the test scene; returns its PSNR against the scene with effects. */
  async function openWithTestScene(name: string) {
    const page = await openExample(name, testScene());
    const size = await sizeOf(page);
    const psnrWith = (effects: ReferenceEffects = {}) => {
      const psnrDb = referenceImage(drawnFrom([0.12, 0.45, 1.44], size), [testScene()], size, effects);
      return async () => psnrDb(await image(page));
    };
    return { page, psnrWith };
  }

  it('colour takes a tint, a brightness, an opacity and a degree', async () => {
    const { page, psnrWith } = await openWithTestScene('colour');
    const evening = psnrWith({ effects: [tint([1, 0xb2 / 255, 0x7a / 255])] });
    await expect.poll(evening, SELDOM).toBeGreaterThanOrEqual(MIN_PSNR_DB);
    await page.getByLabel('Tint').fill('#ff8000');
    await page.getByLabel('Brightness').fill('1');
    await page.getByLabel('Opacity').fill('0.5');
    const effects = [opacity(0.5), brightness(2), tint([1, 128 / 255, 0])];
    await expect.poll(psnrWith({ effects }), SELDOM).toBeGreaterThanOrEqual(MIN_PSNR_DB);
    const before = await image(page);
    await page.getByLabel('depend on the view').uncheck();
    const changed = async () => changedPart(before, await image(page), 2);
    await expect.poll(changed, SELDOM).toBeGreaterThan(0.01);
    await page.getByLabel('depend on the view').check();
    await expect.poll(changed, SELDOM).toBe(0);
  });

  it('fade hides the insides of a cloud, which show between splats of a low opacity', async () => {
    const [green, red, stripe] = [
      [0, 255, 0],
      [255, 0, 0],
      [0x20, 0x32, 0x4f],
    ];
    const opacity = 0.98;
    const sheet = { scale: [0.3, 0.3, 0.001], opacity } as const;
    const front = { ...sheet, color: [0, 1, 0] } as const;
    const behind = { ...sheet, color: [1, 0, 0], position: [0, 0, -0.1] } as const;
    const page = await openExample('fade', splatSet([front, behind]));
    const size = await sizeOf(page);
    const camera = drawnFrom([0, 0, 2.1], size);
    const middles = [-0.65, 0.65].map((x) => projected(camera, [x, 0, 0], size));
    const over = (color: number[], alpha: number, background: number[]) =>
      color.map((value, i) => alpha * value + (1 - alpha) * background[i]);
    const bothSheets = (alpha: number) => over(green, alpha, over(red, alpha, stripe));
    for (const share of [0.35, 1, 0.6, 0]) {
      await page.getByRole('slider').fill(`${share}`);
      const expected = [bothSheets(share * opacity), over(bothSheets(opacity), share, stripe)].flat();
      const largestError = async () => {
        const shot = await image(page);
        const colors = middles.flatMap(({ xPx, yPx }) => colorAt(shot, xPx, yPx));
        return Math.max(...colors.map((value, i) => Math.abs(value - expected[i])));
      };
      await expect.poll(largestError, SELDOM).toBeLessThan(6);
    }
  });

  it('clip cuts off what lies beyond a plane, or within a ball', async () => {
    const { page, psnrWith } = await openWithTestScene('clip');
    const plane = {
      shape: 'plane',
      mode: 'keep',
      point: [0.2, 0, 0],
      normal: [-1, 0, 0],
      softEdge: 0.05,
    } as const;
    const cut = psnrWith({ effects: [volumes([plane])] });
    await expect.poll(cut, SELDOM).toBeGreaterThanOrEqual(MIN_PSNR_DB);
    await page.getByLabel('Volume').selectOption('Sphere');
    await page.getByLabel('Size').fill('0.8');
    await page.getByLabel('Keep the outside').check();
    const ball = { shape: 'sphere', mode: 'hide', center: [0, 0.2, 0], radius: 0.8, softEdge: 0.05 } as const;
    const outside = psnrWith({ effects: [volumes([ball])] });
    await expect.poll(outside, SELDOM).toBeGreaterThanOrEqual(MIN_PSNR_DB);
  });

  it('volumes erase, lift and light what is in them', async () => {
    const { page, psnrWith } = await openWithTestScene('volumes');
    const list = (softEdge: number): Volume[] => [
      { shape: 'sphere', mode: 'hide', radius: 0.09, center: [-0.24, 0.07, 0.22], softEdge },
      {
        ...{ shape: 'capsule', mode: 'displace', offset: [0, 0.2, 0] },
        ...{ radius: 0.08, height: 0.2, center: [0.02, 0.19, -0.29] },
      },
      {
        ...{ shape: 'ellipsoid', mode: 'tint', tint: [1.9, 0.9, 0.6], softEdge: 0.05 },
        ...{ size: [0.3, 0.4, 0.3], center: [-0.2, 0.15, -0.15] },
      },
    ];
    await expect
      .poll(psnrWith({ effects: [volumes(list(0.02))] }), SELDOM)
      .toBeGreaterThanOrEqual(MIN_PSNR_DB);
    await page.getByLabel('soft edge').fill('0.2');
    await expect
      .poll(psnrWith({ effects: [volumes(list(0.2))] }), SELDOM)
      .toBeGreaterThanOrEqual(MIN_PSNR_DB);
  });

  it('reveal ends with the whole scene, every time', async () => {
    const { page, psnrWith } = await openWithTestScene('reveal');
    const whole = psnrWith();
    // With reduced motion it appears at once.
    await expect.poll(whole, SELDOM).toBeGreaterThanOrEqual(MIN_PSNR_DB);
    // A screenshot may take longer than all of it.
    const begun = async () => {
      await page.getByRole('button', { name: 'Again' }).click();
      return whole();
    };
    await expect.poll(begun, { interval: 20 }).toBeLessThan(MIN_PSNR_DB);
    await expect.poll(whole, SELDOM).toBeGreaterThanOrEqual(MIN_PSNR_DB);
  });

  it('selection highlights what lies around the splat that was clicked', async () => {
    const scale = [0.05, 0.05, 0.05] as const;
    const rows: Vec3[] = [
      [0, 0, 0],
      [0.05, 0, 0],
      [-0.4, 0, 0],
    ];
    const page = await openExample(
      'selection',
      splatSet(rows.map((position) => ({ position, scale, opacity: 0.97, color: [0, 0.3, 0.6] }))),
      LARGE,
    );
    const size = await sizeOf(page);
    const camera = drawnFrom([0.12, 0.45, 1.44], size);
    const redAt = async (row: number) => {
      const { xPx, yPx } = projected(camera, rows[row], size);
      return colorAt(await image(page), xPx, yPx)[0];
    };
    await expect.poll(() => redAt(2), SELDOM).toBeLessThan(40);
    const { xPx, yPx } = projected(camera, rows[0], size);
    await clickUntil(page, xPx, yPx, () => page.getByText('2 selected').isVisible());
    await expect.poll(() => redAt(0), SELDOM).toBeGreaterThan(150);
    expect(await redAt(2)).toBeLessThan(40);
    await page.getByRole('button', { name: 'Clear' }).click();
    await expect.poll(() => redAt(0), SELDOM).toBeLessThan(40);
  });

  it('hide-parts makes whole figures faint, by checkboxes and by clicks', async () => {
    const page = await harness.openShared('?example=hide-parts', LARGE);
    const faintRows = (count: string) => page.getByText(`${count} rows are faint`).waitFor();
    // A figure has 2,600 splats.
    await faintRows('7,800');
    const boxes = page.getByRole('checkbox');
    const areChecked = () => boxes.evaluateAll((all) => all.map((box) => (box as HTMLInputElement).checked));
    expect(await areChecked()).toEqual([true, false, true, false, false, true, true]);
    const before = await settled(page);
    const changed = async () => changedPart(before, await image(page));
    await boxes.nth(0).uncheck();
    await faintRows('10,400');
    await expect.poll(changed, SELDOM).toBeGreaterThan(0.02);
    const click = async () => {
      // Another click would undo the first, which may have come late.
      if (await boxes.nth(0).isChecked()) return true;
      // On the head of the first figure. Rays miss splats for a moment after each edit.
      await page.locator('canvas').click({ position: { x: 85, y: 130 } });
      await passTurns(page);
      return boxes.nth(0).isChecked();
    };
    await expect.poll(click, SELDOM).toBe(true);
    await faintRows('7,800');
    await expect.poll(changed, SELDOM).toBe(0);
  });

  it('fog hides splats, or meshes alone', async () => {
    const page = await openExample(
      'fog',
      splatSet([{ color: [0, 0, 0], opacity: 0.98, position: [0, 0, -1] }]),
    );
    const green = async () => colorAt(await image(page), 100, 10)[1];
    await expect.poll(green, SELDOM).toBeGreaterThan(150);
    await page.getByLabel('Splats, too').uncheck();
    await expect.poll(green, SELDOM).toBeLessThan(40);
  });

  it('shadows: a splat casts one on the floor', async () => {
    const scale = [0.08, 0.08, 0.08] as const;
    const page = await openExample(
      'shadows',
      splatSet([{ scale, opacity: 0.98, position: [-0.3, 0.2, 0.35] }]),
    );
    const size = await sizeOf(page);
    const camera = drawnFrom([0, 0.75, 2], size, { target: [0, 0, 0.35], fovYDegrees: 40 });
    // 0.36 below the splat, away from a sun at 1.93, 2, 2.29.
    const { xPx, yPx } = projected(camera, [-0.65, -0.16, -0.06], size);
    const red = async () => colorAt(await image(page), xPx, yPx)[0];
    await expect.poll(red, SELDOM).toBeLessThan(175);
    await page.getByLabel('Splats, too').uncheck();
    await expect.poll(red, SELDOM).toBeGreaterThan(185);
  });

  it('relight: the lamp lights a splat beside it, and less from afar', async () => {
    const scale = [0.04, 0.04, 0.001] as const;
    const page = await openExample(
      'relight',
      splatSet([{ scale, opacity: 0.98, position: [-0.3, 0.1, 0.5] }]),
    );
    const size = await sizeOf(page);
    const camera = drawnFrom([0, 0.75, 2], size, { target: [0, 0, 0.35], fovYDegrees: 40 });
    const { xPx, yPx } = projected(camera, [-0.3, 0.1, 0.5], size);
    const red = async () => colorAt(await image(page), xPx, yPx)[0];
    const set = (label: string, value: string) => page.getByRole('slider', { name: label }).fill(value);
    await expect.poll(red, SELDOM).toBeGreaterThan(240);
    await set('Lamp', '0.6');
    await expect.poll(red, SELDOM).toBeLessThan(160);
    await set('Relight', '0');
    await expect.poll(red, SELDOM).toBeGreaterThan(240);
  });

  it('depth-write hides the ring behind splats', async () => {
    const page = await openExample('depth-write', splatSet([{ opacity: 0.98, position: [0, 0, -0.2] }]));
    const size = await sizeOf(page);
    const { xPx, yPx } = projected(drawnFrom([0.12, 0.45, 1.44], size), [-0.2, 0.222, -0.278], size);
    const red = async () => colorAt(await image(page), xPx, yPx)[0];
    await expect.poll(red, SELDOM).toBeGreaterThan(240);
    await page.getByLabel('Splats hide').uncheck();
    await expect.poll(red, SELDOM).toBeLessThan(200);
  });

  it('own-data moves the splats that it made, and hides some', async () => {
    const page = await openExample('own-data', splatSet([]));
    const covered = async () =>
      1 -
      part(
        await image(page),
        PAGE_COLOR.map((value) => 255 * value),
      );
    await expect.poll(covered, SELDOM).toBeGreaterThan(0.15);
    const still = await image(page);
    await page.getByLabel('Moving').check();
    await expect.poll(async () => changedPart(still, await image(page)), SELDOM).toBeGreaterThan(0.05);
    await page.getByLabel('Moving').uncheck();
    await page.getByRole('slider').fill('0.25');
    await expect.poll(covered, SELDOM).toBeLessThan(0.1);
    expect(await covered()).toBeGreaterThan(0.02);
  });

  it('gpu-particles shows two galaxies, whose stars move', async () => {
    const page = await harness.openShared('?example=gpu-particles', SMALL);
    /** Parts of the picture with the colours of one galaxy and of the other. */
    const parts = async () => {
      const { data } = await image(page);
      let [orange, blue] = [0, 0];
      for (let i = 0; i < data.length; i += 4) {
        if (data[i] > data[i + 2] + 60) orange++;
        if (data[i + 2] > data[i] + 60) blue++;
      }
      return [orange, blue].map((count) => (4 * count) / data.length);
    };
    await expect.poll(async () => Math.min(...(await parts())), SELDOM).toBeGreaterThan(0.01);
    const still = await image(page);
    await page.getByLabel('Moving').check();
    await expect.poll(async () => changedPart(still, await image(page)), SELDOM).toBeGreaterThan(0.02);
  });

  it('text-and-image shows a picture, and letters before it', async () => {
    const page = await harness.openShared('?example=text-and-image', SMALL);
    /** Parts of the picture with the colours of the sky, of the hills and of the letters. */
    const parts = async () => {
      const { data } = await image(page);
      const isHere = (test: (r: number, g: number, b: number) => boolean) => {
        let count = 0;
        for (let i = 0; i < data.length; i += 4) if (test(data[i], data[i + 1], data[i + 2])) count++;
        return (4 * count) / data.length;
      };
      return {
        sky: isHere((r, g, b) => r > 200 && r - b > 70 && g < 180),
        hills: isHere((r, g, b) => r < 110 && g < 80 && b < 110),
        letters: isHere((r, g, b) => r > 240 && g > 215 && b > 150 && b < 190),
      };
    };
    await expect.poll(async () => (await parts()).letters, SELDOM).toBeGreaterThan(0.02);
    const { sky, hills } = await parts();
    expect(sky).toBeGreaterThan(0.05);
    expect(hills).toBeGreaterThan(0.08);
  });

  it('instances draws figures in colours of their own, which move', async () => {
    const page = await harness.openShared('?example=instances', SMALL);
    const greens = async () => {
      const { data } = await image(page);
      let count = 0;
      for (let i = 0; i < data.length; i += 4) if (data[i + 1] > data[i] + 50) count++;
      return count / (data.length / 4);
    };
    await expect.poll(greens, SELDOM).toBeGreaterThan(0.02);
    const still = await image(page);
    await page.getByLabel('Moving').check();
    await expect.poll(async () => changedPart(still, await image(page)), SELDOM).toBeGreaterThan(0.05);
  });

  it('moving-scene shows a fountain at a time, which plays on', async () => {
    const page = await harness.openShared('?example=moving-scene', SMALL);
    await page.getByRole('slider').fill('0.3');
    const first = await settled(page);
    await page.getByRole('slider').fill('0.34');
    await expect.poll(async () => changedPart(first, await image(page)), SELDOM).toBeGreaterThan(0.02);
    await page.getByRole('slider').fill('0.3');
    await expect.poll(async () => changedPart(first, await image(page)), SELDOM).toBe(0);
    await page.getByLabel('Playing').check();
    await expect.poll(async () => changedPart(first, await image(page)), SELDOM).toBeGreaterThan(0.02);
  });

  it('moments shows a firework that is larger from cloud to cloud, or the same spark in all', async () => {
    const page = await harness.openShared('?example=moments', LARGE);
    const size = await sizeOf(page);
    const camera = drawnFrom([0, 0, 4.2], size, { fovYDegrees: 45 });
    /** Parts of narrow strips through the five middles that are not night. */
    const covered = async () => {
      const shot = await image(page);
      return [0, 1, 2, 3, 4].map((i) => {
        const { xPx } = projected(camera, [0.95 * i - 2.05, 0, 0], size);
        return 1 - part(columnsOf(shot, Math.round(xPx) - 1, 2), [0x0b, 0x12, 0x30]);
      });
    };
    const least = async () => Math.min(...(await covered()));
    const growth = async () => {
      const parts = await covered();
      return Math.min(...parts.slice(1).map((each, i) => each - parts[i]));
    };
    await page.getByRole('slider').fill('0.17');
    await expect.poll(growth, SELDOM).toBeGreaterThan(0.02);
    await page.getByRole('slider').fill('0');
    const spread = async () => Math.max(...(await covered())) - (await least());
    await expect.poll(spread, SELDOM).toBeLessThan(0.01);
    expect(await least()).toBeGreaterThan(0.01);
  });

  it('morph unrolls a globe into a map, which is wider, and moves by itself', async () => {
    const page = await harness.openShared('?example=morph', SMALL);
    const background = PAGE_COLOR.map((value) => 255 * value);
    const coveredWidth = async () => {
      const shot = await image(page);
      const isCovered = (xPx: number) => part(columnsOf(shot, xPx, 1), background) < 0.9;
      return Array.from({ length: shot.widthPx }, (_, xPx) => xPx).filter(isCovered).length / shot.widthPx;
    };
    await expect.poll(coveredWidth, SELDOM).toBeGreaterThan(0.3);
    const globe = await coveredWidth();
    await page.getByRole('slider').fill('1');
    await expect.poll(coveredWidth, SELDOM).toBeGreaterThan(1.3 * globe);
    const map = await image(page);
    await page.getByLabel('Moving').check();
    await expect.poll(async () => changedPart(map, await image(page)), SELDOM).toBeGreaterThan(0.05);
  });

  it('bones bend an arm of splats to the side that is chosen, and move by themselves', async () => {
    const page = await harness.openShared('?example=bones', SMALL);
    const background = PAGE_COLOR.map((value) => 255 * value);
    /** Middle of what is drawn, as a part of the width. */
    const middle = async () => {
      const shot = await image(page);
      const columns = Array.from({ length: shot.widthPx }, (_, xPx) => xPx);
      const covered = columns.filter((xPx) => part(columnsOf(shot, xPx, 1), background) < 0.98);
      return covered.reduce((sum, xPx) => sum + xPx, 0) / covered.length / shot.widthPx;
    };
    await page.getByRole('slider').fill('-1');
    await expect.poll(middle, SELDOM).toBeLessThan(0.55);
    const left = await middle();
    await page.getByRole('slider').fill('1');
    await expect.poll(middle, SELDOM).toBeGreaterThan(left + 0.1);
    const right = await image(page);
    await page.getByLabel('Moving').check();
    await expect.poll(async () => changedPart(right, await image(page)), SELDOM).toBeGreaterThan(0.02);
  });

  it('depth-of-field blurs pawns that are out of focus, and none without an aperture', async () => {
    const page = await harness.openShared('?example=depth-of-field', SMALL);
    const [focus, aperture] = [0, 1].map((at) => page.getByRole('slider').nth(at));
    const blurred = await settled(page);
    await focus.fill('1.4');
    await expect.poll(async () => changedPart(blurred, await image(page)), SELDOM).toBeGreaterThan(0.03);
    await aperture.fill('0');
    const sharp = await settled(page);
    expect(changedPart(blurred, sharp)).toBeGreaterThan(0.03);
    await focus.fill('0.6');
    await passTurns(page);
    expect(changedPart(sharp, await image(page))).toBe(0);
  });

  it('scroll-focus moves the focus from the first flowers to the last, and back', async () => {
    const page = await harness.openShared('?example=scroll-focus', SMALL);
    const first = await settled(page);
    /** Contrast of the last flowers' heads, at the top of the picture, and of the first ones'. */
    const contrasts = async () => {
      const shot = await image(page);
      return { last: contrast(shot, 0.15, 0.3), first: contrast(shot, 0.6, 0.7) };
    };
    const before = await contrasts();
    // Over the panel, which lets wheels through.
    await page.mouse.move(120, 100);
    await page.mouse.wheel(0, 10_000);
    await expect.poll(async () => (await contrasts()).last, SELDOM).toBeGreaterThan(1.25 * before.last);
    await expect.poll(async () => (await contrasts()).first, SELDOM).toBeLessThan(0.85 * before.first);
    await page.mouse.wheel(0, -10_000);
    await expect.poll(async () => changedPart(first, await image(page)), SELDOM).toBeLessThan(0.01);
  });

  it('exploded-view lifts layers, each from where those above have moved', async () => {
    const page = await openExample('exploded-view', testScene());
    const size = await sizeOf(page);
    const camera = drawnFrom([0.6, 0.75, 2.1], size, { target: [0, 0.32, 0] });
    const lifted = [0.29, 0.16, 0.06, -0.01].map(
      (height): Volume => ({
        ...{ shape: 'plane', point: [0, height, 0], normal: [0, 1, 0] },
        ...{ mode: 'displace', offset: [0, 0.12, 0] },
      }),
    );
    const psnrWith = (effects: ReferenceEffects = {}) => {
      const psnrDb = referenceImage(camera, [testScene()], size, effects);
      return async () => psnrDb(await image(page));
    };
    await expect.poll(psnrWith({ effects: [volumes(lifted)] }), SELDOM).toBeGreaterThanOrEqual(MIN_PSNR_DB);
    await page.getByRole('slider').fill('0');
    await expect.poll(psnrWith(), SELDOM).toBeGreaterThanOrEqual(MIN_PSNR_DB);
  });

  it('spring draws the light to another figure, where it comes to rest', async () => {
    const page = await openExample('spring', testScene(), { ...SMALL, reducedMotion: 'no-preference' });
    const size = await sizeOf(page);
    const camera = drawnFrom([0, 0.4, 1.9], size, { fovYDegrees: 40 });
    const lit = (figure: number) => {
      const angle = (figure / 6 - 0.5) * 2.2;
      const light: Volume = {
        ...{ shape: 'capsule', radius: 0.11, height: 0.25, softEdge: 0.06, invert: true },
        ...{ center: [0.62 * Math.sin(angle), 0.03, 0.75 - 0.62 * Math.cos(angle)] },
        ...{ mode: 'tint', tint: [0.2, 0.2, 0.28] },
      };
      const psnrDb = referenceImage(camera, [testScene()], size, { effects: [volumes([light])] });
      return async () => psnrDb(await image(page));
    };
    await expect.poll(lit(2), SELDOM).toBeGreaterThanOrEqual(MIN_PSNR_DB);
    await page.getByRole('slider').fill('3');
    await expect.poll(lit(3), SELDOM).toBeGreaterThanOrEqual(MIN_PSNR_DB);
  });

  it('tractor-beam lifts what is below the saucer, wherever it is', async () => {
    const page = await harness.openShared('?example=tractor-beam', SMALL);
    const flowers = async (from: number, to: number) => {
      const { widthPx, heightPx, data } = await image(page);
      let count = 0;
      // A strip between the saucer and the tops of flowers that stand.
      for (let y = Math.round(0.36 * heightPx); y < 0.4 * heightPx; y++)
        for (let x = Math.round(from * widthPx); x < to * widthPx; x++) {
          const [red, green, blue] = data.subarray(4 * (y * widthPx + x));
          if (Math.max(red, green, blue) - Math.min(red, green, blue) > 60) count++;
        }
      return count;
    };
    await expect.poll(() => flowers(0.4, 0.6), SELDOM).toBeGreaterThan(10);
    expect(await flowers(0.65, 0.95)).toBeLessThan(5);
    await page.getByRole('slider').fill('0.5');
    await expect.poll(() => flowers(0.65, 0.95), SELDOM).toBeGreaterThan(10);
  });

  it('x-ray draws the knot over the mountain, or inside of it', async () => {
    const page = await harness.openShared('?example=x-ray', SMALL);
    const magenta = async () => {
      const { data } = await image(page);
      let count = 0;
      for (let i = 0; i < data.length; i += 4)
        if (data[i] > data[i + 1] + 80 && data[i + 2] > data[i + 1] + 80) count++;
      return count;
    };
    await expect.poll(magenta, SELDOM).toBeGreaterThan(50);
    await page.getByRole('checkbox').uncheck();
    await expect.poll(magenta, SELDOM).toBeLessThan(5);
  });

  it('text-dust settles to a word', async () => {
    const page = await harness.openShared('?example=text-dust', SMALL);
    const orange = async () => {
      const { data } = await image(page);
      let count = 0;
      for (let i = 0; i < data.length; i += 4) if (data[i] > data[i + 2] + 60) count++;
      return count;
    };
    await expect.poll(orange, SELDOM).toBeGreaterThan(30);
    await page.getByRole('slider').fill('1');
    await expect.poll(orange, SELDOM).toBe(0);
    await page.getByRole('button', { name: 'Play' }).click();
    await expect.poll(orange, SELDOM).toBeGreaterThan(30);
    await expect.poll(() => page.getByRole('slider').inputValue(), SELDOM).toBe('1');
  });

  it('ripples: a drop makes waves', async () => {
    const page = await harness.openShared('?example=ripples', SMALL);
    const before = await settled(page);
    await page.getByRole('button', { name: 'A drop' }).click();
    await expect.poll(async () => changedPart(before, await image(page)), SELDOM).toBeGreaterThan(0.05);
  });

  it('tsl-storage: a click sets a glider where it is, by the row of the splat', async () => {
    const page = await harness.openShared('?example=tsl-storage', LARGE);
    const glowing = async () => {
      const { widthPx, data } = await image(page);
      const found: [xPx: number, yPx: number][] = [];
      for (let i = 0; i < data.length / 4; i++)
        if (data[4 * i] > 150 && data[4 * i] > data[4 * i + 2] + 60)
          found.push([i % widthPx, Math.floor(i / widthPx)]);
      return found;
    };
    const count = async () => (await glowing()).length;
    await expect.poll(count, SELDOM).toBeGreaterThan(500);
    await page.getByRole('button', { name: 'Clear' }).click();
    await expect.poll(count, SELDOM).toBe(0);
    const size = await sizeOf(page);
    for (const point of [
      [0.3, 0.42, 0.95],
      [-0.9, 0.42, 0.3],
    ] as const) {
      const { xPx, yPx } = projected(drawnFrom([0, 2.05, 2.5], size), point, size);
      await clickUntil(page, xPx, yPx, async () => (await count()) > 20);
      // Five cells lie side by side only if each splat reads the value of its own row.
      for (const [x, y] of await glowing()) expect(Math.hypot(x - xPx, y - yPx)).toBeLessThan(40);
      await page.getByRole('button', { name: 'Clear' }).click();
      await expect.poll(count, SELDOM).toBe(0);
    }
  });

  it('sequence shows the frame that is chosen, and plays on from it', async () => {
    const page = await harness.openShared('?example=sequence', SMALL);
    await page.getByText('1 of 8').waitFor();
    const first = await settled(page);
    const changed = async () => changedPart(first, await image(page));
    await page.getByRole('slider').fill('4');
    await page.getByText('5 of 8').waitFor();
    await expect.poll(changed, SELDOM).toBeGreaterThan(0.05);
    await page.getByRole('button', { name: 'Play' }).click();
    // Any frame before the chosen one: a busy machine may show the first for a moment only.
    await page.getByText(/^[1-4] of 8$/).waitFor();
    await page.getByRole('button', { name: 'Pause' }).click();
  });

  it('frames-file plays one file, before a row of its frames', async () => {
    const page = await harness.openShared('?example=frames-file', SMALL);
    await page.getByText('1 of 24').waitFor();
    const first = await settled(page);
    const changed = async () => changedPart(first, await image(page));
    await page.getByRole('slider').fill('12');
    await page.getByText('13 of 24').waitFor();
    await expect.poll(changed, SELDOM).toBeGreaterThan(0.03);
    await page.getByRole('button', { name: 'Play' }).click();
    await page.getByText(/^([1-9]|1[0-2]) of 24$/).waitFor();
    await page.getByRole('button', { name: 'Pause' }).click();
  });

  it('annotations: labels hide behind splats, and two clicks measure', async () => {
    // A sheet before everything but the table's front.
    const sheet = splatSet([{ opacity: 0.98, position: [0, 0.1, 0.2], scale: [0.5, 0.5, 0.001] }]);
    const page = await openExample('annotations', sheet, LARGE);
    const labels = page.getByRole('main').getByRole('button');
    await expect.poll(() => labels.allInnerTexts(), SELDOM).toEqual(['Table']);
    const canvas = page.locator('canvas');
    await canvas.click({ position: { x: 200, y: 100 } });
    await page.getByText('First point set.').waitFor({ state: 'attached' });
    await canvas.click({ position: { x: 280, y: 100 } });
    await page.getByText(/^Measured: \d+\.\d cm\.$/).waitFor();
    await labels.first().click();
    await page.getByText('Chosen: Table.').waitFor();
  });

  it('colliders: a worker makes a mesh, on which a ball falls', async () => {
    const page = await harness.sharedPage(SMALL);
    serveScenes(encodePly(splatSet([{ opacity: 0.98, position: [0, 0, 0], scale: [0.5, 0.005, 0.5] }])));
    // Rapier is WebAssembly, which a page has to allow.
    const address = `${harness.server.url}?example=colliders`;
    await page.route(address, async (route) => {
      const response = await route.fetch();
      const headers = response.headers();
      const policy = headers['content-security-policy'].replace(
        'script-src',
        "script-src 'wasm-unsafe-eval'",
      );
      await route.fulfill({ response, headers: { ...headers, 'content-security-policy': policy } });
    });
    await page.goto(address);
    await page.getByText(/^[\d,]+ triangles$/).waitFor();
    await page.getByRole('button', { name: 'Drop a ball' }).click();
    await passTurns(page);
  });

  it('wind-sway does what its reference in float64 does', async () => {
    const { page, psnrWith } = await openWithTestScene('wind-sway');
    await page.getByRole('slider').fill('0.2');
    const effects = [windSway({ amplitude: 0.2, timeS: 0, ground: -0.3, tall: 0.8 })];
    const swayed = psnrWith({ effects, effectReferences: { 'wind-sway': windSwayReference } });
    await expect.poll(swayed, SELDOM).toBeGreaterThanOrEqual(MIN_PSNR_DB);
    await page.getByRole('slider').fill('0');
    await expect.poll(swayed, SELDOM).toBeLessThan(MIN_PSNR_DB - 10);
  });

  it('tsl-texture throws the panes of a window onto splats where its light falls', async () => {
    // A white floor.
    const scale = [0.03, 0.001, 0.03] as const;
    const floor = Array.from({ length: 41 ** 2 }, (_, i): Vec3 => {
      return [0.045 * ((i % 41) - 20), 0, 0.045 * (Math.floor(i / 41) - 20)];
    });
    const scene = splatSet(floor.map((position) => ({ position, scale, opacity: 0.98 })));
    const page = await openExample('tsl-texture', scene, LARGE);
    await page.getByRole('slider').fill('1');
    const size = await sizeOf(page);
    const camera = drawnFrom([0.12, 0.65, 1.4], size, { target: [0, 0.15, 0] });
    const slideSize = { widthPx: 512, heightPx: 512 };
    const projector = drawnFrom([0.35, 1.25, 1.25], slideSize, { target: [0, 0.12, 0], fovYDegrees: 42 });
    /** Place on the screen of the floor's splat that is nearest to the middle of an outer pane. */
    const placeOf = (pane: number) => {
      const angle = ((pane + 0.5) * Math.PI) / 6;
      const [x, y] = [256 + 205 * Math.cos(angle), 256 + 205 * Math.sin(angle)];
      const distance = (position: Vec3) => {
        const { xPx, yPx } = projected(projector, position, slideSize);
        return Math.hypot(xPx - x, yPx - y);
      };
      return projected(camera, floor.toSorted((a, b) => distance(a) - distance(b))[0], size);
    };
    // From red over yellow and green to cyan.
    const places = [0, 1, 2, 3, 4, 5, 6].map(placeOf);
    const largestError = async () => {
      const shot = await image(page);
      const hues = places.map(({ xPx, yPx }) => hueOf(colorAt(shot, xPx, yPx)));
      return Math.max(...hues.map((hue, pane) => Math.abs(hue - 30 * pane)));
    };
    await expect.poll(largestError, SELDOM).toBeLessThan(15);
    await page.getByLabel('Turning').check();
    await expect.poll(largestError, SELDOM).toBeGreaterThan(30);
  });

  it('post-processing focuses on what is near or far, and glows', async () => {
    const page = await openExample('post-processing', testScene());
    const slider = (name: string) => page.getByRole('slider', { name });
    const background = PAGE_COLOR.map((value) => 255 * value);
    const covered = async () => 1 - part(await image(page), background);
    await expect.poll(covered, SELDOM).toBeGreaterThan(0.2);
    await slider('Glow').fill('0');
    await slider('Focus').fill('0.8');
    const near = await settled(page);
    const changed = async () => changedPart(near, await image(page), 2);
    await slider('Focus').fill('2.2');
    await expect.poll(changed, SELDOM).toBeGreaterThan(0.05);
    await slider('Focus').fill('0.8');
    await expect.poll(changed, SELDOM).toBeLessThan(0.02);
    await slider('Glow').fill('1');
    await expect.poll(changed, SELDOM).toBeGreaterThan(0.05);
  });

  it('detail shows all splats, or fewer', async () => {
    const { page, psnrWith } = await openWithTestScene('detail');
    await page.getByRole('slider').fill('0');
    await expect.poll(psnrWith(), SELDOM).toBeGreaterThanOrEqual(MIN_PSNR_DB);
    await page.getByRole('slider').fill('8');
    await expect.poll(psnrWith(), SELDOM).toBeLessThan(MIN_PSNR_DB);
  });

  it('file-drop shows the file that a visitor chooses, or why it cannot', async () => {
    const page = await harness.openShared('?example=file-drop', LARGE);
    await page.getByText('ring.ply: 6,000 splats').waitFor();
    const choose = (name: string, buffer: Buffer) =>
      page.getByLabel('A file of splats').setInputFiles({ name, mimeType: '', buffer });
    await choose('sphere.ply', Buffer.from(encodePly(testScene())));
    await page.getByText('sphere.ply: 400 splats').waitFor();
    await choose('readme.txt', Buffer.from('hello'));
    await page.getByText(/readme\.txt: .* no known format/).waitFor();
  });

  it('gltf-scene shows a ring of splats around a mesh', async () => {
    const page = await harness.openShared('?example=gltf-scene', SMALL);
    const size = await sizeOf(page);
    const camera = drawnFrom([1.2, 1.1, 2.6], size);
    const colorOf = async (point: Vec3) => {
      const { xPx, yPx } = projected(camera, point, size);
      return colorAt(await image(page), xPx, yPx);
    };
    // Coloured in front of the column, which is grey above it.
    const spread = async (point: Vec3) => {
      const color = await colorOf(point);
      return Math.max(...color) - Math.min(...color);
    };
    await expect.poll(() => spread([0.4, 0.1, 0.9]), SELDOM).toBeGreaterThan(100);
    expect(await spread([0.08, 0.6, 0.14])).toBeLessThan(30);
  });

  it('nodes do what their references in float64 do', async () => {
    const { page, psnrWith } = await openWithTestScene('nodes');
    // Any use of nodes: the reference stands for the page's.
    const use = splatNode({ opacity: splatOpacity });
    for (const [name, reference] of Object.entries(NODE_TWINS)) {
      await page.getByLabel('Effect', { exact: true }).selectOption(name);
      await page.getByRole('slider').fill('1');
      const alike = psnrWith({ effects: [use], effectReferences: { [use.effect.name]: () => reference } });
      await expect.poll(alike, SELDOM).toBeGreaterThanOrEqual(MIN_PSNR_DB);
      await page.getByRole('slider').fill('0');
      await expect.poll(alike, SELDOM).toBeLessThan(MIN_PSNR_DB);
    }
  });
});

/** What the example's nodes do to the test scene at the full amount and a time of 0, in float64. */
const NODE_TWINS: Readonly<Record<string, EffectReference>> = {
  Wind: {
    changeSplat({ position: [x, y, z], ...splat }) {
      return { ...splat, position: [x + 0.2 * Math.sin(6 * x) * smooth((y - 0.3) / 0.4), y, z] };
    },
  },
  Reveal: {
    changeSplat({ opacity: whole, logScales: [a, b, c], ...splat }) {
      const shown = smooth((1.5 - Math.hypot(...splat.position)) / 0.4);
      const growth = Math.log(shown);
      return { ...splat, opacity: whole * shown, logScales: [a + growth, b + growth, c + growth] };
    },
  },
  Lamp: {
    changeColor(color, { position: [x, y, z] }) {
      const near = 0.3 / ((x - 0.45) ** 2 + (y - 0.55) ** 2 + z ** 2 + 0.05);
      const glow = [0xff, 0xd9, 0xa0].map(decoded);
      const lit = color.map((value, i) => encoded(decoded(255 * value) * (near * glow[i] + 0.05)));
      return [lit[0] / 255, lit[1] / 255, lit[2] / 255];
    },
  },
};

/** Hermite interpolation from 0 at 0 to 1 at 1. */
function smooth(value: number): number {
  const t = Math.min(1, Math.max(0, value));
  return t * t * (3 - 2 * t);
}

/** Share of the pixels that have a given colour, within 2 of 255. */
function part({ data }: Screenshot, color: readonly number[]): number {
  let count = 0;
  for (let i = 0; i < data.length; i += 4)
    if (color.every((value, c) => Math.abs(data[i + c] - value) <= 2)) count++;
  return count / (data.length / 4);
}

/** Hue of a colour, in degrees: red 0, green 120, blue 240; −60 to 300. */
function hueOf([red, green, blue]: readonly number[]): number {
  const most = Math.max(red, green, blue);
  const range = most - Math.min(red, green, blue);
  if (most === red) return (60 * (green - blue)) / range;
  if (most === green) return 120 + (60 * (blue - red)) / range;
  return 240 + (60 * (red - green)) / range;
}

/** Mean change of the green channel from pixel to pixel, in a part of the rows of an image. */
function contrast({ widthPx, heightPx, data }: Screenshot, from: number, to: number): number {
  const rows = [Math.round(from * heightPx), Math.round(to * heightPx)];
  const [start, end] = rows.map((row) => 4 * widthPx * row);
  let sum = 0;
  for (let i = start + 1; i < end - 4; i += 4) sum += Math.abs(data[i + 4] - data[i]);
  return (4 * sum) / (end - start);
}

/** A vertical strip of an image. */
function columnsOf({ widthPx, heightPx, data }: Screenshot, xPx: number, stripWidthPx: number): Screenshot {
  const strip = new Uint8Array(4 * stripWidthPx * heightPx);
  for (let y = 0; y < heightPx; y++) {
    const start = 4 * (y * widthPx + xPx);
    strip.set(data.subarray(start, start + 4 * stripWidthPx), 4 * y * stripWidthPx);
  }
  return { widthPx: stripWidthPx, heightPx, data: strip };
}

/** Projects a point: CSS pixels from the top left, and its depth. */
function projected(
  { viewMatrix: v, projectionMatrix: p }: DrawnCamera,
  [x, y, z]: Vec3,
  { widthPx, heightPx }: Size,
): { xPx: number; yPx: number; depthView: number } {
  const [xView, yView, zView] = [0, 1, 2].map(
    (row) => v[row] * x + v[4 + row] * y + v[8 + row] * z + v[12 + row],
  );
  const depthView = -zView;
  return {
    xPx: ((p[0] * xView) / depthView / 2 + 0.5) * widthPx,
    yPx: (0.5 - (p[5] * yView) / depthView / 2) * heightPx,
    depthView,
  };
}
