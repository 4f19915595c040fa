import type { FrameRequest } from '@websplatter/core';
import type { BrowserContextOptions, Page } from 'playwright-core';
import { appHarness, type Harness } from './harness.ts';
import { type Screenshot, screenshot } from './screenshot.ts';
import type { ServedFiles } from './server.ts';

/**
 * URL parameters for pages whose picture is not tested: few pixels and few shaders. Drawn by tiles:
 * for some thousand splats, quads take SwiftShader half as long again at any number of pixels. In full:
 * frames that count as slow would have levels made, in the middle of a test, on a busy machine.
 */
export const CHEAPLY = 'accuracy=fast,resolutionScale:0.25,rasterizer:tiles&detail=full';
/** Query of a small scene with the parameters CHEAPLY. */
export const CHEAP = `?scene=still-life-small&${CHEAPLY}`;
/** A window for pictures that are compared: SwiftShader takes its time for every pixel. */
export const SMALL = { viewport: { width: 240, height: 160 } } as const;

/** A harness that serves the viewer. */
export interface ViewerHarness extends Harness {
  /** Opens a page at the viewer's `address`, by default a small scene; awaits its first image. */
  openViewer(address?: string, options?: BrowserContextOptions): Promise<Page>;
  /** The same in a window that tests share (`openShared`). */
  shareViewer(address: string, options?: BrowserContextOptions): Promise<Page>;
}

export function viewerHarness(files: ServedFiles = {}): ViewerHarness {
  const harness = appHarness('apps/viewer', files, noteViewer);
  const openViewer = async (address = '?scene=still-life-small', options: BrowserContextOptions = {}) => {
    const page = await harness.open(address, options);
    await waitForImage(page);
    return page;
  };
  const shareViewer = async (address: string, options: BrowserContextOptions = {}) => {
    const page = await harness.openShared(address, options);
    await waitForImage(page);
    return page;
  };
  return Object.assign(harness, { openViewer, shareViewer });
}

/** Removes the margin that the picture has below the toolbar, to compare it with a page without toolbar. */
export async function giveToolbarNoRoom(page: Page): Promise<void> {
  await redraw(page, () =>
    page.evaluate(() => document.documentElement.style.setProperty('--free-top', '0px', 'important')),
  );
}

/** The camera of a picture, and how its clouds stand. */
export interface DrawnCamera {
  readonly viewMatrix: number[];
  readonly projectionMatrix: number[];
  readonly near: number;
  readonly far: number;
  /** Matrix of each cloud; null for the identity. */
  readonly modelMatrices: (number[] | null)[];
  /** Opacity of each cloud; 1 where it is absent. */
  readonly opacities?: number[];
  readonly background: [number, number, number];
}

interface StoreState {
  readonly restedFrames: number;
  readonly scene: { readonly title: string } | null;
}

/** What `noteViewer` keeps in the page; there is no viewer before its script has run. */
export interface ViewerWindow {
  readonly viewer?: {
    readonly isAtRest: boolean;
    readonly shownFrame: { readonly frame: FrameRequest } | null;
  };
  readonly store: {
    getState(): StoreState;
    subscribe(of: (state: StoreState) => number, onChange: () => void): () => void;
  };
  readonly notices: string[];
}

/**
 * For `addInitScript`: keeps the viewer of the page, and the texts of all notices, which go away after eight
 * seconds.
 */
export function noteViewer(): void {
  addEventListener('viewer', (event) => Object.assign(window, (event as CustomEvent).detail));
  const notices: string[] = [];
  let last: string | null = null;
  Object.assign(window, { notices });
  new MutationObserver(() => {
    const notice = document.querySelector('[data-testid=notice]');
    const text = notice?.checkVisibility() ? notice.textContent : null;
    if (text !== null && text !== last) notices.push(text);
    last = text;
  }).observe(document, { childList: true, characterData: true, subtree: true });
}

/** For any browser's `evaluate`: the viewer's state, for the error of a failed wait. */
export function stateOfPage() {
  const { viewer, store, notices } = window as unknown as ViewerWindow;
  return {
    title: document.title,
    ...document.documentElement.dataset,
    isAtRest: viewer?.isAtRest,
    hasPicture: !!viewer?.shownFrame,
    frames: viewer && store.getState().restedFrames,
    loadPhase: document.querySelector('[data-testid=load-phase]')?.textContent,
    notices,
    error: document.querySelector('[data-testid=error]')?.textContent,
  };
}

/** Adds `what`, the awaited thing, and the viewer's state to the error of a failed wait. */
async function awaited(page: Page, what: string, wait: Promise<unknown>): Promise<void> {
  try {
    await wait;
  } catch (error) {
    // With a time limit: a page that hangs does not answer.
    const found = await page
      .waitForFunction(stateOfPage, undefined, { timeout: 5000 })
      .then((handle) => handle.jsonValue())
      .catch(String);
    throw new Error(`${what} did not come. The page tells ${JSON.stringify(found)}`, { cause: error });
  }
}

/** Waits until the viewer is in `state` (`data-state` of the document). */
export async function waitForState(page: Page, state: string): Promise<void> {
  await awaited(page, `The state “${state}”`, page.waitForSelector(`html[data-state="${state}"]`));
}

/** For any browser's `evaluate`: how many frames had been drawn when the picture last came to rest. */
export function framesAtRest(): number {
  const { viewer, store } = window as unknown as ViewerWindow;
  return viewer ? store.getState().restedFrames : 0;
}

export const frameCount = (page: Page): Promise<number> => page.evaluate(framesAtRest);

/**
 * For any browser's `waitForFunction`: whether the viewer has drawn more than `frames` frames and
 * is at rest. Input events end the rest at once, so a frame drawn before the input does not count.
 */
export function isAtRestAfter(frames: number): boolean {
  const { viewer, store } = window as unknown as ViewerWindow;
  return !!viewer?.isAtRest && viewer.shownFrame !== null && store.getState().restedFrames > frames;
}

/** For any browser's `waitForFunction`: whether the page is in `state`, and a picture at rest, of the scene `title` if it has one. */
export function isSceneAtRest({
  title,
  state,
}: {
  readonly title?: string;
  readonly state: string;
}): boolean {
  const { viewer, store } = window as unknown as ViewerWindow;
  if (document.documentElement.dataset.state !== state || !viewer?.isAtRest || !viewer.shownFrame)
    return false;
  return title === undefined || store.getState().scene?.title === title;
}

/** For any browser's `evaluate`: the camera of the picture on the screen; null if there is none. */
export function cameraOnScreen(): DrawnCamera | null {
  const { viewer } = window as unknown as ViewerWindow;
  const frame = viewer?.shownFrame?.frame;
  if (!frame) return null;
  const { camera, clouds, background = [0, 0, 0] } = frame;
  return {
    viewMatrix: Array.from(camera.viewMatrix),
    projectionMatrix: Array.from(camera.projectionMatrix),
    near: camera.near,
    far: camera.far,
    modelMatrices: clouds.map(({ modelMatrix }) => (modelMatrix ? Array.from(modelMatrix) : null)),
    opacities: clouds.map(({ opacity = 1 }) => opacity),
    background: [...background],
  };
}

/** Waits until the viewer has drawn more than `frames` frames and is at rest. */
async function waitForFrameAfter(page: Page, frames: number): Promise<void> {
  await awaited(page, `A rest after frame ${frames}`, page.waitForFunction(isAtRestAfter, frames));
}

/**
 * Changes the picture in one step by `act`, and waits until the new one is at rest. A file changes
 * it in several steps: use `waitForScene` then.
 */
export async function redraw(page: Page, act: () => Promise<unknown>): Promise<void> {
  // Frames are counted at rest: wait for frames of earlier actions before counting.
  await waitForFrameAfter(page, 0);
  const frames = await frameCount(page);
  await act();
  await waitForFrameAfter(page, frames);
}

/** Waits for the first picture of a page that was just opened, and until no file is loading. */
export async function waitForImage(page: Page): Promise<void> {
  await awaited(page, 'A picture', page.waitForFunction(isSceneAtRest, { state: 'ready' }));
}

/** Waits until the picture at rest shows the scene of this title, with the viewer in `state`. */
export async function waitForScene(page: Page, title: string, state = 'ready'): Promise<void> {
  const wait = page.waitForFunction(isSceneAtRest, { title, state });
  await awaited(page, `A picture of “${title}” in the state “${state}”`, wait);
}

/** Waits for a notice with this text after the last awaited notice, also one that has vanished since. */
export async function waitForNotice(page: Page, text: string): Promise<void> {
  const isNoted = (wanted: string) => {
    const { notices } = window as unknown as { notices: string[] };
    const index = notices.findIndex((each) => each.includes(wanted));
    notices.splice(0, index + 1);
    return index >= 0;
  };
  await awaited(page, `A notice “${text}”`, page.waitForFunction(isNoted, text));
}

/** Locator of the enabled element: disabled buttons ignore clicks by scripts. */
const enabled = (page: Page, testId: string) => page.locator(`[data-testid=${testId}]:not(:disabled)`);

/** Clicks by a script: the button may be outside of the tests' small windows. */
export const press = (page: Page, testId: string): Promise<void> =>
  enabled(page, testId).evaluate((button: HTMLElement) => button.click());

/** Opens the panel that saves and shares, at one of its tabs. */
export async function openSaveTab(page: Page, tab: 'share' | 'picture' | 'file'): Promise<void> {
  await page.keyboard.press('x');
  await press(page, `save-tab-${tab}`);
}

/**
 * Clicks on `first`, then on `second` as soon as it exists. The second click is made by a script in
 * the page, because `second` vanishes when the work of `first` is done.
 */
export async function clickInTurn(page: Page, first: string, second: string): Promise<void> {
  await enabled(page, first).waitFor();
  const clicks = page.waitForFunction(
    ([a, b]) =>
      new Promise<boolean>((resolve) => {
        const buttonOf = (testId: string) => document.querySelector<HTMLElement>(`[data-testid=${testId}]`);
        const observer = new MutationObserver(() => {
          const button = buttonOf(b);
          if (!button) return;
          observer.disconnect();
          button.click();
          resolve(true);
        });
        observer.observe(document, { childList: true, subtree: true });
        buttonOf(a)!.click();
      }),
    [first, second] as const,
  );
  await awaited(page, `“${second}” after a click on “${first}”`, clicks);
}

/** Shows the figures of stages and splats: in windows as small as those of tests there is one line. */
export const showFigures = (page: Page): Promise<void> => press(page, 'hud-more');

export async function textOf(page: Page, testId: string): Promise<string> {
  return (await page.getByTestId(testId).textContent()) ?? '';
}

export async function drawnCamera(page: Page): Promise<DrawnCamera> {
  return (await page.evaluate(cameraOnScreen))!;
}

/** Style that hides the viewer's interface. */
export const IMAGE_ALONE =
  '.overlay, .drop-overlay, .axis-handles, .annotation-markers { visibility: hidden !important; } canvas { outline: none !important; }';

/** Captures the image on the screen without the interface over it; `style` (CSS) may hide more. */
export function viewerScreenshot(page: Page, style = ''): Promise<Screenshot> {
  return screenshot(page, `${IMAGE_ALONE} ${style}`);
}

/** For `addInitScript`: makes the page lose its device on the event `lose-device`. */
export function loseDeviceOnDemand(): void {
  // Firefox runs this in documents without WebGPU too.
  if (typeof GPUAdapter === 'undefined') return;
  const requestDevice = GPUAdapter.prototype.requestDevice;
  GPUAdapter.prototype.requestDevice = async function (...options) {
    const device = await requestDevice.apply(this, options);
    addEventListener('lose-device', () => device.destroy(), { once: true });
    return device;
  };
}

export interface DroppedFile {
  readonly name: string;
  readonly bytes: Uint8Array;
}

/**
 * Drags `files` over the canvas, calls `whileHovering`, and drops them.
 *
 * @param held pressed modifier keys, and the position in the window.
 */
export async function dropFiles(
  page: Page,
  files: readonly DroppedFile[],
  whileHovering: () => Promise<void> = async () => {},
  held: Pick<DragEventInit, 'shiftKey' | 'clientX' | 'clientY'> = {},
): Promise<void> {
  const encoded = files.map(({ name, bytes }) => ({ name, base64: Buffer.from(bytes).toString('base64') }));
  const transfer = await page.evaluateHandle((list) => {
    const dataTransfer = new DataTransfer();
    for (const { name, base64 } of list) {
      const bytes = Uint8Array.from(atob(base64), (character) => character.charCodeAt(0));
      dataTransfer.items.add(new File([bytes], name));
    }
    return dataTransfer;
  }, encoded);
  const target = page.getByTestId('viewport');
  const init = { ...held, dataTransfer: transfer };
  await target.dispatchEvent('dragenter', init);
  await target.dispatchEvent('dragover', init);
  await whileHovering();
  await target.dispatchEvent('drop', init);
}
