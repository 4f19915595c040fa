// Proves: the READMEs' install lines and first blocks show a scene, as pasted.
import { mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { frameScene, perspectiveCamera, readSplats, SplatEngine } from '@websplatter/core';
import { transformSplats, writeSplats } from '@websplatter/core/write';
import { createNodeGpu } from '@websplatter/node';
import { builtinScenes } from '@websplatter/scenes';
import type { Browser } from 'playwright-core';
import { afterAll, beforeAll, expect, it } from 'vitest';
import { launchBrowser, newWatchedPage } from './browser.ts';
import { makeFreshApp } from './fresh-app.ts';
import { examplesIn, installedBy } from './readme-examples.ts';
import { drawnBy, MIN_PSNR_DB, referenceImage } from './reference.ts';
import { type Screenshot, screenshot } from './screenshot.ts';
import { slowDisplay } from './slow-display.ts';

const repositoryRoot = fileURLToPath(new URL('..', import.meta.url));

/** Documents whose first install line is tried, each with the number of a block. */
const BLOCKS = [
  ['README.md', 0],
  ['packages/react/README.md', 0],
  ['packages/three/README.md', 0],
  ['packages/core/README.md', 0],
  ['apps/docs/pages/learn/quick-start.md', 0],
  ['apps/docs/pages/learn/quick-start.md', 1],
  ['apps/docs/pages/learn/quick-start.md', 2],
] as const;

/** Software draws the built-in scene in it within a second. */
const SMALL = { width: 480, height: 320 };

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

/** Finds the packages of the first install line, and a block that follows it. */
function pastedFrom(document: string, number: number) {
  const text = readFileSync(join(repositoryRoot, document), 'utf8');
  const { 0: line, index } = /^npm install .*$/m.exec(text)!;
  const { language, code } = examplesIn(text.slice(index))[number];
  // Apps made from a template have React already.
  return { dependencies: [...new Set([...installedBy(line), 'react', 'react-dom'])], language, code };
}

/** An app as `npm create vite` makes it: with React where the block is one of it, else without. */
function viteApp(language: string, code: string) {
  const page = (script: string) =>
    `<!doctype html><html lang="en"><head><title>Fresh</title><link rel="icon" href="/icon.svg"></head>` +
    `<body style="margin: 0"><div id="root"></div><script type="module" src="/src/${script}"></script></body></html>`;
  const icon = { 'public/icon.svg': '<svg xmlns="http://www.w3.org/2000/svg" />' };
  if (language === 'ts') return { ...icon, 'index.html': page('main.ts'), 'src/main.ts': code };
  return {
    ...icon,
    'index.html': page('main.tsx'),
    'src/App.tsx': code,
    'src/main.tsx': `import { StrictMode } from 'react';
import { createRoot } from 'react-dom/client';
import App from './App.tsx';

createRoot(document.getElementById('root')!).render(
  <StrictMode>
    <App />
  </StrictMode>,
);
`,
    'vite.config.ts': `import react from '@vitejs/plugin-react';
import { defineConfig } from 'vite';

export default defineConfig({ plugins: [react()] });
`,
  };
}

/** The sample scene as captures are: y points down, and a sky is around it. */
async function capture(): Promise<Uint8Array> {
  const { url } = builtinScenes.find(({ name }) => name === 'still-life-small')!;
  const set = await readSplats(readFileSync(url));
  return writeSplats(transformSplats(set, { rotation: [0, 1, 0, 0] }), 'ply');
}

/** Vertical field of view of a block's camera: react-three-fiber's, or that of the three.js block and the engine. */
const FOV_DEGREES: Readonly<Record<string, number>> = { tsx: 75, ts: 50 };

/**
 * Draws in float64 what a block should show: the whole scene from the engine's first camera. Returns a
 * function that computes the PSNR of a screenshot of a white page against it.
 */
async function expectedPicture(language: string, code: string): Promise<(shot: Screenshot) => number> {
  const bytes = code.includes('garden.ply') ? garden : readFileSync(builtinScenes[0].url);
  const set = await readSplats(bytes);
  const aspect = SMALL.width / SMALL.height;
  const cloud = engine.add(set);
  const framing = await frameScene([{ cloud }], { aspect, fovYDegrees: FOV_DEGREES[language] });
  cloud.destroy();
  const camera = perspectiveCamera({ ...framing!, aspect });
  const size = { widthPx: SMALL.width, heightPx: SMALL.height };
  return referenceImage(drawnBy(camera, [1, 1, 1]), [set], size);
}

/**
 * @fault Pages and packages: a README's install line and first block are pasted into a fresh Vite app
 * @consequence the tests fail unless the page shows what float64 draws
 */
it.each(BLOCKS)('%s: its install line and block %i show what float64 draws', async (document, number) => {
  const { dependencies, language, code } = pastedFrom(document, number);
  // The scene is the block's own, or a file that its reader has.
  expect(code).toMatch(/["']\/garden\.ply["']|builtinScenes/);
  const psnrOf = await expectedPicture(language, code);
  const app = await makeFreshApp({
    dependencies,
    lockedPackages: ['@vitejs/plugin-react', 'vite'],
    sources: viteApp(language, code),
    files: { 'garden.ply': garden },
  });
  try {
    await app.run('vite/bin/vite.js', ['build', '--logLevel', 'warn']);
    const args = ['preview', '--host', '127.0.0.1', '--port', '0', '--logLevel', 'info'];
    const server = await app.serve('vite/bin/vite.js', args);
    const { page, problems } = await newWatchedPage(browser, { viewport: SMALL });
    try {
      await page.addInitScript(slowDisplay);
      await page.goto(server.url);
      await expect
        .poll(async () => (problems.length > 0 ? problems : psnrOf(await screenshot(page))), {
          interval: 250,
        })
        .toBeGreaterThan(MIN_PSNR_DB);
      expect(problems).toEqual([]);
    } finally {
      keepPicture(`${document.replaceAll('/', '-')}-${number}.png`, await page.screenshot());
      await page.context().close();
      await server.close();
    }
  } finally {
    await app.remove();
  }
});

/** Keeps a picture to look at, in the folder that `WEBSPLATTER_PICTURES` names. */
function keepPicture(name: string, png: Buffer): void {
  const folder = process.env.WEBSPLATTER_PICTURES;
  if (folder === undefined) return;
  const path = join(folder, name);
  mkdirSync(dirname(path), { recursive: true });
  writeFileSync(path, png);
}
