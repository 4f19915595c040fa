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
const files = {
  'scene.ply': encodePly(testScene()),
  /** One pixel, which covers any canvas. */
  'poster.gif': Buffer.from('R0lGODlhAQABAIAAAAD/AAAAACwAAAAAAQABAAACAkQBADs=', 'base64'),
};

let browser: Browser;

beforeAll(async () => {
  browser = await launchBrowser();
});

afterAll(() => browser?.close());

/** Installs an app for the tests around the call. */
function freshApp(parts: FreshAppParts): () => FreshApp {
  let app: FreshApp;
  beforeAll(async () => {
    app = await makeFreshApp(parts);
  }, TIMEOUT_MS);
  afterAll(() => app?.remove());
  return () => app;
}

describe.each(APP_KINDS)(
  'the packed tarballs in a fresh app by $name show splats that a worker has read',
  {
    timeout: TIMEOUT_MS,
  },
  ({ ways, ...parts }) => {
    const app = freshApp({ ...parts, files });

    it.each(ways)('$name', async ({ build, shown, pages = [''], posterPages = [], headers = {} }) => {
      const { folder, run, serve } = app();
      for (const [script, ...args] of build) await run(script, args);
      // Not every bundler copies them.
      const served = Object.fromEntries(
        Object.keys(files).map((name) => [name, join(folder, 'public', name)]),
      );
      const host =
        'folder' in shown
          ? await serveFiles(join(folder, shown.folder), { files: served, headers })
          : await serve(shown.server[0], shown.server.slice(1));
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
  },
);

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
    <canvas width="240" height="160"></canvas>
    <script type="module">
      import { createSplatRenderer, SplatCloudObject, SplatLoader } from '@websplatter/three';
      import { Color, PerspectiveCamera, Scene } from 'three/webgpu';

      const canvas = document.querySelector('canvas');
      const renderer = await createSplatRenderer({ canvas, antialias: true });
      const scene = new Scene();
      scene.background = new Color('white');
      const camera = new PerspectiveCamera(75, 240 / 160, 0.1, 1000);
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

const RESOLUTIONS = [
  ['ESNext', 'bundler'],
  ['Node16', 'node16'],
  ['ESNext', 'node'],
] as const;
const configOf = (resolution: string) => `tsconfig.${resolution}.json`;

describe('the packed tarballs in a fresh app', { timeout: TIMEOUT_MS }, () => {
  const app = freshApp({
    // The last TypeScript that knows all three resolutions.
    packages: { typescript: '5.9.3', jest: '30.5.2', '@babel/preset-env': '7.29.14' },
    lockedPackages: ['@types/react', '@types/three', '@webgpu/types', 'vitest'],
    sources: {
      'typed.tsx': TYPED,
      'typed-by-three.tsx': TYPED_BY_THREE,
      ...Object.fromEntries(
        RESOLUTIONS.map(([module, resolution]) => [configOf(resolution), tsconfig(module, resolution)]),
      ),
      'babel.config.cjs':
        "module.exports = { presets: [['@babel/preset-env', { targets: { node: 'current' } }]] };\n",
      'jest.config.cjs':
        "module.exports = { transformIgnorePatterns: ['/node_modules/(?!(@websplatter|three)/)'] };\n",
      'packages.test.js': UNIT_TEST,
    },
    files,
  });

  it('show splats by an import map, with packages and workers of another origin', async () => {
    const { folder } = app();
    const headers = { 'access-control-allow-origin': '*' };
    const network = await serveFiles(join(folder, 'node_modules'), { headers });
    await writeFile(join(folder, 'index.html'), importMapPage(network.url));
    const host = await serveFiles(folder);
    try {
      await expectSplats(browser, `${host.url}index.html`);
    } finally {
      await Promise.all([host.close(), network.close()]);
    }
  });

  it.each(RESOLUTIONS)('type-check as %s under the module resolution %s', (_, resolution) =>
    app().run('typescript/bin/tsc', ['-p', configOf(resolution)]),
  );

  it('are found by require', async () => {
    const script =
      "console.log(typeof require('@websplatter/react').Splats, typeof require('@websplatter/core/effects').tint)";
    const { stdout } = await promisify(execFile)(process.execPath, ['--eval', script], {
      cwd: app().folder,
      env: { PATH: process.env.PATH },
    });
    expect(stdout.trim()).toBe('function function');
  });

  it('run in unit tests by Jest', () => app().run('jest/bin/jest.js', ['--watchman=false']));

  it('run in unit tests by Vitest', () => app().run('vitest/vitest.mjs', ['run', '--globals']));
});
