import { CONTENT_SECURITY_POLICY } from './server.ts';

/** A new app, set up as the documentation of a bundler or framework says. */
export interface AppKind {
  readonly name: string;
  /** Exact versions by package. */
  readonly packages: Readonly<Record<string, string>>;
  readonly manifest?: Readonly<Record<string, unknown>>;
  readonly sources: Readonly<Record<string, string>>;
  readonly ways: readonly AppWay[];
}

/** One of the ways in which an app is built and shown. */
export interface AppWay {
  readonly name: string;
  /** Paths of the pages that show the splats, without `.html`; default the first page alone, ''. */
  readonly pages?: readonly string[];
  /** Entries of `pages` whose server-rendered HTML contains the poster. */
  readonly posterPages?: readonly string[];
  /** Commands in order: paths of tools below node_modules, with their arguments. */
  readonly build: readonly (readonly [script: string, ...args: string[]])[];
  /** Folder that any host of static files can serve, or a tool that serves the app. */
  readonly shown:
    | { readonly folder: string }
    | { readonly server: readonly [script: string, ...args: string[]] };
  /** Headers of static files. */
  readonly headers?: Readonly<Record<string, string>>;
}

const STRICT = { 'content-security-policy': CONTENT_SECURITY_POLICY };

const PAGE_CSS = 'body { margin: 0; }\n#root { height: 100vh; }\n';

/** The page of an app, in which one script draws. */
export const html = (script: string) => `<!doctype html>
<html lang="en">
  <head>
    <title>Fresh</title>
    <link rel="stylesheet" href="./page.css" />
  </head>
  <body>
    <div id="root"></div>
    <script type="module" src="${script}"></script>
  </body>
</html>
`;

/** The script of an app after the statements `ahead`; without JSX, which bundlers translate. */
export const main = (ahead = '') => `import { Canvas } from '@react-three/fiber';
import { createSplatRenderer, setWorkerUrl, Splats } from '@websplatter/react';
import { createElement } from 'react';
import { createRoot } from 'react-dom/client';

${ahead}
createRoot(document.getElementById('root')).render(
  createElement(
    Canvas,
    { gl: createSplatRenderer, flat: true },
    createElement(Splats, { src: 'scene.ply' }),
  ),
);
`;

/** The page into whose folder a bundler writes its script. */
const pageIn = (folder: string) => ({
  [`${folder}/index.html`]: html('./main.js'),
  [`${folder}/page.css`]: PAGE_CSS,
});

const OWN_RENDERER = `import { Canvas } from '@react-three/fiber';
import { Splats } from '@websplatter/react';
import { createElement } from 'react';
import { createRoot } from 'react-dom/client';
import { WebGPURenderer } from 'three/webgpu';

const gl = async (props) => {
  const renderer = new WebGPURenderer(props);
  await renderer.init();
  return renderer;
};
createRoot(document.getElementById('root')).render(
  createElement(Canvas, { gl, flat: true }, createElement(Splats, { src: 'scene.ply' })),
);
`;

const OWN_RENDERER_OF_THREE = `import { SplatCloudObject, SplatLoader } from '@websplatter/three';
import { Color, PerspectiveCamera, Scene, WebGPURenderer } from 'three/webgpu';

const renderer = new WebGPURenderer({ antialias: true });
renderer.setSize(240, 160);
document.getElementById('root').append(renderer.domElement);
const scene = new Scene();
scene.background = new Color('white');
const camera = new PerspectiveCamera(75, 240 / 160, 0.1, 1000);
camera.position.set(0, 0, 5);
scene.add(new SplatCloudObject(await new SplatLoader().loadAsync('scene.ply')));
renderer.setAnimationLoop(() => renderer.render(scene, camera));
`;

const VITE_CONFIG = `export default {
  build: { rollupOptions: { input: ['index.html', 'own.html', 'three.html'] } },
  optimizeDeps: { exclude: ['@websplatter/core'] },
};
`;

/** Unminified: that would take most of the time, and bundlers do it in the same way. */
const webpackConfig = (folder: string) => `export default {
  mode: 'production',
  entry: './src/main.js',
  optimization: { minimize: false },
  performance: { hints: false },
  output: { path: import.meta.dirname + '/${folder}' },
};
`;

const ROLLUP_CONFIG = `import commonjs from '@rollup/plugin-commonjs';
import { nodeResolve } from '@rollup/plugin-node-resolve';
import replace from '@rollup/plugin-replace';

export default {
  input: { main: 'src/hosted.js', 'load-worker': '@websplatter/core/load-worker' },
  output: { dir: 'by-rollup' },
  plugins: [
    replace({ 'process.env.NODE_ENV': '"production"', preventAssignment: true }),
    nodeResolve({ browser: true }),
    commonjs(),
  ],
  onwarn: () => {},
};
`;

const COPY_WORKER = `import { copyFileSync } from 'node:fs';

copyFileSync('node_modules/@websplatter/core/dist/load-worker.js', 'by-parcel/load-worker.js');
`;

/** Pages of Next in `folder`: one shows splats, one uses them and so suspends on the server. */
const nextPages = (folder: string, settings = '') => ({
  [`app/${folder}page.jsx`]: `import { View } from '@/view.jsx';

${settings}
export default function Page() {
  return <View />;
}
`,
  [`app/${folder}used/page.jsx`]: `import { Suspense } from 'react';
import { UsedView } from '@/view.jsx';

${settings}
export default function Page() {
  return (
    <Suspense fallback={<p>Loading</p>}>
      <UsedView />
    </Suspense>
  );
}
`,
});

const nextSources = (pages: Readonly<Record<string, string>>, config = '') => ({
  ...pages,
  'jsconfig.json': '{ "compilerOptions": { "paths": { "@/*": ["./*"] } } }\n',
  'app/layout.jsx': `import './page.css';

export default function Layout({ children }) {
  return (
    <html lang="en">
      <body>{children}</body>
    </html>
  );
}
`,
  'public/favicon.ico': '',
  'app/page.css': 'body { margin: 0; height: 100vh; }\n',
  'view.jsx': `'use client';

import { SplatCanvas, Splats, useSplats } from '@websplatter/react';

export function View({ src = '/scene.ply' }) {
  return (
    <SplatCanvas poster="/poster.gif" flat>
      <Splats src={src} />
    </SplatCanvas>
  );
}

export function UsedView() {
  return <View src={useSplats('/scene.ply')} />;
}
`,
  'next.config.mjs': `export default { ${config} };\n`,
});

/** As `webpackConfig`. Turbopack minifies, by the same minifier. */
const UNMINIFIED =
  'webpack(config) { return { ...config, optimization: { ...config.optimization, minimize: false } }; }';
const STATIC_PAGES = nextPages('');
const DYNAMIC = "export const dynamic = 'force-dynamic';\n";
const ALL_PAGES = { ...STATIC_PAGES, ...nextPages('dynamic/', DYNAMIC) };
const NEXT = 'next/dist/bin/next';
const NEXT_SERVER = [NEXT, 'start', '--hostname', '127.0.0.1', '--port', '0'] as const;

/** The same files in a folder. */
const below = (folder: string, sources: Readonly<Record<string, string>>) =>
  Object.fromEntries(Object.entries(sources).map(([path, text]) => [`${folder}/${path}`, text]));

/** Static pages, and the same pages rendered for each request. */
const NEXT_PAGES = {
  pages: ['', 'used', 'dynamic', 'dynamic/used'],
  posterPages: ['', 'dynamic'],
  shown: { server: NEXT_SERVER },
};

export const APP_KINDS: readonly AppKind[] = [
  {
    name: 'Vite 7',
    packages: { vite: '7.3.8' },
    sources: {
      'index.html': html('/src/main.js'),
      'own.html': html('/src/own.js'),
      'three.html': html('/src/three.js'),
      'public/favicon.ico': '',
      'public/page.css': PAGE_CSS,
      'src/main.js': main(),
      'src/own.js': OWN_RENDERER,
      'src/three.js': OWN_RENDERER_OF_THREE,
      'vite.config.js': VITE_CONFIG,
    },
    ways: [
      {
        name: 'built, with its renderer and with renderers of the app',
        pages: ['', 'own', 'three'],
        build: [['vite/bin/vite.js', 'build']],
        shown: { folder: 'dist' },
        headers: STRICT,
      },
      {
        name: 'under the development server, which must leave core as it is',
        build: [],
        shown: { server: ['vite/bin/vite.js', '--host', '127.0.0.1', '--port', '0'] },
      },
    ],
  },
  {
    name: 'four bundlers',
    packages: {
      webpack: '5.112.2',
      'webpack-cli': '7.3.1',
      '@rspack/core': '2.3.2',
      '@rspack/cli': '2.2.8',
      rollup: '4.68.7',
      '@rollup/plugin-commonjs': '29.0.3',
      '@rollup/plugin-node-resolve': '16.0.3',
      '@rollup/plugin-replace': '6.0.3',
      parcel: '2.16.4',
    },
    manifest: { '@parcel/resolver-default': { packageExports: true } },
    sources: {
      'src/main.js': main(),
      'src/hosted.js': main("setWorkerUrl('load-worker.js');"),
      ...pageIn('by-webpack'),
      'webpack.config.mjs': webpackConfig('by-webpack'),
      ...pageIn('by-rspack'),
      'rspack.config.mjs': webpackConfig('by-rspack'),
      ...pageIn('by-rollup'),
      'rollup.config.mjs': ROLLUP_CONFIG,
      'copy-worker.mjs': COPY_WORKER,
      'src/page.css': PAGE_CSS,
      'src/index.html': html('./hosted.js'),
    },
    ways: [
      {
        name: 'webpack 5',
        build: [['webpack-cli/bin/cli.js', 'build']],
        shown: { folder: 'by-webpack' },
        headers: STRICT,
      },
      {
        name: 'Rspack',
        build: [['@rspack/cli/bin/rspack.js', 'build']],
        shown: { folder: 'by-rspack' },
        headers: STRICT,
      },
      {
        name: 'Rollup, which leaves workers out',
        build: [['rollup/dist/bin/rollup', '--config', 'rollup.config.mjs', '--silent']],
        shown: { folder: 'by-rollup' },
        headers: STRICT,
      },
      {
        name: 'Parcel, which must be told of exports and whose workers do not start',
        build: [
          ['parcel/lib/bin.js', 'build', 'src/index.html', '--dist-dir', 'by-parcel', '--no-cache'],
          ['../copy-worker.mjs'],
        ],
        // Parcel writes an import map into the page, which the strict policy forbids.
        shown: { folder: 'by-parcel' },
      },
    ],
  },
  {
    name: 'Next 15',
    packages: { next: '15.5.29' },
    manifest: { type: undefined },
    sources: nextSources(ALL_PAGES, UNMINIFIED),
    ways: [{ name: 'static and dynamic pages', build: [[NEXT, 'build']], ...NEXT_PAGES }],
  },
  {
    name: 'Next 16',
    packages: { next: '16.4.6' },
    manifest: { type: undefined },
    sources: {
      ...nextSources(ALL_PAGES),
      ...below('exported', nextSources(STATIC_PAGES, `output: 'export', ${UNMINIFIED}`)),
    },
    ways: [
      { name: 'Turbopack, static and dynamic pages', build: [[NEXT, 'build']], ...NEXT_PAGES },
      {
        name: 'webpack, exported static pages',
        pages: ['', 'used'],
        posterPages: [''],
        build: [[NEXT, 'build', 'exported', '--webpack']],
        shown: { folder: 'exported/out' },
      },
    ],
  },
];
