import type { SceneCamera } from '@websplatter/scenes';
import { launchBrowser } from '@websplatter/tools/browser';
import type { Browser, Page } from 'playwright-core';
import type { PeerFormats } from '../adapter.ts';
import type {
  BenchPage,
  Loaded,
  LoadRequest,
  Measured,
  MeasureRequest,
  PageState,
  Picture,
  Streamed,
  Watched,
} from '../page/protocol.ts';
import type { SizePx } from './options.ts';

/** Besides the arguments of any headless browser here: no page slows down in the background. */
const BROWSER_ARGS = [
  '--disable-renderer-backgrounding',
  '--disable-backgrounding-occluded-windows',
  '--disable-background-timer-throttling',
  '--force-device-scale-factor=1',
  '--force-color-profile=srgb',
  '--hide-scrollbars',
  // Timestamps are rounded to 0.1 ms without it.
  '--enable-webgpu-developer-features',
];

export interface VisitorOptions {
  readonly executablePath: string;
  readonly usesGpu: boolean;
  readonly timeLimitMs: number;
  /** By `performance.now()`; no visit goes on after it. */
  readonly deadlineMs: number;
  /** Address of a page without anything in it, where the GPU process settles. */
  readonly blankUrl: string;
}

export interface Heap {
  /** Objects and ArrayBuffers of the page's thread, after a garbage collection. */
  readonly jsBytes: number;
}

declare const window: { readonly bench: BenchPage };

/** A page in a browser; see {@link BenchPage}. */
export interface OpenPage {
  /** Gives the page a file, as if it had been dropped there. */
  giveFile(path: string): Promise<void>;
  formats(): Promise<PeerFormats>;
  load(request: LoadRequest): Promise<Loaded>;
  stream(request: LoadRequest): Promise<Streamed>;
  streamWatched(request: LoadRequest): Promise<Watched>;
  measure(request: MeasureRequest): Promise<Measured>;
  pictures(cameras: readonly SceneCamera[]): Promise<Picture[]>;
  state(): Promise<PageState>;
  heap(): Promise<Heap>;
}

/** Opens pages, each in a browser of its own. */
export class Visitor {
  readonly #options: VisitorOptions;

  constructor(options: VisitorOptions) {
    this.#options = options;
  }

  /** Opens the page at `url` in a fresh browser, lets `use` work with it, and ends the browser. */
  async visit<Result>(
    url: string,
    { widthPx, heightPx }: SizePx,
    use: (page: OpenPage) => Promise<Result>,
  ): Promise<Result> {
    const { timeLimitMs, deadlineMs, blankUrl, ...browserOptions } = this.#options;
    const leftMs = deadlineMs - performance.now();
    if (leftMs <= 0) throw new Error('not begun within the budget');
    const browser = await launchBrowser({ ...browserOptions, args: BROWSER_ARGS });
    const problems: string[] = [];
    const limit = timeLimit(Math.min(timeLimitMs, leftMs));
    const work = async () => {
      if (browserOptions.usesGpu) await settleGpu(browser, blankUrl);
      const viewport = { width: widthPx, height: heightPx };
      const page = await (await browser.newContext({ viewport, deviceScaleFactor: 1 })).newPage();
      page.on('pageerror', ({ message }) => problems.push(message));
      await page.goto(url);
      await page.waitForFunction(() => 'bench' in window);
      return Promise.race([use(openPage(page)), crashOf(page)]);
    };
    try {
      return await Promise.race([work(), limit.passed]);
    } catch (error) {
      throw new Error([...new Set([reasonOf(error), ...problems])].join('; '));
    } finally {
      limit.end();
      await browser.close();
    }
  }
}

/** The page's own message: Playwright puts the call in front of it, and the call stack behind. */
function reasonOf(error: unknown): string {
  const [message] = (error as Error).message.split('\n');
  return message.replace(/^page\.evaluate: /, '');
}

function openPage(page: Page): OpenPage {
  return {
    giveFile: (path) => page.setInputFiles('input', path),
    formats: () => page.evaluate(() => window.bench.formats()),
    load: (request) => page.evaluate((asked) => window.bench.load(asked), request),
    stream: (request) => page.evaluate((asked) => window.bench.stream(asked), request),
    streamWatched: (request) => page.evaluate((asked) => window.bench.streamWatched(asked), request),
    measure: (request) => page.evaluate((asked) => window.bench.measure(asked), request),
    pictures: (cameras) => page.evaluate((by) => window.bench.pictures(by), cameras),
    state: () => page.evaluate(() => window.bench.state()),
    heap: async () => {
      const session = await page.context().newCDPSession(page);
      await session.send('HeapProfiler.collectGarbage');
      const { usedSize, backingStorageSize = 0 } = await session.send('Runtime.getHeapUsage');
      return { jsBytes: usedSize + backingStorageSize };
    },
  };
}

/** Rejects when the page crashes: its calls would wait for ever. */
function crashOf(page: Page): Promise<never> {
  return new Promise((_, reject) => {
    page.on('crash', () => reject(new Error('the page crashed')));
  });
}

function timeLimit(limitMs: number): { readonly passed: Promise<never>; end(): void } {
  let timer: NodeJS.Timeout | undefined;
  const passed = new Promise<never>((_, reject) => {
    timer = setTimeout(() => reject(new Error(`not done within ${(limitMs / 1000).toFixed(0)} s`)), limitMs);
  });
  return { passed, end: () => clearTimeout(timer) };
}

const SETTLE_ATTEMPTS = 12;
const SETTLED_AFTER_MS = 600;

/**
 * Waits on a blank page until a device and a WebGL context have lived for a while: on an NVIDIA
 * H200 the GPU process can die once, soon after the browser's start, and takes the first of both
 * with it.
 */
async function settleGpu(browser: Browser, blankUrl: string): Promise<void> {
  const context = await browser.newContext();
  const page = await context.newPage();
  await page.goto(blankUrl);
  await page.evaluate(
    async ({ attempts, aliveMs }) => {
      for (let attempt = 0; attempt < attempts; attempt++) {
        const gl = document.createElement('canvas').getContext('webgl2');
        // While the GPU restarts, either may be refused: the next attempt asks again.
        const adapter = await navigator.gpu?.requestAdapter().catch(() => null);
        const device = await adapter?.requestDevice().catch(() => null);
        let isLost = false;
        device?.lost.then(() => {
          isLost = true;
        });
        await new Promise((resolve) => setTimeout(resolve, aliveMs));
        const lives = gl && !gl.isContextLost() && device && !isLost;
        gl?.getExtension('WEBGL_lose_context')?.loseContext();
        device?.destroy();
        if (lives) return;
      }
    },
    { attempts: SETTLE_ATTEMPTS, aliveMs: SETTLED_AFTER_MS },
  );
  await context.close();
}
