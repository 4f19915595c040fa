// Proves: `<Splats>` in a browser: loading, props, pointer events, losses, unmounting.
import { cameraFromMatrices, encodePly, type SplatSet } from '@websplatter/core';
import { renderReference } from '@websplatter/core/reference';
import { writeSplats } from '@websplatter/core/write';
import type { SplatCloudObject } from '@websplatter/react';
import type { Page } from 'playwright-core';
import { expect, it } from 'vitest';
import { atRest, passTurns } from './at-rest.ts';
import { appHarness } from './harness.ts';
import { logOf, waitForLog } from './page-log.ts';
import type { CanvasDescription, SplatsDescription } from './react/main.tsx';
import { skipRecoveryWaits } from './recovery-waits.ts';
import { MIN_PSNR_DB, psnrAgainstReference, referenceImage } from './reference.ts';
import { changedPart, colorsIn, screenshot } from './screenshot.ts';
import { slowScene, testScene } from './test-scene.ts';
import type { DrawnCamera } from './viewer-page.ts';

/** Two mounts show any leftovers; every fifth is unmounted while it loads. */
const MOUNTS = 10;

/** Rows of `dots.ply`: small opaque splats, far enough apart for each to have pixels of its own. */
const DOTS = [
  [1, 0.5, 0],
  [-1, -0.5, 0],
  [0, 0, 0],
  [-0.9, 0.6, 0],
  [0.9, -0.7, 0],
] as const;

const sceneFile = encodePly(testScene());
const gltfFile = await writeSplats(testScene(), 'gltf');
const files = {
  'a.ply': sceneFile,
  'a.glb': gltfFile,
  'b.ply': encodePly(dots(DOTS)),
  'dots.ply': encodePly(dots(DOTS)),
  'dot.ply': encodePly(dots([[0, 0, 0]])),
  'ball.ply': encodePly({ ...dots([[0, 0, 0]]), logScales: new Float32Array(3).fill(Math.log(0.3)) }),
  'many.ply': encodePly(testScene(2000)),
  // As opaque as a splat can be, 0.99, wherever the pixel is.
  'white.ply': encodePly({
    ...dots([[0, 0, 0]]),
    logScales: new Float32Array(3).fill(Math.log(1000)),
    colorDc: new Float32Array(3).fill(0.5 / 0.28209479177387814),
  }),
};
const harness = appHarness('e2e/react', files);

function dots(positions: readonly (readonly number[])[]): SplatSet {
  const count = positions.length;
  return {
    ...testScene(),
    count,
    positions: Float32Array.from(positions.flat()),
    logScales: new Float32Array(3 * count).fill(Math.log(0.1)),
    rotations: Float32Array.from({ length: 4 * count }, (_, i) => (i % 4 === 0 ? 1 : 0)),
    opacityLogits: new Float32Array(count).fill(6),
    colorDc: new Float32Array(3 * count).fill(1),
    harmonics: { degree: 0, coefficients: new Float32Array(0) },
    fileIndices: Uint32Array.from(positions, (_, i) => i),
  };
}

/** For images that are compared bit for bit: their rasteriser must not follow from times. */
const BY_TILES = { rasterizer: 'tiles' } as const;

const SPLATS: SplatsDescription = { id: 'a', src: 'a.ply' };

/** The Canvas of most tests, on demand: constant frames would keep the processor from tests. */
function canvas(changes: Partial<CanvasDescription> = {}): CanvasDescription {
  return { id: 'canvas', kind: 'splats', frameloop: 'demand', splats: [SPLATS], ...changes };
}

const show = (page: Page, ...canvases: CanvasDescription[]) =>
  page.evaluate((list) => window.page.show(list), canvases);

async function open(...canvases: CanvasDescription[]): Promise<Page> {
  const page = await harness.openShared('');
  await page.waitForFunction(() => 'page' in window);
  await show(page, ...canvases);
  return page;
}

/** The same with one Canvas on a black background. */
const openOnBlack = (changes: Partial<CanvasDescription>) =>
  open(canvas({ background: 'black', splats: [], ...changes }));

const countersOf = (page: Page, id = 'canvas') =>
  page.evaluate((name) => window.page.engine(name).counters(), id);

/** Frames of the Canvas so far, by the engine and by three, which draws two passes for each. */
async function framesOf(page: Page): Promise<{ splats: number; passes: number }> {
  return page.evaluate(() => {
    const { render } = window.page.canvases.get('canvas')!.gl.info as { render: { calls: number } };
    return { splats: window.page.engine('canvas').counters().framesDrawn, passes: render.calls };
  });
}

const plus = ({ splats, passes }: { splats: number; passes: number }, frames: number) => ({
  splats: splats + frames,
  passes: passes + 2 * frames,
});

const image = (page: Page) => screenshot(page.getByTestId('canvas'));

/** The image once it stays as it is. */
const imageAtRest = (page: Page) =>
  atRest(page, async () => {
    // Until the GPU is done, the screen has the picture before, on a busy machine for more than those frames.
    await page.evaluate(() => window.page.engine('canvas').device.queue.onSubmittedWorkDone());
    return image(page);
  });

const overlayOf = (page: Page) =>
  page.getByTestId('canvas').getByRole('group', { name: 'Cost of the splats' });

const resourcesOf = (page: Page) =>
  page.evaluate(() => ({
    ...window.page.countResources(),
    engineBytes: window.page.engine('canvas').memory().totalBytes,
  }));

/** Projects a point onto the page, in CSS pixels; the first canvas is at the top left. */
function projected(page: Page, point: readonly number[]): Promise<[number, number]> {
  return page.evaluate(
    ([x, y, z]) => {
      const { camera, size } = window.page.canvases.get('canvas')!;
      const clip = camera.position.clone().set(x, y, z).project(camera);
      return [((clip.x + 1) / 2) * size.width, ((1 - clip.y) / 2) * size.height];
    },
    [...point],
  );
}

/** Data of the Canvas's camera that the reference needs. */
const cameraOf = (page: Page) =>
  page.evaluate(() => {
    const { matrixWorldInverse, projectionMatrix, near, far } = window.page.canvases.get('canvas')!.camera;
    const [viewMatrix, projection] = [matrixWorldInverse.elements, projectionMatrix.elements];
    return { viewMatrix, projectionMatrix: projection, near, far, modelMatrices: [null] };
  });

const pickAt = (page: Page, id: string, place: readonly [number, number]) =>
  page.evaluate(
    async ([name, [x, y]]) => {
      const object = window.page.objects.get(name)!;
      const { left, top } = window.page.canvases.get('canvas')!.gl.domElement.getBoundingClientRect();
      const hit = await object.pickAt({ clientX: left + x, clientY: top + y });
      return hit && { row: hit.row, point: hit.point.toArray(), isItself: hit.object === object };
    },
    [id, place] as const,
  );

const OWN_HEAD = 'import package::lib::packing::Splat;\n';
const OWN_COLOR = 'fn ownColor(color: vec3f, splat: Splat, index: u32, centerView: vec3f)';
it.each([
  [
    'imports what is not there',
    `${OWN_HEAD}import package::lib::nothing::here;\n${OWN_COLOR} -> vec3f { return here(color); }`,
    2,
  ],
  ['does not compile', `${OWN_HEAD}${OWN_COLOR} -> vec3f {\n  return wibble;\n}`, 3],
])(
  'an effect whose WGSL %s is told to onError and the console, and the splats are drawn without it',
  async (_, ownWgsl, line) => {
    harness.expectProblem(
      new RegExp(`The effect own-color cannot be drawn: package::effects::own_color, line ${line}: `),
    );
    const page = await open(canvas({ splats: [{ ...SPLATS, hasErrors: true, ownWgsl }] }));
    await waitForLog(page, 'a error ShaderError');
    await waitForLog(page, 'a firstframe');
    const before = await screenshot(page);
    // Later changes of the same cloud are drawn.
    await show(page, canvas({ splats: [{ ...SPLATS, hasErrors: true, ownWgsl, tint: 'red' }] }));
    await expect.poll(async () => changedPart(before, await screenshot(page))).toBeGreaterThan(0.001);
    expect((await logOf(page)).filter((entry) => entry === 'a error ShaderError')).toHaveLength(1);
  },
);

it('draws splats that are relit and receive shadows, together and one after another', async () => {
  const both = canvas({
    shadowMap: 'drawn',
    splats: [{ ...SPLATS, castShadow: true, receiveShadow: true, relight: 0.8 }],
  });
  const page = await open(both);
  await waitForLog(page, 'a firstframe');
  const effectsOn = () =>
    page.evaluate(() =>
      window.page
        .engine('canvas')
        .effects()
        .filter(({ isOn }) => isOn)
        .map(({ name }) => name),
    );
  await expect.poll(effectsOn).toEqual(expect.arrayContaining(['relight', 'shadows']));
  await show(
    page,
    canvas({
      shadowMap: 'drawn',
      splats: [{ ...SPLATS, castShadow: true, receiveShadow: true, relight: 0.8, tint: 'red' }],
    }),
  );
  await expect.poll(effectsOn).toEqual(expect.arrayContaining(['relight', 'shadows', 'tint']));
});

it('suspends, loads, and draws as the float64 reference does over any background', async () => {
  const page = await open(canvas({ background: 'black' }));
  await waitForLog(page, 'a firstframe');
  expect(await logOf(page)).toEqual([
    'canvas created',
    // three's LoadingManager, which progress bars listen to.
    'manager start a.ply',
    'canvas suspended',
    'manager idle',
    'canvas resumed',
    'a load a.ply',
    'a firstframe',
  ]);
  const camera = await cameraOf(page);
  const size = await image(page);
  for (const [name, level] of [
    ['black', 0],
    ['white', 1],
    ['#808080', 128 / 255],
  ] as const) {
    await show(page, canvas({ background: name }));
    const background: [number, number, number] = [level, level, level];
    const psnrDb = referenceImage({ ...camera, background }, [testScene()], size);
    await expect
      .poll(async () => psnrDb(await image(page)), { message: `PSNR over ${name}, dB` })
      .toBeGreaterThanOrEqual(MIN_PSNR_DB);
  }

  // White of 0.99 opacity over black, and the same under ACES where the Canvas is not `flat`.
  for (const [isToneMapped, red] of [
    [false, 252.45],
    [true, 226],
  ] as const) {
    await show(
      page,
      canvas({ background: 'black', splats: [{ id: 'white', src: 'white.ply' }], isToneMapped }),
    );
    await expect.poll(async () => Math.abs((await image(page)).data[0] - red)).toBeLessThan(3);
  }
});

it('plays a sequence on demand, without suspending, and frees it', async () => {
  const sequence = ['a.ply', 'b.ply', 'dots.ply', 'dot.ply'];
  const page = await openOnBlack({ sequence });
  // The first frames pass while shaders compile.
  await waitForLog(page, 'sequence firstframe', 6);
  const log = await logOf(page);
  const loads = log.filter((entry) => entry.startsWith('sequence load'));
  expect(loads).toEqual(loads.map((_, i) => `sequence load ${sequence[i % sequence.length]}`));
  expect(log.filter((entry) => /suspended|manager/.test(entry))).toEqual([]);
  const clouds = () => page.evaluate(() => window.page.engine('canvas').memory().scene.clouds.length);
  expect(await clouds()).toBeLessThanOrEqual(2);
  await show(page, canvas({ background: 'black', splats: [] }));
  await expect.poll(clouds).toBe(0);
});

it('draws no frame unless asked, and then one, or one more where a shader has yet to be compiled', async () => {
  const quiet = canvas({ background: 'black', timings: 'inside' });
  const page = await open(quiet);
  await waitForLog(page, 'a firstframe');
  await page.waitForFunction(() => window.page.statistics.length > 0);
  await page.evaluate(() => {
    const { timings, log } = window.page;
    timings!.subscribe((statistics) => log.push(`frame ${statistics === timings!.current}`));
  });
  const before = await atRest(page, () => framesOf(page));
  await passTurns(page, 60);
  expect(await framesOf(page), 'frames that were not asked for').toEqual(before);
  for (let i = 1; i <= 3; i++) {
    await page.evaluate(() => window.page.canvases.get('canvas')!.invalidate());
    expect(await atRest(page, () => framesOf(page)), `frames after ${i} calls of invalidate()`).toEqual(
      plus(before, i),
    );
  }

  const { uploads } = await countersOf(page);
  const rendersBefore = await page.evaluate(() => window.page.timingRenders);
  const opaque = await image(page);
  const changed = { ...SPLATS, opacity: 0.2, position: [0, 0.2, 0] as const };
  await show(page, { ...quiet, splats: [changed] });
  // At once with the shaders at hand, and again with the one for opacity.
  await expect.poll(() => framesOf(page)).toEqual(plus(before, 5));
  await passTurns(page);
  expect(await framesOf(page), 'frames after a shader was compiled').toEqual(plus(before, 5));
  expect(changedPart(opaque, await image(page))).toBeGreaterThan(0.1);
  await show(page, { ...quiet, splats: [{ ...changed, opacity: 0.4 }] });
  await expect.poll(() => framesOf(page)).toEqual(plus(before, 6));
  await passTurns(page);
  expect(await framesOf(page), 'frames after a change of props').toEqual(plus(before, 6));
  expect((await countersOf(page)).uploads, 'uploads').toBe(uploads);

  await waitForLog(page, 'frame true');
  // Measurements rendered only text: two renders are of the props above, doubled by StrictMode.
  expect(await page.evaluate(() => window.page.timingRenders)).toBe(rendersBefore + 4);
  const overlay = overlayOf(page);
  const rowsOfSmall = (await overlay.innerText())
    .trim()
    .split(/\n+/)
    .filter((line) => /^[A-Z]/.test(line));
  expect(rowsOfSmall, 'over a small canvas').toEqual(['Wall clock', 'Frames per second', 'GPU memory']);
  await page
    .getByTestId('canvas')
    .evaluate(({ style }) => Object.assign(style, { width: '640px', height: '480px' }));
  await expect.poll(() => overlay.innerText()).toContain('Pre-process');
  const text = await overlay.innerText();
  for (const row of ['Pre-process', 'Sort', 'Rasterise', 'Frame', 'Wall clock']) {
    expect(text).toMatch(new RegExp(`${row}\\s+\\d+\\.\\d\\d ms`));
  }
  expect(text).toMatch(/Rasteriser\s+(tiles|quads)\s/);
  expect(text).toMatch(/Splats loaded\s+400\s/);
  expect(text).toContain('GPU timestamps');
});

/**
 * Points in and about the scene, each in a pixel of its own and clearly covered or uncovered, with
 * the opacity in front of them in float64.
 */
function labelPoints(
  camera: Omit<DrawnCamera, 'background'>,
  size: { widthPx: number; heightPx: number },
  count: number,
) {
  const { viewMatrix: v, projectionMatrix: p } = camera;
  const hostDepths = new Float64Array(size.widthPx * size.heightPx).fill(Number.POSITIVE_INFINITY);
  const candidates: { position: [number, number, number]; pixel: number; depthView: number }[] = [];
  for (let i = 0; candidates.length < 3 * count; i++) {
    // Steps that never meet: a fixed set of points all over the scene.
    const position = [
      ((i * 0.618) % 1) * 4 - 1,
      ((i * 0.414) % 1) * 2,
      ((i * 0.732) % 1) * 2.4 - 1.4,
    ] as const;
    const [x, y, z] = [0, 1, 2].map((row) =>
      position.reduce((sum, value, axis) => sum + v[4 * axis + row] * value, v[12 + row]),
    );
    const column = Math.floor(((1 + (p[0] * x) / -z) / 2) * size.widthPx);
    const row = Math.floor(((1 - (p[5] * y) / -z) / 2) * size.heightPx);
    const pixel = row * size.widthPx + column;
    const isInside = column >= 0 && column < size.widthPx && row >= 0 && row < size.heightPx;
    if (!isInside || candidates.some((other) => other.pixel === pixel)) continue;
    candidates.push({ position: [...position], pixel, depthView: -z });
    hostDepths[pixel] = 0.98 * -z;
  }
  const { data } = renderReference({
    clouds: [{ set: testScene() }],
    camera: cameraFromMatrices(v, p, camera),
    ...size,
    hostDepths,
  });
  return candidates
    .map(({ position, pixel, depthView }) => ({ position, depthView, opacity: data[4 * pixel + 3] }))
    .filter(({ opacity }) => Math.abs(opacity - 0.5) > 0.05)
    .slice(0, count);
}

it('shows the labels whose points nothing covers, as float64 depth tells, and asks only after frames', async () => {
  const quiet = canvas({ background: 'black' });
  const page = await openOnBlack({ splats: [SPLATS] });
  await waitForLog(page, 'a firstframe');
  const camera = await cameraOf(page);
  const shot = await image(page);
  const points = labelPoints(camera, shot, 20);
  const wall = [2.2, 1.2, 1] as const;
  const labels = points.map(({ position }, i) => ({ id: `label ${i}`, position }));
  const namesOf = (isFree: (point: (typeof points)[number]) => boolean) =>
    labels.filter((_, i) => isFree(points[i])).map(({ id }) => id);
  const shown = async () => (await page.getByRole('button').allInnerTexts()).toSorted(byNumber);
  const byNumber = (a: string, b: string) => Number(a.slice(6)) - Number(b.slice(6));

  const free = namesOf(({ opacity }) => opacity < 0.5);
  expect(free.length).toBeGreaterThan(5);
  expect(free.length).toBeLessThan(15);
  await show(page, { ...quiet, labels });
  await expect.poll(shown).toEqual(free);
  const hidden = (await logOf(page)).filter((entry) => / (hidden|free)$/.test(entry));
  expect(hidden.toSorted()).toEqual(
    labels
      .filter(({ id }) => !free.includes(id))
      .map(({ id }) => `${id} hidden`)
      .toSorted(),
  );

  // At rest no frame is asked for.
  const readbacksOf = async () => (await countersOf(page)).readbacks;
  const before = await atRest(page, readbacksOf);
  await passTurns(page, 60);
  expect(await readbacksOf()).toBe(before);
  await page.evaluate(() => window.page.canvases.get('canvas')!.invalidate());
  expect(await atRest(page, readbacksOf), 'questions after one frame').toBe(before + 1);

  // The keyboard reaches the content.
  await page.keyboard.press('Tab');
  expect(free).toContain(await page.evaluate(() => document.activeElement?.textContent));
  await page.keyboard.press('Enter');
  expect((await logOf(page)).at(-1)).toMatch(/^label \d+ click$/);
  await page.evaluate(() => (document.activeElement as HTMLElement).blur());

  // A wall hides the splats behind it alone.
  const eye = [1.5, 1, 5] as const;
  const isBehindWall = ({ position, depthView }: (typeof points)[number]) => {
    const part = (wall[2] - eye[2]) / (position[2] - eye[2]);
    const isHit = [0, 1].every(
      (axis) => Math.abs(eye[axis] + part * (position[axis] - eye[axis]) - wall[axis]) < 1,
    );
    return isHit && part * depthView < 0.98 * depthView;
  };
  const freeBesideWall = namesOf((point) => point.opacity < 0.5 && !isBehindWall(point));
  expect(freeBesideWall.length).toBeLessThan(free.length);
  await show(page, { ...quiet, labels, wall });
  await expect.poll(shown).toEqual(freeBesideWall);

  await show(page, quiet);
  await expect
    .poll(() => page.getByTestId('canvas').evaluate((element) => element.querySelectorAll('button').length))
    .toBe(0);
});

it('measures between splats that are clicked on, or chosen by keyboard, and not where a pointer drags', async () => {
  const dots = { splats: [{ id: 'dots', src: 'dots.ply' }], hasMeasure: true };
  const page = await openOnBlack(dots);
  await waitForLog(page, 'dots firstframe');
  const measured = () =>
    page.evaluate(() => window.page.measurements.map(({ distance, text }) => ({ distance, text })));
  const [a, b] = [await projected(page, DOTS[0]), await projected(page, DOTS[1])];
  await page.mouse.click(...a);
  // Dragging turns the camera elsewhere.
  await page.mouse.move(...b);
  await page.mouse.down();
  await page.mouse.move(b[0] + 30, b[1]);
  await page.mouse.up();
  const status = page.getByTestId('canvas').getByRole('status');
  await expect.poll(() => status.innerText()).toBe('First point set.');
  await page.mouse.click(2, 2);
  await expect.poll(() => status.innerText()).toBe('There is nothing to measure here.');
  expect(await measured()).toEqual([]);
  await page.mouse.click(...b);
  await expect.poll(measured).toHaveLength(1);
  const [byPointer] = await measured();
  const between = Math.hypot(2, 1);
  // The point is behind the middle of the pixel, at the depth of the splat.
  expect(Math.abs(byPointer.distance - between)).toBeLessThan(0.05);
  expect(byPointer.text).toBe(`${(100 * byPointer.distance).toFixed(1)} cm`);
  await expect.poll(() => status.innerText()).toBe(`Distance: ${byPointer.text}`);

  // By keyboard, from the middle of the canvas, where the third dot is.
  const tool = page.getByRole('application');
  await tool.focus();
  await page.keyboard.press('Escape');
  await page.keyboard.press('Enter');
  await expect.poll(() => status.innerText()).toBe('First point set.');
  const { width, height } = (await page.getByTestId('canvas').boundingBox())!;
  const steps = [b[0] - width / 2, b[1] - height / 2].map(Math.round);
  for (const [axis, [back, forth]] of [
    ['ArrowLeft', 'ArrowRight'],
    ['ArrowUp', 'ArrowDown'],
  ].entries()) {
    const key = steps[axis] < 0 ? back : forth;
    const pixels = Math.abs(steps[axis]);
    for (let i = 0; i < Math.floor(pixels / 10); i++) await page.keyboard.press(key);
    for (let i = 0; i < pixels % 10; i++) await page.keyboard.press(`Shift+${key}`);
  }
  await page.keyboard.press('Enter');
  await expect.poll(measured).toHaveLength(2);
  const byKeyboard = (await measured())[1];
  expect(Math.abs(byKeyboard.distance - Math.hypot(1, 0.5))).toBeLessThan(0.05);
  await page.keyboard.press('Backspace');
  await page.keyboard.press('Enter');
  await expect.poll(measured).toHaveLength(3);
  expect((await measured())[2].text).toBe(byKeyboard.text);

  await show(page, canvas({ ...dots, hasMeasure: false }));
  await expect.poll(() => tool.count()).toBe(0);
});

it('fits the camera to the splats once they have been loaded', async () => {
  const page = await open(canvas({ isFitted: true }));
  await waitForLog(page, 'canvas fits splats');
  await waitForLog(page, 'a firstframe');
  const places = await page.evaluate(() => {
    const { min, max } = window.page.objects.get('a')!.data!.robustBounds;
    const { camera, size } = window.page.canvases.get('canvas')!;
    return Array.from({ length: 8 }, (_, i) => {
      const corner = min.clone().set(i & 1 ? max.x : min.x, i & 2 ? max.y : min.y, i & 4 ? max.z : min.z);
      const { x, y } = corner.project(camera);
      return [x, y, size.width];
    });
  });
  const fill = Math.max(...places.flatMap(([x, y]) => [Math.abs(x), Math.abs(y)]));
  expect(fill).toBeCloseTo(1, 4);
  expect(await logOf(page)).not.toContain('canvas fits nothing');
});

it('takes effects as props, and draws what revealing takes and no frame more', async () => {
  const quiet = canvas({ background: 'black' });
  const revealed = { ...SPLATS, reveal: { from: [0, 0, 0], durationMs: 2000 } as const };
  const page = await openOnBlack({ splats: [revealed] });
  // In the page, at each of its frames: a test that asks from outside may come when all is over.
  const waitForReveal = (isOn: boolean) =>
    page.waitForFunction((wanted) => {
      const { canvases, engine } = window.page;
      const effects = canvases.has('canvas') ? engine('canvas').effects() : [];
      return effects.find(({ name }) => name === 'reveal')?.isOn === wanted;
    }, isOn);
  await waitForReveal(true);
  await waitForReveal(false);
  await waitForLog(page, 'a firstframe');
  const before = await atRest(page, () => framesOf(page));
  expect(before.splats).toBeGreaterThan(2);
  const whole = await image(page);
  // A new object with equal values is the same reveal, and gives the same image.
  await show(page, { ...quiet, splats: [{ ...revealed, reveal: { ...revealed.reveal } }] });
  await passTurns(page);
  expect(await framesOf(page), 'frames after equal props').toEqual(before);
  expect(changedPart(whole, await image(page), 0)).toBe(0);

  await show(page, { ...quiet, splats: [{ ...revealed, tint: '#ff0000' }] });
  const blueOrGreen = async () => {
    const { data } = await image(page);
    return data.filter((value, i) => i % 4 !== 0 && i % 4 !== 3 && value > 0).length;
  };
  expect(whole.data.filter((value, i) => i % 4 === 2 && value > 50).length).toBeGreaterThan(1000);
  await expect.poll(blueOrGreen).toBe(0);
});

it('takes what frames set on the object, and keeps its Canvas where they set what cannot be drawn', async () => {
  harness.expectProblem(/InvalidArgumentError: a.ply: opacity is NaN/);
  const page = await open(canvas({ background: 'black' }));
  await waitForLog(page, 'a firstframe');
  const before = await imageAtRest(page);
  const set = (values: Pick<SplatCloudObject, 'opacity' | 'tint'>) =>
    page.evaluate((given) => {
      Object.assign(window.page.objects.get('a')!, given);
      window.page.canvases.get('canvas')!.invalidate();
    }, values);
  await set({ opacity: 1.0015, tint: [1, 0, 0] });
  await expect
    .poll(async () => {
      const { data } = await image(page);
      return data.some((value, i) => i % 4 === 2 && value > 0);
    })
    .toBe(false);
  const tinted = await imageAtRest(page);
  expect(changedPart(before, tinted)).toBeGreaterThan(0.02);
  const frames = await framesOf(page);
  await set({ opacity: Number.NaN, tint: null });
  await expect.poll(() => framesOf(page)).not.toEqual(frames);
  expect(changedPart(tinted, await imageAtRest(page), 0)).toBe(0);
  await set({ opacity: 1, tint: null });
  await expect.poll(async () => changedPart(before, await image(page), 0)).toBe(0);
});

it('reads a file once and uploads it once, however often it is shown, and keeps it while a new one is read', async () => {
  const second = {
    id: 'second',
    src: 'a.ply',
    position: [1, 0, 0] as const,
    handedOnBy: 'useSplats' as const,
  };
  const requestsBefore = harness.server.requests('a.ply');
  const drawing = (splats: CanvasDescription['splats']) => canvas({ frameloop: 'always', splats });
  const page = await open(drawing([SPLATS, second]));
  await waitForLog(page, 'second firstframe');
  expect(harness.server.requests('a.ply') - requestsBefore).toBe(1);
  const both = await countersOf(page);
  expect(both.uploads).toBe(1);

  await show(page, drawing([SPLATS]));
  await passTurns(page, 2);
  expect(await countersOf(page)).toMatchObject({ uploads: 1, cloudsDestroyed: 0 });

  // The file never ends: the old splats stay, and nothing suspends.
  const endlessBefore = harness.server.requests('endless.ply');
  await show(page, drawing([{ id: 'a', src: 'endless.ply' }]));
  await expect.poll(() => harness.server.requests('endless.ply')).toBe(endlessBefore + 1);
  const { framesDrawn } = await countersOf(page);
  await expect.poll(async () => (await countersOf(page)).framesDrawn).toBeGreaterThan(framesDrawn);
  await show(page, drawing([{ id: 'a', src: 'b.ply' }]));
  await harness.server.whenEndlessFileIsDropped();
  await waitForLog(page, 'a firstframe', 2);
  // The old file is kept for another moment, in case that it is shown again.
  await expect.poll(() => countersOf(page)).toMatchObject({ uploads: 2, cloudsDestroyed: 1 });
  const log = await logOf(page);
  expect(log.filter((entry) => entry === 'canvas suspended')).toHaveLength(1);
  expect(log).toContain('a load b.ply');

  // Another Canvas has another device: the splats are read again for it, once, and leave the first.
  const requests = harness.server.requests('b.ply');
  await show(
    page,
    canvas({ splats: [] }),
    canvas({
      id: 'other',
      accuracy: { alphaCutoff: 0.01 },
      antialias: false,
      splats: [{ id: 'a', src: 'b.ply' }],
    }),
  );
  await waitForLog(page, 'a firstframe', 3);
  expect(harness.server.requests('b.ply')).toBe(requests + 1);
  expect(await countersOf(page, 'other')).toMatchObject({ uploads: 1 });
  const settings = (id: string) => {
    const { alphaCutoff } = window.page.engine(id).accuracy;
    return {
      alphaCutoff,
      samples: (window.page.canvases.get(id)!.gl as unknown as { samples: number }).samples,
    };
  };
  expect(await page.evaluate(settings, 'other')).toEqual({ alphaCutoff: 0.01, samples: 0 });
  expect(await page.evaluate(settings, 'canvas')).toMatchObject({ samples: 4 });
  await expect.poll(() => countersOf(page)).toMatchObject({ cloudsDestroyed: 2 });
});

/** Waits until the Canvas, of black background, has resumed `times` times and shows splats. */
async function waitForSplats(page: Page, times = 1): Promise<void> {
  await waitForLog(page, 'canvas resumed', times);
  await expect
    .poll(async () => (await image(page)).data.filter((value, i) => i % 4 < 3 && value > 50).length)
    .toBeGreaterThan(1000);
}

const SLOW: SplatsDescription = { id: 'slow', src: 'slow.ply' };

const placeOf = (page: Page) =>
  page.evaluate(() => window.page.canvases.get('canvas')!.camera.position.toArray());

/** Opens a Canvas that fits its camera to a part of a file. The rest comes once the test asks for it. */
async function openPart(): Promise<Page> {
  const page = await open(canvas({ background: 'black', isFitted: true, splats: [SLOW] }));
  await waitForSplats(page);
  await expect.poll(() => placeOf(page)).not.toEqual([1.5, 1, 5]);
  expect(await logOf(page)).not.toContain('canvas fits splats');
  return page;
}

it('shows what has arrived of a file, then all of it, and fits the camera to each', async () => {
  const page = await openPart();
  const log = async () => (await logOf(page)).filter((entry) => !entry.startsWith('canvas fits'));
  expect(await log()).toEqual([
    'canvas created',
    'manager start slow.ply',
    'canvas suspended',
    'canvas resumed',
  ]);
  const countOf = () => page.evaluate(() => window.page.objects.get('slow')!.data!.count);
  expect(await countOf()).toBeLessThan(slowScene().count);
  expect(await pickAt(page, 'slow', await projected(page, [0, 0, 0]))).toBeNull();
  const before = await placeOf(page);
  harness.server.sendRestOfSlowFile();
  await waitForLog(page, 'canvas fits splats');
  await waitForLog(page, 'slow firstframe');
  expect((await log()).slice(4)).toEqual(['manager idle', 'slow load slow.ply', 'slow firstframe']);
  expect(await countOf()).toBe(slowScene().count);
  await expect.poll(() => placeOf(page)).not.toEqual(before);
  const shot = await imageAtRest(page);
  const drawn = { ...(await cameraOf(page)), background: [0, 0, 0] as [number, number, number] };
  expect(psnrAgainstReference(shot, drawn, [slowScene()])).toBeGreaterThanOrEqual(MIN_PSNR_DB);
});

it('keeps a camera that was moved between a part of a file and all of it', async () => {
  const page = await openPart();
  const moved = [0.5, 3, 4] as const;
  await page.evaluate((place) => {
    window.page.canvases.get('canvas')!.camera.position.set(...place);
  }, moved);
  harness.server.sendRestOfSlowFile();
  await waitForLog(page, 'canvas fits splats');
  await waitForLog(page, 'slow firstframe');
  expect(await placeOf(page)).toEqual(moved);
});

it('leaves nothing of a part on screen, nor in memory, when it is unmounted or fails', async () => {
  const quiet = canvas({ background: 'black', frameloop: 'demand', splats: [] });
  const page = await open(quiet);
  await waitForLog(page, 'canvas created');
  const empty = await imageAtRest(page);
  const expectNothing = async () => {
    await expect.poll(async () => changedPart(empty, await image(page), 0)).toBe(0);
    const left = () =>
      page.evaluate(() => {
        const { totalBytes, frames } = window.page.engine('canvas').memory();
        const { workers } = window.page.countResources();
        return { workers, bytes: totalBytes - frames.totalBytes };
      });
    await expect.poll(left).toEqual({ workers: 0, bytes: 0 });
  };
  await show(page, { ...quiet, splats: [SLOW] });
  await waitForSplats(page);
  await show(page, quiet);
  await expectNothing();
  await show(page, { ...quiet, splats: [{ ...SLOW, hasErrors: true }] });
  await waitForSplats(page, 2);
  harness.server.cutSlowFile();
  await waitForLog(page, 'slow error SplatSourceError');
  await expectNothing();
});

it('shows what useLoader has loaded for the renderer, which packs it', async () => {
  const requests = harness.server.requests('slow.ply');
  const loaded = { ...SLOW, handedOnBy: 'useLoader' as const };
  const page = await open(canvas({ background: 'black', frameloop: 'demand', splats: [loaded] }));
  await expect.poll(() => harness.server.requests('slow.ply')).toBe(requests + 1);
  await waitForLog(page, 'canvas created');
  await page.evaluate(() => {
    window.page.engine('canvas').addPacked = () => {
      throw new Error('The CPU has packed it.');
    };
  });
  harness.server.sendRestOfSlowFile();
  await waitForLog(page, 'slow firstframe');
  expect(await countersOf(page)).toMatchObject({ uploads: 1 });
  const drawn = { ...(await cameraOf(page)), background: [0, 0, 0] as [number, number, number] };
  expect(psnrAgainstReference(await imageAtRest(page), drawn, [slowScene()])).toBeGreaterThanOrEqual(
    MIN_PSNR_DB,
  );
});

it('takes another accuracy while it draws, in the same Canvas and without suspending', async () => {
  const quiet = canvas({ background: 'black' });
  const page = await open(quiet);
  await waitForLog(page, 'a firstframe');
  const balanced = await imageAtRest(page);
  const held = () =>
    page.evaluate(() => {
      const engine = window.page.engine('canvas');
      const { geometry, sh } = window.page.objects.get('a')!.uploadedTo(engine)!.precisions;
      return [...geometry, ...sh].join(' ');
    });
  expect(await held()).toBe('packed u8');

  await show(page, { ...quiet, accuracy: { alphaCutoff: 0.1, sortKeyBits: 16 } });
  await expect.poll(async () => changedPart(balanced, await image(page))).toBeGreaterThan(0.1);
  await show(page, { ...quiet, accuracy: 'high' });
  await expect.poll(held).toBe('f32 f16');
  await expect.poll(async () => changedPart(balanced, await image(page))).toBeLessThan(0.01);

  // Its own accuracy, not the Canvas's.
  await show(page, { ...quiet, accuracy: 'high', splats: [{ ...SPLATS, accuracy: 'fast' }] });
  await expect.poll(held).toBe('packed u8');
  await show(page, { ...quiet, accuracy: 'fast', splats: [{ ...SPLATS, accuracy: 'reference' }] });
  await expect.poll(held).toBe('f32 f32');
  const log = await logOf(page);
  expect(log.filter((entry) => /created|suspended|load|firstframe/.test(entry))).toEqual([
    'canvas created',
    'canvas suspended',
    'a load a.ply',
    'a firstframe',
  ]);
  expect(await countersOf(page)).toMatchObject({ uploads: 1, cloudsDestroyed: 0 });
});

for (const shadowMap of ['drawn', 'kept'] as const)
  it(`shows the shadow of splats on demand once they are loaded, its map ${shadowMap}`, async () => {
    const ball = { id: 'a', src: 'ball.ply', castShadow: true } as const;
    const page = await open(canvas({ background: 'black', shadowMap, splats: [] }));
    const redUnder = async (x: number) => {
      const [xPx, yPx] = await projected(page, [x, -1, 0]);
      const { widthPx, data } = await image(page);
      return data[4 * (Math.floor(yPx) * widthPx + Math.floor(xPx))];
    };
    await expect.poll(() => redUnder(0)).toBeGreaterThan(150);
    await show(page, canvas({ background: 'black', shadowMap, splats: [ball] }));
    await expect.poll(() => redUnder(0)).toBeLessThan(20);
    expect(await redUnder(1.2)).toBeGreaterThan(150);
    const moved = { ...ball, position: [1.2, 0, 0] } as const;
    await show(page, canvas({ background: 'black', shadowMap, splats: [moved] }));
    await page.waitForFunction(() => window.page.objects.get('a')!.position.x > 1);
    // A map that three keeps stays until the application wants another.
    if (shadowMap === 'kept')
      await page.evaluate(() => {
        const { scene, invalidate } = window.page.canvases.get('canvas')!;
        scene.traverse((object) => {
          if ('shadow' in object) Object.assign(object.shadow as object, { needsUpdate: true });
        });
        invalidate();
      });
    await expect.poll(() => redUnder(1.2)).toBeLessThan(20);
    expect(await redUnder(0)).toBeGreaterThan(150);
  });

it('takes another detail while it draws, and draws no frame for an equal one', async () => {
  const onDemand = { ...canvas({ background: 'black' }), frameloop: 'demand' as const };
  const page = await open(onDemand);
  await waitForLog(page, 'a firstframe');
  const full = await imageAtRest(page);
  const coarse = { ...onDemand, detail: { maxErrorPx: 50 } };
  await show(page, coarse);
  await expect.poll(async () => changedPart(full, await image(page))).toBeGreaterThan(0.01);
  const framesDrawn = async () => {
    await imageAtRest(page);
    return page.evaluate(() => window.page.engine('canvas').counters().framesDrawn);
  };
  const before = await framesDrawn();
  await show(page, { ...coarse, detail: { maxErrorPx: 50 } });
  expect(await framesDrawn()).toBe(before);
  // Its own detail, not the Canvas's.
  await show(page, { ...coarse, splats: [{ ...SPLATS, detail: 'full' }] });
  await expect.poll(async () => changedPart(full, await image(page))).toBe(0);
});

it('aborts the fetch of what is unmounted', async () => {
  const endless = [{ id: 'a', src: 'endless.ply' }];
  const page = await openOnBlack({ splats: [] });
  const expectAborted = async (mounted: CanvasDescription, ...without: CanvasDescription[]) => {
    const requests = harness.server.requests('endless.ply');
    await show(page, mounted);
    await expect.poll(() => harness.server.requests('endless.ply')).toBe(requests + 1);
    await show(page, ...without);
    await harness.server.whenEndlessFileIsDropped();
  };
  await expectAborted(canvas({ splats: endless }), canvas({ splats: [] }));
  // Without a Suspense inside, the whole Canvas suspends, with no new children until unmounted.
  await expectAborted(canvas({ splats: endless, hasSuspense: false }));
  expect(await logOf(page)).toContain('canvas suspended');
});

it(`leaves nothing behind after ${MOUNTS} mounts and unmounts`, async () => {
  const page = await openOnBlack({ splats: [] });
  const effectsOf = () => page.evaluate(() => window.page.effects);
  const effectsBefore = await effectsOf();
  const mount = async (i: number) => {
    const isUnmountedWhileLoading = i % 5 === 4;
    const src = isUnmountedWhileLoading ? `endless.ply?${i}` : `a.ply?${i}`;
    const requests = harness.server.requests('endless.ply');
    await show(page, canvas({ splats: [{ id: `a${i}`, src }] }));
    if (isUnmountedWhileLoading)
      await expect.poll(() => harness.server.requests('endless.ply')).toBe(requests + 1);
    else await waitForLog(page, `a${i} firstframe`);
    await show(page, canvas({ splats: [] }));
  };
  // The first one makes objects that all others share: pipelines, and the objects that three keeps.
  await mount(0);
  await expect.poll(() => resourcesOf(page)).toMatchObject({ engineBytes: 0, workers: 0 });
  const before = await atRest(page, () => resourcesOf(page));
  for (let i = 1; i <= MOUNTS; i++) await mount(i);
  await expect.poll(() => resourcesOf(page)).toEqual(before);
  expect((await effectsOf()) - effectsBefore, 'StrictMode mounts twice').toBeGreaterThanOrEqual(1.6 * MOUNTS);
});

/**
 * @fault Devices and engines: the device is lost in React
 * @consequence it is reported once; clouds, camera and accuracy come back
 */
it('comes back from the loss of its device by itself, and tells where it cannot', async () => {
  harness.expectProblem(/<SplatCanvas> was lost/);
  const bare = canvas({ id: 'bare', kind: 'bare', splats: [{ id: 'b', src: 'b.ply' }] });
  const page = await open(canvas({ background: 'black', accuracy: BY_TILES }), bare);
  for (const id of ['a', 'b']) await waitForLog(page, `${id} firstframe`);
  const requests = ['a.ply', 'b.ply'].map(harness.server.requests);
  const atFirst = await imageAtRest(page);
  await page.evaluate(() => {
    const { camera, invalidate } = window.page.canvases.get('canvas')!;
    camera.position.x -= 2;
    invalidate();
  });
  await expect.poll(async () => changedPart(atFirst, await image(page))).toBeGreaterThan(0.02);
  const before = await imageAtRest(page);
  await page.evaluate(() => {
    for (const id of ['canvas', 'bare']) window.page.engine(id).device.destroy();
  });
  await waitForLog(page, 'a devicelost');
  await waitForLog(page, 'b devicelost');
  await waitForLog(page, 'a firstframe', 2);
  await expect.poll(async () => changedPart(before, await image(page), 0)).toBe(0);
  // Memory holds no splats: those on the device are read again, once.
  expect(harness.server.requests('a.ply')).toBe(requests[0] + 1);
  const log = await logOf(page);
  const times = (entry: string) => log.filter((each) => each === entry).length;
  // An application replaces its Canvas by giving it another key.
  await show(page, canvas({ background: 'black', accuracy: BY_TILES }), { ...bare, id: 'bare again' });
  await waitForLog(page, 'b firstframe', 2);
  expect(harness.server.requests('b.ply')).toBe(requests[1] + 1);
  expect(['a', 'b'].map((id) => times(`${id} devicelost`))).toEqual([1, 1]);
  expect(['canvas', 'bare'].map((id) => times(`${id} created`))).toEqual([2, 1]);
});

/** Position of the Canvas's camera, rounded like what controls compute anew. */
const cameraPlace = (page: Page) =>
  page.evaluate(() =>
    window.page.canvases
      .get('canvas')!
      .camera.position.toArray()
      .map((value) => Number(value.toFixed(4))),
  );

/**
 * @fault Devices and engines: the device is lost after a visitor has turned a fitted camera
 * @consequence `<SplatBounds>` does not fit again: the camera stays as the visitor left it
 */
it.each([true, 'each'] as const)(
  'keeps a fitted camera that was turned through a loss, isFitted %s',
  async (isFitted) => {
    harness.expectProblem(/<SplatCanvas> was lost/);
    const splats = [SPLATS, { id: 'b', src: 'b.ply' }];
    const page = await open(canvas({ background: 'black', isFitted, hasControls: true, splats }));
    for (const id of ['a', 'b']) await waitForLog(page, `${id} firstframe`);
    const fitted = await atRest(page, () => cameraPlace(page));
    expect(fitted).not.toEqual([1.5, 1, 5]);
    await page.mouse.move(40, 30);
    await page.mouse.down();
    await page.mouse.move(56, 36, { steps: 3 });
    await page.mouse.up();
    const turned = await atRest(page, () => cameraPlace(page));
    expect(turned).not.toEqual(fitted);
    const before = await imageAtRest(page);
    await page.evaluate(() => window.page.engine('canvas').device.destroy());
    for (const id of ['a', 'b']) await waitForLog(page, `${id} firstframe`, 2);
    await expect.poll(async () => changedPart(before, await image(page))).toBeLessThan(0.01);
    expect(await atRest(page, () => cameraPlace(page))).toEqual(turned);
  },
);

/**
 * @fault three.js and React: splats of a glTF under frameloop="demand"
 * @consequence they are drawn, by the class of `@websplatter/react`, whose properties work
 */
it('draws the splats of a glTF on demand, as objects of its own class', async () => {
  const page = await open(canvas({ background: 'black', splats: [], gltf: 'a.glb' }));
  await page.waitForFunction(() => window.page.objects.has('gltf'));
  // Nothing but black is there before.
  await expect.poll(async () => colorsIn(await image(page))).toBeGreaterThan(50);
  const drawn = await imageAtRest(page);
  await page.evaluate(() => {
    const { invalidate } = window.page.canvases.get('canvas')!;
    window.page.objects.get('gltf')!.tint = 'red';
    invalidate();
  });
  await expect.poll(async () => changedPart(drawn, await image(page))).toBeGreaterThan(0.01);
});

/**
 * @fault three.js and React: a hook outside of the Canvas is called before there is a renderer, and memory is freed
 *   without a frame
 * @consequence it returns null, then the bytes, and 0 soon after `dispose()`, under frameloop="demand"
 */
it('tells the memory outside of the Canvas: before there is a renderer, and after a dispose', async () => {
  const page = await open(canvas({ splats: [], gltf: 'a.glb', hasOutsideHooks: true }));
  const newest = () => page.evaluate(() => window.page.outsideBytes.at(-1));
  await expect.poll(newest).toBeGreaterThan(10_000);
  expect(await page.evaluate(() => window.page.outsideBytes[0])).toBeNull();
  const { splats } = await framesOf(page);
  await page.evaluate(() => {
    const cloud = window.page.objects.get('gltf')!;
    const { data } = cloud;
    cloud.dispose();
    data?.dispose();
  });
  const left = await page.evaluate(() => window.page.engine('canvas').memory().totalBytes);
  await expect.poll(newest).toBe(left);
  expect((await framesOf(page)).splats).toBe(splats);
});

/**
 * @fault Devices and engines: the device is lost again and again in React
 * @consequence the Canvas ends in a `WebGpuUnavailableError`; another one works
 */
it('gives up where the device is lost again and again, or there is no adapter any more', async () => {
  harness.expectProblem(/<SplatCanvas> was lost/);
  harness.expectProblem(/lost again and again/);
  const page = await harness.sharedPage({}, [skipRecoveryWaits]);
  await page.goto(harness.server.url);
  await page.waitForFunction(() => 'page' in window);
  await show(page, canvas({ splats: [] }));
  for (let losses = 1; losses <= 5; losses++) {
    await waitForLog(page, 'canvas created', losses);
    await page.evaluate(() => window.page.engine('canvas').device.destroy());
  }
  const message = /^canvas fallback WebGpuUnavailableError: The GPU device was lost again and again/;
  await expect.poll(() => logOf(page)).toContainEqual(expect.stringMatching(message));
  const devices = await page.evaluate(() => window.page.devices);
  expect(devices).toEqual(expect.arrayContaining(['ready', 'lost', 'retrying']));
  expect(devices.at(-1)).toBe('gone');

  // Another one begins anew.
  harness.expectProblem(/found no GPU/);
  await show(page, canvas({ id: 'next', splats: [] }));
  await waitForLog(page, 'next created');
  await page.evaluate(() => {
    GPU.prototype.requestAdapter = async () => null;
    window.page.engine('next').device.destroy();
  });
  const noGpu = /^next fallback WebGpuUnavailableError: WebGPU found no GPU/;
  await expect.poll(() => logOf(page)).toContainEqual(expect.stringMatching(noGpu));
});

it('sends pointer events to splats, and picks the row of the file under a pixel', async () => {
  const dot = { id: 'dot', src: 'dot.ply', hasEvents: true };
  const page = await open(canvas({ kind: 'bare', splats: [dot], timings: 'outside' }));
  await waitForLog(page, 'dot firstframe');
  await page.evaluate(() => window.page.objects.get('dot')!.data!.prepareRays());
  const middle = await projected(page, [0, 0, 0]);
  await page.mouse.move(...middle);
  await page.mouse.click(...middle);
  await page.mouse.move(2, 2);
  await page.mouse.click(2, 2);
  const events = (await logOf(page)).slice(-5);
  expect(events).toEqual(['dot over', 'dot click', 'dot out', 'dot missed', 'canvas missed']);
  // The pointer event passed through it.
  await expect.poll(() => overlayOf(page).innerText()).toMatch(/Wall clock\s+\d+\.\d\d ms/);

  const dense = canvas({
    kind: 'bare',
    dpr: 2,
    splats: [{ id: 'dots', src: 'dots.ply' }],
  });
  await show(page, dense);
  await waitForLog(page, 'dots firstframe');
  // It has its size before it is drawn at that.
  await imageAtRest(page);
  for (const [row, position] of DOTS.entries()) {
    const hit = await pickAt(page, 'dots', await projected(page, position));
    expect(hit, `row ${row}`).toMatchObject({ row, isItself: true });
    for (const axis of [0, 1, 2]) expect(hit!.point[axis]).toBeCloseTo(position[axis], 1);
  }
  expect(await pickAt(page, 'dots', [2, 2])).toBeNull();
});

/** @fault three.js and React: an animation loop of three.js or react-three-fiber is faster than the GPU */
it.each([
  ['always', 'splats', 'shown'],
  ['always', 'splats', 'out of sight'],
  ['demand', 'splats', 'out of sight'],
  ['always', 'foreign', 'out of sight'],
] as const)(
  'answers pick and prepareRays within a few frames, frameloop %s, renderer %s, %s',
  async (frameloop, kind, place) => {
    const page = await open(canvas({ kind, frameloop, splats: [{ id: 'a', src: 'many.ply' }] }));
    await waitForLog(page, 'a firstframe');
    await page.getByTestId('canvas').evaluate(({ style }, isShown) => {
      Object.assign(style, { width: '480px', height: '320px', marginTop: isShown ? '0' : '10000px' });
    }, place === 'shown');
    const { isFound, ...frames } = await page.evaluate(async () => {
      const { camera, get, gl, invalidate } = window.page.canvases.get('canvas')!;
      const object = window.page.objects.get('a')!;
      let frame = 0;
      const inFrame: (() => void)[] = [];
      const render = gl.render.bind(gl);
      let isMoving = true;
      gl.render = (...args) => {
        frame++;
        render(...args);
        for (const listener of inFrame) listener();
      };
      const move = () => {
        camera.position.x = 1.5 + 0.3 * Math.sin(performance.now() / 100);
        invalidate();
        if (isMoving) requestAnimationFrame(move);
      };
      move();
      const whenFrame = (wanted: number) =>
        new Promise<void>((resolve) => inFrame.push(() => frame >= wanted && resolve()));
      await whenFrame(10);
      const framesUntil = async (answer: () => Promise<unknown>) => {
        const before = frame;
        await Promise.race([answer(), whenFrame(before + 100)]);
        return frame - before;
      };
      const pick = () => {
        const { x, y } = camera.position.clone().set(2.5, 1, 0).project(camera);
        const { left, top, width, height } = get().gl.domElement.getBoundingClientRect();
        return object.pickAt({
          clientX: left + ((1 + x) / 2) * width,
          clientY: top + ((1 - y) / 2) * height,
        });
      };
      const counted = {
        firstPick: await framesUntil(pick),
        pick: await framesUntil(pick),
        prepareRays: await framesUntil(() => object.data!.prepareRays()),
      };
      const found = await pick();
      isMoving = false;
      return { ...counted, isFound: found !== null };
    });
    expect(isFound).toBe(true);
    // A few wait for the GPU; shaders, a worker and each answer take some more, by how busy the cores are.
    // A loop that is not held back draws all 100 before it answers.
    for (const count of Object.values(frames)) expect(count, JSON.stringify(frames)).toBeLessThan(60);
  },
);

it('draws as float64 does in a Canvas with a WebGPURenderer of its own, and leaves nothing on its GPU', async () => {
  const foreign = canvas({ kind: 'foreign', background: 'black', hasStreams: true });
  const page = await open(foreign);
  await waitForLog(page, 'a firstframe');
  const camera = { ...(await cameraOf(page)), background: [0, 0, 0] as [number, number, number] };
  const psnrDb = referenceImage(camera, [testScene()], await image(page));
  await expect.poll(async () => psnrDb(await image(page))).toBeGreaterThanOrEqual(MIN_PSNR_DB);
  expect(await page.evaluate(() => window.page.streams), 'of an engine that came later').toEqual([]);
  const ended = await page.evaluate(async () => {
    const engine = window.page.engine('canvas');
    window.page.show([]);
    await engine.lost;
    return engine.memory().totalBytes;
  });
  expect(ended).toBe(0);
});

it('says what to do in a Canvas with a WebGLRenderer', async () => {
  harness.expectProblem(/draws with WebGPU: your own, that of createSplatRenderer/);
  const page = await open(canvas({ kind: 'webgl' }));
  await expect
    .poll(() => logOf(page))
    .toContainEqual(expect.stringMatching(/fallback SplatsUnsupportedRendererError: .*<SplatCanvas>/));
});

it('comes back from the end of the GPU process', async () => {
  // Pages complain about its end, each when it likes.
  const page = await harness.open('');
  await page.waitForFunction(() => 'page' in window);
  await show(page, canvas({ background: 'black', accuracy: BY_TILES }));
  await waitForLog(page, 'a firstframe');
  const before = await imageAtRest(page);
  for (const problem of [/WebGPU Device Lost/, /external Instance reference/, /<SplatCanvas> was lost/])
    harness.expectProblem(problem);
  const session = await harness.browser.newBrowserCDPSession();
  // The browser does not answer once its GPU process has crashed.
  await session.send('Browser.crashGpuProcess' as never).catch(() => {});
  await waitForLog(page, 'a devicelost');
  await waitForLog(page, 'a firstframe', 2);
  await expect.poll(async () => changedPart(before, await image(page), 0)).toBe(0);
});
