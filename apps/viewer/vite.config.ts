import { fileURLToPath } from 'node:url';
import react from '@vitejs/plugin-react';
import {
  build,
  createServer,
  defaultClientConditions,
  defineConfig,
  normalizePath,
  type Plugin,
  type Rolldown,
} from 'vite';
import { slimShaders } from '../../packages/tools/slim-shaders.mjs';
import { LICENSES_ADDRESS } from './src/state/licenses-address.ts';

const repositoryRoot = fileURLToPath(new URL('../..', import.meta.url));

/** Folder of worker scripts, separate so that tests can count the bytes of the page's own scripts. */
const WORKERS = 'assets/workers';

/** The page's first script, and the viewer, which it fetches unless the page has moved. */
const FIRST = 'src/main.ts';
const VIEWER_ITSELF = 'src/viewer-page.tsx';
/** The viewer's script. */
const VIEWER = 'viewer';
const CORE = '../../packages/core';
/** The engine's script, needed as soon as there is a GPU: its name, and its first module. */
const ENGINE = 'engine';
const ENGINE_ITSELF = `${CORE}/src/engine.ts`;
/**
 * Modules that are fetched on demand, by script: one script compresses better than a dozen. No two
 * scripts may import each other: the one that begins first would lack values of the other.
 */
const LATER: Readonly<Record<string, RegExp>> = {
  /** Modules that write the page's URL: needed from the start, without panels. */
  address:
    /\/viewer\/src\/(camera|state\/(accuracy-address|float32|orbit-pose|hermite|up-axis|vec3|link-fields|link-parts|scene-link-fields)|engine\/(link\/(linked-start|place-link|page-address)|open\/placement))\b/,
  /** Streamed scenes, frames and readers without a worker open files. */
  sources: /\/core\/src\/io\/sources\//,
  /** Several panels need parts of these. */
  panels:
    /\/kit\/src\/(?!split-accuracy|vertical-fov)|\/viewer\/src\/(ui|state(?!\/effect-values)|engine\/(edit-picture|show\/(draw-at-rest|frame-of-view|whole-frames))|inspect\/draw-crop|scene\/selected-part|accuracy\/(measure-button|compared-pictures))\b/,
};
/** Modules of core that the viewer runs before it requests a GPU. */
const START = ['src/create-engine.ts', 'src/gpu/effects/index.ts', 'src/io/loading/load-splats.ts'];
/** Modules that the viewer imports through core's index, but that only the engine or other pages run. */
const PACKING = [`${CORE}/src/data/packing/packed-cloud.ts`, `${CORE}/src/io/formats/ply/write-ply.ts`];

export default defineConfig({
  root: fileURLToPath(new URL('.', import.meta.url)),
  // Works below any path of a web server.
  base: './',
  // The development server shows shaders as they were written.
  plugins: [
    react(),
    { ...slimShaders(), apply: 'build' } satisfies Plugin,
    preloadScripts(),
    scenePage(),
    serveLab(),
  ],
  // The engine and the scenes run from their sources, so that editing them reloads the page.
  resolve: { conditions: ['@websplatter/source', ...defaultClientConditions] },
  worker: {
    format: 'es',
    rolldownOptions: {
      output: {
        entryFileNames: `${WORKERS}/[name]-[hash].js`,
        chunkFileNames: `${WORKERS}/[name]-[hash].js`,
      },
    },
  },
  build: {
    license: { fileName: LICENSES_ADDRESS },
    modulePreload: {
      // Every browser with WebGPU does this itself.
      polyfill: false,
      resolveDependencies: (_, files, { hostId, hostType }) =>
        hostType === 'html' ? files : files.filter((file) => isPreloaded(file, hostId)),
    },
    rolldownOptions: {
      output: {
        // Without groups, parts that are fetched later would split the viewer's first modules into
        // dozens of scripts, which compress worse.
        codeSplitting: { groups: [{ name: firstScript, includeDependenciesRecursively: false }] },
      },
    },
  },
  server: { fs: { allow: [repositoryRoot] } },
  // Found up front: a dependency that turns up late makes the development server reload the page.
  optimizeDeps: {
    include: [
      'react',
      'react-dom/client',
      'react/jsx-dev-runtime',
      'zustand',
      'zustand/middleware',
      'zustand/vanilla/shallow',
      'zustand/vanilla',
    ],
  },
});

/** Scripts and styles that are there before any other is fetched. */
const ALWAYS_THERE = new RegExp(`/(index|rolldown-runtime|${VIEWER}|${ENGINE})-[^/]*$`);
/** Fetches panels when idle: they need no preload lists, which delay the first picture. */
const FETCHES_LATE = new RegExp(`/${VIEWER}-[^/]*$`);

/** Whether the script `host`, when it fetches another, has the browser preload `file`. */
function isPreloaded(file: string, host: string): boolean {
  return !ALWAYS_THERE.test(file) && !(FETCHES_LATE.test(host) && file.endsWith('.js'));
}

/**
 * Returns the script of a module. First modules of the viewer: VIEWER. Modules of the engine: ENGINE.
 * Modules on demand: a script of LATER. Null: the bundler decides.
 */
function firstScript(id: string, graph: Rolldown.ChunkingContext): string | null {
  const begins = (page: string) =>
    needsAtFirst(normalizePath(fileURLToPath(new URL(page, import.meta.url))), graph);
  if (begins(FIRST).has(id)) return null;
  const isEarly = begins(VIEWER_ITSELF).has(id) && !isOnlyPacking(id, begins);
  if (!isEarly && begins(ENGINE_ITSELF).has(id)) return ENGINE;
  if (isEarly) return VIEWER;
  return Object.keys(LATER).find((name) => LATER[name].test(normalizePath(id))) ?? null;
}

function isOnlyPacking(id: string, begins: (file: string) => ReadonlySet<string>): boolean {
  const isPacking = PACKING.some((file) => begins(file).has(id));
  return isPacking && !START.some((file) => begins(`${CORE}/${file}`).has(id));
}

/** Static dependencies by module, for one build. */
const needed = new Map<string, ReadonlySet<string>>();

/** Returns a module and all of its static imports, also indirect ones. */
function needsAtFirst(id: string, graph: Rolldown.ChunkingContext): ReadonlySet<string> {
  const known = needed.get(id);
  if (known) return known;
  if (!graph.getModuleInfo(id))
    throw new Error(`${id}, which decides on scripts, is no module of this build.`);
  const all = new Set([id]);
  // Iterating a Set also visits members that are added during the loop.
  for (const each of all)
    for (const imported of graph.getModuleInfo(each)?.importedIds ?? []) all.add(imported);
  needed.set(id, all);
  return all;
}

/** Serves the lab below the viewer's URL in development, as in the build. */
function serveLab(): Plugin {
  return {
    name: 'viewer:serve-lab',
    apply: 'serve',
    async configureServer({ middlewares, httpServer }) {
      const base = '/lab/';
      const configFile = fileURLToPath(new URL('../lab/vite.config.ts', import.meta.url));
      const lab = await createServer({
        configFile,
        base,
        cacheDir: `${repositoryRoot}/node_modules/.vite-lab`,
        // Without `ws`, its web socket would listen on all of the machine's addresses.
        server: { middlewareMode: true, hmr: false, ws: false },
      });
      httpServer?.once('close', () => lab.close());
      middlewares.use((request, response, next) =>
        request.url?.startsWith(base) ? lab.middlewares(request, response, next) : next(),
      );
    },
  };
}

/** Virtual module with the URL of the page that saved scenes are written into. */
const SCENE_PAGE = 'virtual:scene-page';

/** Builds the page of `vite.page.config.ts`, and provides its URL as the module SCENE_PAGE. */
function scenePage(): Plugin {
  let isBuild = false;
  return {
    name: 'viewer:scene-page',
    configResolved: ({ command }) => {
      isBuild = command === 'build';
    },
    resolveId: (id) => (id === SCENE_PAGE ? `\0${SCENE_PAGE}` : null),
    async load(id) {
      if (id !== `\0${SCENE_PAGE}`) return null;
      const configFile = fileURLToPath(new URL('vite.page.config.ts', import.meta.url));
      const built = await build({ configFile, logLevel: 'error', build: { write: false } });
      const { output } = built as Rolldown.RolldownOutput;
      const page = output.find(({ fileName }) => fileName === 'scene-page.html');
      if (page?.type !== 'asset') this.error('vite.page.config.ts has built no page.');
      const html = String(page.source);
      if (!isBuild) return `export default 'data:text/html;base64,${Buffer.from(html).toString('base64')}'`;
      const asset = this.emitFile({ type: 'asset', name: 'scene-page.html', source: html });
      return `export default import.meta.ROLLUP_FILE_URL_${asset}`;
    },
  };
}

/** Has the browser fetch the viewer and the engine at once, while the first script begins. */
function preloadScripts(): Plugin {
  return {
    name: 'viewer:preload-scripts',
    apply: 'build',
    buildStart: () => needed.clear(),
    transformIndexHtml: {
      order: 'post',
      handler: (_, { bundle = {} }) =>
        // In the order in which they are needed.
        [VIEWER, ENGINE]
          .flatMap((name) =>
            Object.values(bundle).filter((file) => file.type === 'chunk' && file.name === name),
          )
          .map(({ fileName }) => ({
            tag: 'link',
            attrs: { rel: 'modulepreload', crossorigin: true, href: `./${fileName}` },
            injectTo: 'head',
          })),
    },
  };
}
