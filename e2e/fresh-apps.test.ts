// Proves: the tarballs in apps of each bundler and framework, Jest, Vitest, `require`.
import { execFile } from 'node:child_process';
import { writeFile } from 'node:fs/promises';
import { join } from 'node:path';
import { promisify } from 'node:util';
import { encodePly } from '@websplatter/core';
import { serveFiles } from '@websplatter/tools/file-server';
import type { Browser } from 'playwright-core';
import { afterAll, beforeAll, describe, expect, it } from 'vitest';
import { launchBrowser } from './browser.ts';
import { expectSplats } from './expect-splats.ts';
import { type FreshApp, type FreshAppParts, makeFreshApp } from './fresh-app.ts';
import { APP_KINDS } from './fresh-apps.ts';
import { testScene } from './test-scene.ts';

// These install and build for minutes: `npm run test:full` has them.
/** Ends tools that hang. `next build` alone has taken 200 s beside six other jobs on two cores. */
const TIMEOUT_MS = 1_200_000;
const scene = { 'scene.ply': encodePly(testScene()) };
/** A GIF of one pixel, which covers any canvas. */
const poster = Buffer.from('R0lGODlhAQABAIAAAAD/AAAAACwAAAAAAQABAAACAkQBADs=', 'base64');

/** Calls `use` with a fresh app, and removes it. */
async function inFreshApp(parts: FreshAppParts, use: (app: FreshApp) => Promise<void>): Promise<void> {
  const app = await makeFreshApp(parts);
  try {
    await use(app);
  } finally {
    await app.remove();
  }
}

describe('the packed tarballs in a fresh app show splats that a worker has read', {
  timeout: TIMEOUT_MS,
}, () => {
  let browser: Browser;

  beforeAll(async () => {
    browser = await launchBrowser();
  });

  afterAll(() => browser?.close());

  it.each(APP_KINDS)('$name', async (kind) => {
    const { build, shown, pages = [''], posterPages = [], headers = {}, ...parts } = kind;
    await inFreshApp({ ...parts, files: { ...scene, 'poster.gif': poster } }, async (app) => {
      for (const [script, ...args] of build) await app.run(script, args);
      // Not every bundler copies it.
      const served = { 'scene.ply': join(app.folder, 'public/scene.ply') };
      const host =
        'folder' in shown
          ? await serveFiles(join(app.folder, shown.folder), { files: served, headers })
          : await app.serve(shown.server[0], shown.server.slice(1));
      try {
        for (const page of pages) {
          const path = 'folder' in shown ? `${page || 'index'}.html` : page;
          const html = await (await fetch(host.url + path)).text();
          expect(html.includes('<img src="/poster.gif"'), 'a poster').toBe(posterPages.includes(page));
          await expectSplats(browser, host.url + path);
        }
      } finally {
        await host.close();
      }
    });
  });

  it('an import map, with packages and workers of another origin', async () => {
    await inFreshApp({ sources: {}, files: scene }, async (app) => {
      const headers = { 'access-control-allow-origin': '*' };
      const network = await serveFiles(join(app.folder, 'node_modules'), { headers });
      await writeFile(join(app.folder, 'index.html'), importMapPage(network.url));
      const host = await serveFiles(app.folder);
      try {
        await expectSplats(browser, `${host.url}index.html`);
      } finally {
        await Promise.all([host.close(), network.close()]);
      }
    });
  });
});

/** React has no ES modules, so the page uses three alone. */
const importMapPage = (packages: string) => `<!doctype html>
<html lang="en">
  <head>
    <title>Fresh</title>
    <script type="importmap">
      {
        "imports": {
          "three/webgpu": "${packages}three/build/three.webgpu.js",
          "three/tsl": "${packages}three/build/three.tsl.js",
          "@websplatter/three": "${packages}@websplatter/three/dist/index.js",
          "@websplatter/core": "${packages}@websplatter/core/dist/index.js",
          "@websplatter/core/effects": "${packages}@websplatter/core/dist/effects.js"
        }
      }
    </script>
  </head>
  <body style="margin: 0">
    <canvas width="480" height="320"></canvas>
    <script type="module">
      import { createSplatRenderer, SplatCloudObject, SplatLoader } from '@websplatter/three';
      import { Color, PerspectiveCamera, Scene } from 'three/webgpu';

      const canvas = document.querySelector('canvas');
      const renderer = await createSplatRenderer({ canvas, antialias: true });
      const scene = new Scene();
      scene.background = new Color('white');
      const camera = new PerspectiveCamera(75, 480 / 320, 0.1, 1000);
      camera.position.set(0, 0, 5);
      const loader = new SplatLoader().detectSupport(renderer);
      scene.add(new SplatCloudObject(await loader.loadAsync('public/scene.ply')));
      renderer.setAnimationLoop(() => renderer.render(scene, camera));
    </script>
  </body>
</html>
`;

const TYPED = `import { perspectiveCamera, setWorkerUrl } from '@websplatter/core';
import { tint } from '@websplatter/core/effects';
import { SPLAT_FORMATS } from '@websplatter/core/formats';
import { countCosts } from '@websplatter/core/inspect';
import '@websplatter/core/load-worker';
import { measureFrames } from '@websplatter/core/measure';
import { renderReference } from '@websplatter/core/reference';
import { writeSplats } from '@websplatter/core/write';
import { SplatCanvas, Splats } from '@websplatter/react';
import { isSupported } from '@websplatter/three';

export const all = [countCosts, measureFrames, perspectiveCamera, renderReference, SPLAT_FORMATS, tint, writeSplats];
setWorkerUrl('/load-worker.js');
// @ts-expect-error: no address. A missing type would be any.
setWorkerUrl(5);
// @ts-expect-error: a promise.
export const supported: boolean = isSupported();
export const view = <SplatCanvas flat><Splats src="garden.ply" opacity={0.5} /></SplatCanvas>;
// @ts-expect-error: no address.
export const wrong = <SplatCanvas workerUrl={5} />;
`;

/** Under `node`, the types of three/webgpu are not found, and three's classes have any type. */
const TYPED_BY_THREE = `import { Splats } from '@websplatter/react';
import { SplatLoader } from '@websplatter/three';

// @ts-expect-error: no source.
new SplatLoader().load(5, () => {});
// @ts-expect-error: no opacity.
export const wrong = <Splats src="garden.ply" opacity="half" />;
`;

/** As `create-next-app` and others write it: declarations of dependencies are their own affair. */
const tsconfig = (module: string, moduleResolution: string) =>
  JSON.stringify({
    compilerOptions: {
      target: 'ES2022',
      module,
      moduleResolution,
      jsx: 'react-jsx',
      lib: ['ES2022', 'DOM', 'DOM.Iterable'],
      types: ['@webgpu/types'],
      strict: true,
      skipLibCheck: true,
      esModuleInterop: true,
      noEmit: true,
    },
    files: moduleResolution === 'node' ? ['typed.tsx'] : ['typed.tsx', 'typed-by-three.tsx'],
  });

const UNIT_TEST = `import { createElement } from 'react';
import { perspectiveCamera } from '@websplatter/core';
import { SplatLoader, Splats } from '@websplatter/react';

test('uses the packages', async () => {
  expect(createElement(Splats, { src: 'garden.ply' }).props.src).toBe('garden.ply');
  expect(perspectiveCamera({ position: [0, 0, 5], target: [0, 0, 0], fovYDegrees: 75, aspect: 1 }).near).toBeGreaterThan(0);
  const header = 'ply\\nformat ascii 1.0\\nelement vertex 0\\nend_header\\n';
  await expect(new SplatLoader().loadAsync(new TextEncoder().encode(header))).rejects.toThrow();
});
`;

describe('the packed tarballs in a fresh app', { timeout: TIMEOUT_MS }, () => {
  it('type-check under every module resolution', async () => {
    const resolutions = [
      ['ESNext', 'bundler'],
      ['Node16', 'node16'],
      ['ESNext', 'node'],
    ];
    const configs = resolutions.map(([module, resolution]): [string, string] => [
      `tsconfig.${resolution}.json`,
      tsconfig(module, resolution),
    ]);
    await inFreshApp(
      {
        // The last that knows all three.
        packages: { typescript: '5.9.3' },
        lockedPackages: ['@types/react', '@types/three', '@webgpu/types'],
        sources: { 'typed.tsx': TYPED, 'typed-by-three.tsx': TYPED_BY_THREE, ...Object.fromEntries(configs) },
      },
      async (app) => {
        for (const [config] of configs) await app.run('typescript/bin/tsc', ['-p', config]);
      },
    );
  });

  it('are found by require', async () => {
    await inFreshApp({ sources: {} }, async ({ folder }) => {
      const script =
        "console.log(typeof require('@websplatter/react').Splats, typeof require('@websplatter/core/effects').tint)";
      const { stdout } = await promisify(execFile)(process.execPath, ['--eval', script], {
        cwd: folder,
        env: { PATH: process.env.PATH },
      });
      expect(stdout.trim()).toBe('function function');
    });
  });

  it('run in unit tests by Jest', async () => {
    await inFreshApp(
      {
        packages: { jest: '30.5.2', '@babel/preset-env': '7.29.14' },
        manifest: { type: 'commonjs' },
        sources: {
          'babel.config.js':
            "module.exports = { presets: [['@babel/preset-env', { targets: { node: 'current' } }]] };\n",
          'jest.config.js':
            "module.exports = { transformIgnorePatterns: ['/node_modules/(?!(@websplatter|three)/)'] };\n",
          'packages.test.js': UNIT_TEST,
        },
      },
      (app) => app.run('jest/bin/jest.js', ['--watchman=false']),
    );
  });

  it('run in unit tests by Vitest', async () => {
    await inFreshApp(
      {
        lockedPackages: ['vitest'],
        sources: { 'packages.test.js': UNIT_TEST },
      },
      (app) => app.run('vitest/vitest.mjs', ['run', '--globals']),
    );
  });
});
