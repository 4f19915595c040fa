// Proves: the READMEs' install lines and first blocks show a scene, as pasted.
import { mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { frameScene, perspectiveCamera, readSplats, SplatEngine } from '@websplatter/core';
import { transformSplats, writeSplats } from '@websplatter/core/write';
import { createNodeGpu } from '@websplatter/node';
import { builtinScenes } from '@websplatter/scenes';
import type { Browser, Page } from 'playwright-core';
import { afterAll, beforeAll, expect, it } from 'vitest';
import { launchBrowser, newWatchedPage } from './browser.ts';
import { makeFreshApp } from './fresh-app.ts';
import { examplesIn, installedBy } from './readme-examples.ts';
import { drawnBy, MIN_PSNR_DB, referenceImage } from './reference.ts';
import { type Screenshot, screenshot } from './screenshot.ts';
import { slowDisplay } from './slow-display.ts';

const repositoryRoot = fileURLToPath(new URL('..', import.meta.url));

/** Ends tools that hang: on a busy machine, an app has taken three minutes. */
const TIMEOUT_MS = 1_200_000;

type Block = readonly [document: string, number: number];

/**
 * Documents whose first install line is tried, each with the number of a block. Blocks whose lines install the same
 * packages are pages of one app.
 */
const APPS: readonly (readonly Block[])[] = [
  [
    ['README.md', 0],
    ['apps/docs/pages/learn/quick-start.md', 0],
    ['apps/docs/pages/learn/quick-start.md', 1],
    ['apps/docs/pages/learn/quick-start.md', 2],
  ],
  [['packages/react/README.md', 0]],
  [['packages/three/README.md', 0]],
  [['packages/core/README.md', 0]],
];

/** Software draws the built-in scene in it within a second. */
const SMALL = { width: 240, height: 160 };

let browser: Browser;
let engine: SplatEngine;
let garden: Uint8Array;

beforeAll(async () => {
  browser = await launchBrowser();
  engine = await SplatEngine.create(await createNodeGpu());
  garden = await capture();
});
afterAll(async () => {
  engine?.destroy();
  await browser?.close();
});

interface Code {
  readonly language: string;
  readonly code: string;
}

/** Finds the packages of the first install line, and a block that follows it. */
function pastedFrom(document: string, number: number) {
  const text = readFileSync(join(repositoryRoot, document), 'utf8');
  const { 0: line, index } = /^npm install .*$/m.exec(text)!;
  const { language, code } = examplesIn(text.slice(index))[number];
  // Apps made from a template have React already.
  return { dependencies: [...new Set([...installedBy(line), 'react', 'react-dom'])].sort(), language, code };
}

/** An app as `npm create vite` makes it, with one page for each code: with React where it is TSX, else without. */
function viteApp(codes: readonly Code[]) {
  const page = (script: string) =>
    `<!doctype html><html lang="en"><head><title>Fresh</title><link rel="icon" href="/icon.svg"></head>` +
    `<body style="margin: 0"><div id="root"></div><script type="module" src="/src/${script}"></script></body></html>`;
  const sources: Record<string, string> = {
    'public/icon.svg': '<svg xmlns="http://www.w3.org/2000/svg" />',
    'vite.config.ts': `import react from '@vitejs/plugin-react';
import { defineConfig } from 'vite';

export default defineConfig({
  plugins: [react()],
  build: { rolldownOptions: { input: ${JSON.stringify(codes.map((_, i) => `${i}.html`))} } },
});
`,
  };
  for (const [i, { language, code }] of codes.entries()) {
    sources[`${i}.html`] = page(`${i}/main.${language}`);
    if (language === 'ts') sources[`src/${i}/main.ts`] = code;
    else {
      sources[`src/${i}/App.tsx`] = code;
      sources[`src/${i}/main.tsx`] = `import { StrictMode } from 'react';
import { createRoot } from 'react-dom/client';
import App from './App.tsx';

createRoot(document.getElementById('root')!).render(
  <StrictMode>
    <App />
  </StrictMode>,
);
`;
    }
  }
  return sources;
}

/** The sample scene as captures are: y points down, and a sky is around it. */
async function capture(): Promise<Uint8Array> {
  const { url } = builtinScenes.find(({ name }) => name === 'still-life-small')!;
  const set = await readSplats(readFileSync(url));
  return writeSplats(transformSplats(set, { rotation: [0, 1, 0, 0] }), 'ply');
}

/** Vertical field of view of a block's camera: react-three-fiber's, or that of the three.js block and the engine. */
const FOV_DEGREES: Readonly<Record<string, number>> = { tsx: 75, ts: 50 };

type Compare = (shot: Screenshot) => number;

/** Pictures that blocks should show, by language and scene. */
const expectedPictures = new Map<string, Promise<Compare>>();

/**
 * Draws in float64 what a block should show: the whole scene from the engine's first camera. Resolves with a
 * function that computes the PSNR of a screenshot of a white page against it.
 */
function expectedPicture({ language, code }: Code): Promise<Compare> {
  const isGarden = code.includes('garden.ply');
  const key = `${language} ${isGarden}`;
  const expected = expectedPictures.get(key) ?? drawExpected(isGarden, FOV_DEGREES[language]);
  expectedPictures.set(key, expected);
  return expected;
}

async function drawExpected(isGarden: boolean, fovYDegrees: number): Promise<Compare> {
  const set = await readSplats(isGarden ? garden : readFileSync(builtinScenes[0].url));
  const aspect = SMALL.width / SMALL.height;
  const cloud = engine.add(set);
  const framing = await frameScene([{ cloud }], { aspect, fovYDegrees });
  cloud.destroy();
  const camera = perspectiveCamera({ ...framing!, aspect });
  const size = { widthPx: SMALL.width, heightPx: SMALL.height };
  return referenceImage(drawnBy(camera, [1, 1, 1]), [set], size);
}

/** Opens a page, and waits until it shows its block's picture. */
async function expectPicture(url: string, block: Code, name: string): Promise<void> {
  const psnrOf = await expectedPicture(block);
  const { page, problems } = await newWatchedPage(browser, { viewport: SMALL });
  try {
    await page.addInitScript(slowDisplay);
    await page.goto(url);
    await expect
      .poll(async () => (problems.length > 0 ? Infinity : psnrOf(await screenshot(page))), { interval: 250 })
      .toBeGreaterThan(MIN_PSNR_DB);
    expect(problems).toEqual([]);
  } finally {
    await keepPicture(page, name);
    await page.context().close();
  }
}

/**
 * @fault Pages and packages: a README's install line and first block are pasted into a fresh Vite app
 * @consequence the tests fail unless the page shows what float64 draws
 */
it.each(APPS.map((blocks) => [blocks.map((block) => block.join(' ')).join(', '), blocks] as const))(
  'blocks in an app of their install line show what float64 draws: %s',
  async (_, blocks) => {
    const pasted = blocks.map((block) => pastedFrom(...block));
    const [{ dependencies }] = pasted;
    for (const each of pasted) {
      expect(each.dependencies).toEqual(dependencies);
      // The scene is the block's own, or a file that its reader has.
      expect(each.code).toMatch(/["']\/garden\.ply["']|builtinScenes/);
    }
    // The same block of two documents is tried once.
    const codes = [...new Map(pasted.map((each) => [each.code, each])).values()];
    const app = await makeFreshApp({
      dependencies,
      lockedPackages: ['@vitejs/plugin-react', 'vite'],
      sources: viteApp(codes),
      files: { 'garden.ply': garden },
    });
    try {
      await app.run('vite/bin/vite.js', ['build', '--logLevel', 'warn']);
      const args = ['preview', '--host', '127.0.0.1', '--port', '0', '--logLevel', 'info'];
      const server = await app.serve('vite/bin/vite.js', args);
      try {
        for (const [i, code] of codes.entries()) {
          const [document, number] = blocks[pasted.indexOf(code)];
          await expectPicture(`${server.url}${i}.html`, code, `${document.replaceAll('/', '-')}-${number}`);
        }
      } finally {
        await server.close();
      }
    } finally {
      await app.remove();
    }
  },
  TIMEOUT_MS,
);

/** Keeps a picture to look at, in the folder that `WEBSPLATTER_PICTURES` names. */
async function keepPicture(page: Page, name: string): Promise<void> {
  const folder = process.env.WEBSPLATTER_PICTURES;
  if (folder === undefined) return;
  mkdirSync(folder, { recursive: true });
  writeFileSync(join(folder, `${name}.png`), await page.screenshot());
}
