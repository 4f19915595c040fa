// Proves: the tarballs in a fresh Vite app, built and served, and in one by esbuild.
import { copyFile } from 'node:fs/promises';
import { join } from 'node:path';
import { encodePly } from '@websplatter/core';
import { type FileServer, serveFiles } from '@websplatter/tools/file-server';
import type { Browser } from 'playwright-core';
import { afterAll, beforeAll, describe, expect, it } from 'vitest';
import { launchBrowser } from './browser.ts';
import { type ExpectSplatsOptions, expectSplats } from './expect-splats.ts';
import { type FreshApp, makeFreshApp } from './fresh-app.ts';
import { html, main } from './fresh-apps.ts';
import { type Screenshot, screenshot } from './screenshot.ts';
import { CONTENT_SECURITY_POLICY } from './server.ts';
import { testScene } from './test-scene.ts';

const PACKAGES = [
  '@types/react',
  '@types/react-dom',
  '@types/three',
  '@vitejs/plugin-react',
  'esbuild',
  'typescript',
  'vite',
];

/** The app as `npm create vite` makes it, more or less. */
const SOURCES: Readonly<Record<string, string>> = {
  'index.html': `<!doctype html>
<html lang="en">
  <head>
    <title>Fresh</title>
    <link rel="icon" href="/icon.svg" />
    <link rel="stylesheet" href="/src/page.css" />
  </head>
  <body>
    <div id="root"></div>
    <script type="module" src="/src/main.tsx"></script>
  </body>
</html>
`,
  'vite.config.ts': `import react from '@vitejs/plugin-react';
import { defineConfig } from 'vite';

export default defineConfig({
  plugins: [react()],
  preview: { headers: { 'content-security-policy': "${CONTENT_SECURITY_POLICY}" } },
});
`,
  'public/icon.svg': '<svg xmlns="http://www.w3.org/2000/svg" />',
  'src/page.css': `body { margin: 0; }
#root { height: 100vh; }
`,
  // Strict, and without skipLibCheck, so that the declarations of dependencies are checked too.
  'tsconfig.json': `{
  "compilerOptions": {
    "target": "ES2022",
    "module": "ESNext",
    "moduleResolution": "bundler",
    "lib": ["ES2022", "DOM", "DOM.Iterable"],
    "jsx": "react-jsx",
    "types": [],
    "strict": true,
    "noEmit": true
  },
  "include": ["src"]
}
`,
  'src/main.tsx': `import { StrictMode } from 'react';
import { createRoot } from 'react-dom/client';
import { App } from './app';

createRoot(document.getElementById('root')!).render(
  <StrictMode>
    <App />
  </StrictMode>,
);
`,
  'src/app.tsx': `import { Canvas } from '@react-three/fiber';
import { createSplatRenderer, Splats } from '@websplatter/react';

export function App() {
  return (
    <Canvas gl={createSplatRenderer} flat>
      <Splats src="scene.ply" />
    </Canvas>
  );
}
`,
};

/** What users may set on `<Splats>`, and nothing of its object's own: a type error if it is not so. */
const PROPS = `import type { EventHandlers } from '@react-three/fiber';
import type { SplatsProps } from '@websplatter/react';

type Own =
  | 'src' | 'sourceOptions' | 'budgetBytes' | 'fallback' | 'accuracy' | 'detail'
  | 'onLoad' | 'onProgress' | 'onFirstFrame' | 'onComplete' | 'onAccuracyChosen' | 'onError' | 'onDeviceLost'
  | 'fade' | 'opacity' | 'relight' | 'shDegree' | 'time' | 'depthWrite' | 'fog' | 'effects' | 'instances'
  | 'antialias' | 'brightness' | 'depthOfField' | 'grade' | 'highlight' | 'reveal' | 'tint' | 'volumes';
type OfAnyObject =
  | keyof EventHandlers | 'onUpdate' | 'animations' | 'children' | 'dispose' | 'frustumCulled' | 'raycast' | 'key' | 'name' | 'ref' | 'userData'
  | 'matrix' | 'matrixAutoUpdate' | 'matrixWorldAutoUpdate' | 'position' | 'quaternion' | 'rotation' | 'scale' | 'up'
  | 'castShadow' | 'layers' | 'receiveShadow' | 'renderOrder' | 'visible';

export const offered: Record<Own | OfAnyObject, true> = {} as Record<keyof SplatsProps, true>;
export const known: Record<keyof SplatsProps, true> = {} as Record<Own | OfAnyObject, true>;
`;

/** esbuild understands no workers, so the app hosts the one that reads all formats. */
const ESBUILD_SOURCES: Readonly<Record<string, string>> = {
  'esbuild/main.js': main("if (!location.search) setWorkerUrl('load-worker.js');"),
  'esbuild/load-worker.js': "import '@websplatter/core/load-worker';\n",
  'esbuild/index.html': html('main.js'),
};

let app: FreshApp;
let browser: Browser;

beforeAll(async () => {
  [app, browser] = await Promise.all([
    makeFreshApp({
      lockedPackages: PACKAGES,
      sources: { ...SOURCES, 'src/props.ts': PROPS, ...ESBUILD_SOURCES },
      files: { 'scene.ply': encodePly(testScene()) },
    }),
    launchBrowser(),
  ]);
});

afterAll(async () => {
  await browser?.close();
  await app?.remove();
});

describe('the packed tarballs in a fresh Vite app', () => {
  it('type-check, strictly and down to the last declaration', async () => {
    await app.run('typescript/bin/tsc', ['--noEmit']);
  });

  /**
   * @fault Pages and packages: a strict content security policy around packages from npm
   * @consequence the worker reads, the image is right
   */
  it('build, and show splats that a worker has read', async () => {
    await app.run('vite/bin/vite.js', ['build', '--logLevel', 'warn']);
    await expectVite('preview');
  });

  it('show splats under the development server, without any configuration, and as they are edited', async () => {
    await expectVite('dev', async (page) => {
      const messages = async () => (await page.consoleMessages()).map((message) => message.text());
      // Edits before the connection are not sent.
      await expect.poll(messages).toContain('[vite] connected.');
      // Fast Refresh keeps Canvas and renderer; an effect run anew would read the file again.
      await page.evaluate(() => Object.assign(document.querySelector('canvas')!, { isOfBefore: true }));
      const undo = await app.edit('src/app.tsx', '<Splats src', '<Splats opacity={0} src');
      try {
        await expect.poll(messages).toContain('[vite] hot updated: /src/app.tsx');
        const served = await page.request.get(new URL('src/app.tsx', page.url()).href);
        expect(await served.text(), 'the module that Vite serves').toContain('opacity: 0');
        await expect.poll(async () => isAllWhite(await screenshot(page))).toBe(true);
        expect(await page.evaluate(() => 'isOfBefore' in document.querySelector('canvas')!)).toBe(true);
      } finally {
        await undo();
      }
    });
  });
});

describe('the packed tarballs in a fresh app by esbuild', () => {
  let host: FileServer;

  beforeAll(async () => {
    const bundled = ['esbuild/main.js', 'esbuild/load-worker.js'];
    const flags = ['--bundle', '--splitting', '--format=esm', '--minify', '--outdir=esbuild-built'];
    await app.run('esbuild/bin/esbuild', [...bundled, ...flags, '--log-level=warning']);
    const built = join(app.folder, 'esbuild-built');
    await copyFile(join(app.folder, 'esbuild/index.html'), join(built, 'index.html'));
    await copyFile(join(app.folder, 'src/page.css'), join(built, 'page.css'));
    host = await serveFiles(built, {
      files: { 'scene.ply': join(app.folder, 'public/scene.ply') },
      headers: { 'content-security-policy': CONTENT_SECURITY_POLICY },
    });
  });

  afterAll(() => host?.close());

  it('show splats that the worker has read which the app hosts', async () => {
    await expectSplats(browser, `${host.url}index.html`);
  });

  /**
   * @fault Pages and packages: a bundler leaves workers out
   * @consequence the main thread reads, and the console gives a remedy; a hosted worker reads
   */
  it('say once that the bundler left the workers out, and show the same', async () => {
    const warnings = [/ply-worker\.js did not start as a worker.*setWorkerUrl/];
    await expectSplats(browser, `${host.url}index.html?none`, {
      hasWorker: false,
      warnings,
      expected: [/404/],
    });
  });
});

/** Checks the app under one of Vite's servers. */
async function expectVite(command: 'dev' | 'preview', goOn?: ExpectSplatsOptions['goOn']): Promise<void> {
  const args = [command, '--host', '127.0.0.1', '--port', '0', '--logLevel', 'info'];
  const server = await app.serve('vite/bin/vite.js', args);
  try {
    await expectSplats(browser, server.url, { goOn });
  } finally {
    await server.close();
  }
}

function isAllWhite({ data }: Screenshot): boolean {
  return data.every((value) => value === 255);
}
