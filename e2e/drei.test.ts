// Proves: six components of drei work beside splats; labels and clicks heed depth.
import type { Page } from 'playwright-core';
import { describe, expect, it } from 'vitest';
import { passTurns } from './at-rest.ts';
import { trialFiles } from './drei/files.ts';
import { appHarness } from './harness.ts';
import { changedPart, type Screenshot, screenshot } from './screenshot.ts';
import { slowDisplay } from './slow-display.ts';

const harness = appHarness('e2e/drei', trialFiles(), slowDisplay);

/** A font or an image of drei's may come from a blob. */
const TRIAL_PAGE = { viewport: { width: 240, height: 160 }, bypassCSP: true };
/** Column and row of the red ball of splats, and its colour. */
const BALL = [68, 80, [253, 0, 0]] as const;

async function whenOpened(page: Page): Promise<void> {
  await page.waitForFunction(() => 'trialPage' in window);
}

async function openTrials(): Promise<Page> {
  const page = await harness.openShared('', TRIAL_PAGE);
  await whenOpened(page);
  return page;
}

const trialsOf = (page: Page) => page.evaluate(() => window.trialPage.trials);

const poseOf = (page: Page, what: 'camera' | 'target') =>
  page.evaluate((name) => {
    const { camera, scene } = window.trialPage.canvas!;
    const object = name === 'camera' ? camera : scene.getObjectByName('target')!;
    return object.matrixWorld.elements.join();
  }, what);

function hasColor(
  { widthPx, data }: Screenshot,
  [xPx, yPx, color]: readonly [number, number, readonly number[]],
): boolean {
  const at = 4 * (yPx * widthPx + xPx);
  return color.every((value, c) => Math.abs(data[at + c] - value) < 50);
}

/** The canvas and elements over it, with splats alone: the same in every trial. */
let empty: Screenshot | null = null;

async function splatsAlone(page: Page): Promise<Screenshot> {
  await page.evaluate(() => window.trialPage.show(''));
  await expect
    .poll(async () => {
      empty = await screenshot(page);
      return hasColor(empty, BALL);
    })
    .toBe(true);
  return empty!;
}

/** Shows a trial, drags the mouse across it, and waits for the expected effect. */
async function expectToWork(name: string): Promise<void> {
  const page = await openTrials();
  const before = empty ?? (await splatsAlone(page));
  const { expects, coversSplats } = (await trialsOf(page)).find((each) => each.name === name)!;
  await page.evaluate((shown) => window.trialPage.show(shown), name);
  await page.waitForFunction(() => window.trialPage.frames >= 3 || window.trialPage.thrown !== null);
  const pose = expects === 'camera' || expects === 'target' ? await poseOf(page, expects) : null;
  if (pose !== null) await dragAcross(page);
  const isDone = async () => {
    const thrown = await page.evaluate(() => window.trialPage.thrown);
    if (thrown !== null) return thrown;
    const shot = await screenshot(page);
    if (!coversSplats && !hasColor(shot, BALL)) return 'no splats';
    if (expects === 'pixels') return changedPart(before, shot) > 0.001;
    if (expects === 'holds') return page.evaluate((shown) => window.trialPage.holds(shown), name);
    return pose !== (await poseOf(page, expects));
  };
  await expect.poll(isDone).toBe(true);
}

/** From the middle of the trial's object. */
async function dragAcross(page: Page): Promise<void> {
  await page.mouse.move(175, 80);
  await passTurns(page, 1);
  await page.mouse.down();
  for (const [xPx, yPx] of [
    [190, 84],
    [210, 90],
  ]) {
    await page.mouse.move(xPx, yPx);
    await passTurns(page, 1);
  }
  await page.mouse.up();
}

describe('drei beside splats', () => {
  it.each(['OrbitControls', 'CameraControls', 'TransformControls', 'Bounds', 'Html occlude', 'Environment'])(
    '%s works',
    expectToWork,
  );
});

describe('<SplatBounds> beside drei’s controls', () => {
  /** Shows clouds, and returns the camera some frames after it was fitted to them. */
  async function fittedCamera(page: Page, controls: string, isOrthographic: boolean): Promise<number[]> {
    await page.evaluate((shown) => window.trialPage.showFitted(shown), { controls, isOrthographic });
    await page.waitForFunction(() => (window.trialPage.framesSinceFit ?? 0) >= 4);
    const camera = await page.evaluate(() => {
      // Not that of `onCreated`: a camera with `makeDefault` follows it.
      const { camera } = window.trialPage.canvas!.get();
      return [...camera.matrixWorld.elements, camera.zoom, camera.near, camera.far];
    });
    // Without the sign of zero.
    return camera.map((value) => Math.round(value * 1e4) / 1e4 || 0);
  }

  /** The fitted cameras without controls: the same in every test. */
  const withoutControls = new Map<boolean, number[]>();

  async function expectedCamera(page: Page, isOrthographic: boolean): Promise<number[]> {
    const known = withoutControls.get(isOrthographic);
    const camera = known ?? (await fittedCamera(page, 'none', isOrthographic));
    withoutControls.set(isOrthographic, camera);
    return camera;
  }

  /**
   * @fault three.js and React: `<SplatBounds>` fits a camera whose controls own its place
   *   (`CameraControls`), turn it about a point, or do neither
   * @consequence the camera stays where it was fitted; controls turn it about the middle
   */
  it.each([
    'OrbitControls',
    'MapControls',
    'TrackballControls',
    'ArcballControls',
    'CameraControls',
    'FlyControls',
  ])('%s keep the camera where it was fitted to, and turn about the middle', async (controls) => {
    const page = await openTrials();
    for (const isOrthographic of [false, true]) {
      const expected = await expectedCamera(page, isOrthographic);
      // The middle of both clouds, straight ahead.
      expect(expected.slice(12, 14)).toEqual([3, 1.5]);
      expect(await fittedCamera(page, controls, isOrthographic)).toEqual(expected);
      if (controls === 'FlyControls') continue;
      await dragAcross(page);
      const isTurned = () =>
        page.evaluate(
          ([x, y]) => {
            const { camera } = window.trialPage.canvas!.get();
            const { elements } = camera.matrixWorld;
            return elements[12] !== x || elements[13] !== y;
          },
          expected.slice(12, 14),
        );
      await expect.poll(isTurned).toBe(true);
      if (controls === 'MapControls') continue; // The mouse moves the ground.
      const middle = await page.evaluate(() => {
        const { camera } = window.trialPage.canvas!.get();
        return camera.position.clone().set(3, 1.5, -1.5).project(camera).toArray();
      });
      expect(Math.abs(middle[0]) + Math.abs(middle[1])).toBeLessThan(1e-3);
    }
  });
});

/** Columns and rows of 20 pixels all over the page. */
const PIXELS = Array.from(
  { length: 20 },
  (_, i) => [12 + 24 * (i % 10) + (i % 3), i < 10 ? 50 : 115] as const,
);

describe('splats in front of and behind something else', () => {
  /** Opens the still life, drawn and ready for rays. */
  async function openStillLife(): Promise<Page> {
    const page = await openTrials();
    await page.evaluate(() => window.trialPage.showStillLife({ labels: [] }));
    const isDrawn = async () => {
      const { canvas, splats } = window.trialPage;
      const { left, top } = canvas!.gl.domElement.getBoundingClientRect();
      return (await splats?.pickAt({ clientX: left + 120, clientY: top + 80 })) != null;
    };
    await expect.poll(() => page.evaluate(isDrawn)).toBe(true);
    await page.evaluate(() => window.trialPage.splats!.data!.prepareRays());
    return page;
  }

  /** Along each pixel's line of sight: the point at `pick`'s depth, and a ray's hit, if any. */
  const seenAt = (page: Page) =>
    page.evaluate(async (pixels) => {
      const { canvas, splats } = window.trialPage;
      const { camera, raycaster, size, gl } = canvas!;
      const { left, top } = gl.domElement.getBoundingClientRect();
      const seen = [];
      for (const [x, y] of pixels) {
        const pick = await splats!.pickAt({ clientX: left + x, clientY: top + y });
        const [ndcX, ndcY] = [(2 * (x + 0.5)) / size.width - 1, 1 - (2 * (y + 0.5)) / size.height];
        raycaster.setFromCamera(camera.position.clone().set(ndcX, ndcY, 0) as never, camera);
        const { origin, direction } = raycaster.ray;
        const along = direction.dot(camera.getWorldDirection(origin.clone()));
        seen.push({
          depthView: pick?.depthView ?? null,
          hitDepthView: (raycaster.intersectObject(splats!)[0]?.distance ?? 0) * along,
          origin: origin.toArray(),
          // Of such a length that distances are view depths.
          direction: direction.clone().divideScalar(along).toArray(),
        });
      }
      return seen;
    }, PIXELS);

  it('hide just those of 20 labels of Html that their depth hides, and rays hit where pick does', async () => {
    const page = await openStillLife();
    const seen = await seenAt(page);
    // The surroundings of the still life are everywhere.
    expect(seen.filter(({ depthView }) => depthView !== null)).toHaveLength(20);
    for (const { depthView, hitDepthView } of seen)
      expect(Math.abs(hitDepthView / depthView! - 1)).toBeLessThan(0.02);
    const labels = seen.map(({ origin, direction, depthView }, i) => {
      const distance = depthView! * (i % 2 === 0 ? 0.9 : 1.1);
      return origin.map((value, axis) => value + distance * direction[axis]) as [number, number, number];
    });
    await page.evaluate((places) => window.trialPage.showStillLife({ labels: places }), labels);
    const areShown = () =>
      page.evaluate(() =>
        Array.from({ length: 20 }, (_, i) => document.getElementById(`label-${i}`)?.checkVisibility()),
      );
    await expect.poll(areShown).toEqual(labels.map((_, i) => i % 2 === 0));
  });

  it('leave every click to a mesh in front of them', async () => {
    const page = await openStillLife();
    const clicks = async () => {
      for (const [xPx, yPx] of PIXELS) await page.mouse.click(xPx, yPx);
      return page.evaluate(() => window.trialPage.clicked.splice(0));
    };
    expect(await clicks()).toEqual(PIXELS.map(() => 'splats'));
    await page.evaluate(() => window.trialPage.showStillLife({ labels: [], hasMesh: true }));
    // It has its place from the first frame with it on.
    await page.waitForFunction(
      () => window.trialPage.canvas!.scene.getObjectByName('pane')?.matrixWorld.elements[14] === 1.3,
    );
    expect(await clicks()).toEqual(PIXELS.map(() => 'mesh'));
  });
});
