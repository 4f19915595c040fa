import { CONTENT_SECURITY_POLICY } from './server.ts';

/** A new app for one bundler or framework, set up as its documentation says. */
export interface AppKind {
  readonly name: string;
  /** Exact versions by package. */
  readonly packages: Readonly<Record<string, string>>;
  readonly manifest?: Readonly<Record<string, unknown>>;
  readonly sources: Readonly<Record<string, string>>;
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

/** An app whose bundler writes one script into \`built\`, beside the page. */
const bundled = (ahead?: string) => ({
  'src/main.js': main(ahead),
  'built/index.html': html('./main.js'),
  'built/page.css': PAGE_CSS,
});

const VITE_SOURCES = {
  'index.html': html('/src/main.js'),
  'public/favicon.ico': '',
  'public/page.css': PAGE_CSS,
  'src/main.js': main(),
};

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
renderer.setSize(480, 320);
document.getElementById('root').append(renderer.domElement);
const scene = new Scene();
scene.background = new Color('white');
const camera = new PerspectiveCamera(75, 480 / 320, 0.1, 1000);
camera.position.set(0, 0, 5);
scene.add(new SplatCloudObject(await new SplatLoader().loadAsync('scene.ply')));
renderer.setAnimationLoop(() => renderer.render(scene, camera));
`;

/** Unminified: that would take most of the time, and bundlers do it in the same way. */
const WEBPACK_CONFIG = `export default {
  mode: 'production',
  entry: './src/main.js',
  optimization: { minimize: false },
  performance: { hints: false },
  output: { path: import.meta.dirname + '/built' },
};
`;

const ROLLUP_CONFIG = `import commonjs from '@rollup/plugin-commonjs';
import { nodeResolve } from '@rollup/plugin-node-resolve';
import replace from '@rollup/plugin-replace';

export default {
  input: { main: 'src/main.js', 'load-worker': '@websplatter/core/load-worker' },
  output: { dir: 'built' },
  plugins: [
    replace({ 'process.env.NODE_ENV': '"production"', preventAssignment: true }),
    nodeResolve({ browser: true }),
    commonjs(),
  ],
  onwarn: () => {},
};
`;

const COPY_WORKER = `import { copyFileSync } from 'node:fs';

copyFileSync('node_modules/@websplatter/core/dist/load-worker.js', 'built/load-worker.js');
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

const STATIC = "output: 'export'";
const STATIC_PAGES = nextPages('');
const DYNAMIC = "export const dynamic = 'force-dynamic';\n";
const NEXT = 'next/dist/bin/next';
const NEXT_SERVER = [NEXT, 'start', '--hostname', '127.0.0.1', '--port', '0'] as const;

export const APP_KINDS: readonly AppKind[] = [
  {
    name: 'Vite 7',
    packages: { vite: '7.3.8' },
    sources: VITE_SOURCES,
    build: [['vite/bin/vite.js', 'build']],
    shown: { folder: 'dist' },
    headers: STRICT,
  },
  {
    name: 'Vite 7, with renderers of its own',
    packages: { vite: '7.3.8' },
    sources: {
      ...VITE_SOURCES,
      'src/main.js': OWN_RENDERER,
      'three.html': html('/src/three.js'),
      'src/three.js': OWN_RENDERER_OF_THREE,
      'vite.config.js':
        "export default { build: { target: 'esnext', rollupOptions: { input: ['index.html', 'three.html'] } } };\n",
    },
    pages: ['', 'three'],
    build: [['vite/bin/vite.js', 'build']],
    shown: { folder: 'dist' },
    headers: STRICT,
  },
  {
    name: 'the development server of Vite 7, which must leave core as it is',
    packages: { vite: '7.3.8' },
    sources: {
      ...VITE_SOURCES,
      'vite.config.js': "export default { optimizeDeps: { exclude: ['@websplatter/core'] } };\n",
    },
    build: [],
    shown: { server: ['vite/bin/vite.js', '--host', '127.0.0.1', '--port', '0'] },
  },
  {
    name: 'webpack 5',
    packages: { webpack: '5.112.2', 'webpack-cli': '7.3.1' },
    sources: { ...bundled(), 'webpack.config.mjs': WEBPACK_CONFIG },
    build: [['webpack-cli/bin/cli.js', 'build']],
    shown: { folder: 'built' },
    headers: STRICT,
  },
  {
    name: 'Rspack',
    packages: { '@rspack/core': '2.3.2', '@rspack/cli': '2.2.8' },
    sources: { ...bundled(), 'rspack.config.mjs': WEBPACK_CONFIG },
    build: [['@rspack/cli/bin/rspack.js', 'build']],
    shown: { folder: 'built' },
    headers: STRICT,
  },
  {
    name: 'Rollup, which leaves workers out',
    packages: {
      rollup: '4.68.7',
      '@rollup/plugin-commonjs': '29.0.3',
      '@rollup/plugin-node-resolve': '16.0.3',
      '@rollup/plugin-replace': '6.0.3',
    },
    sources: { ...bundled("setWorkerUrl('load-worker.js');"), 'rollup.config.mjs': ROLLUP_CONFIG },
    build: [['rollup/dist/bin/rollup', '--config', 'rollup.config.mjs', '--silent']],
    shown: { folder: 'built' },
    headers: STRICT,
  },
  {
    name: 'Parcel, which must be told of exports and whose workers do not start',
    packages: { parcel: '2.16.4' },
    manifest: { '@parcel/resolver-default': { packageExports: true } },
    sources: {
      'copy-worker.mjs': COPY_WORKER,
      'src/main.js': main("setWorkerUrl('load-worker.js');"),
      'src/page.css': PAGE_CSS,
      'src/index.html': html('./main.js'),
    },
    build: [
      ['parcel/lib/bin.js', 'build', 'src/index.html', '--dist-dir', 'built', '--no-cache'],
      ['../copy-worker.mjs'],
    ],
    shown: { folder: 'built' },
    // Parcel writes an import map into the page, which the strict policy forbids.
    headers: {},
  },
  {
    name: 'Next 15, static and dynamic pages',
    packages: { next: '15.5.29' },
    manifest: { type: undefined },
    sources: nextSources({ ...STATIC_PAGES, ...nextPages('dynamic/', DYNAMIC) }),
    pages: ['', 'used', 'dynamic', 'dynamic/used'],
    posterPages: ['', 'dynamic'],
    build: [[NEXT, 'build']],
    shown: { server: NEXT_SERVER },
  },
  {
    name: 'Next 16 by Turbopack, static pages',
    packages: { next: '16.4.6' },
    manifest: { type: undefined },
    sources: nextSources(STATIC_PAGES, STATIC),
    pages: ['', 'used'],
    posterPages: [''],
    build: [[NEXT, 'build']],
    shown: { folder: 'out' },
  },
  {
    name: 'Next 16 by Turbopack, dynamic pages',
    packages: { next: '16.4.6' },
    manifest: { type: undefined },
    sources: nextSources(nextPages('', DYNAMIC)),
    pages: ['', 'used'],
    posterPages: [''],
    build: [[NEXT, 'build']],
    shown: { server: NEXT_SERVER },
  },
  {
    name: 'Next 16 by webpack, static pages',
    packages: { next: '16.4.6' },
    manifest: { type: undefined },
    sources: nextSources(STATIC_PAGES, STATIC),
    pages: ['', 'used'],
    posterPages: [''],
    build: [[NEXT, 'build', '--webpack']],
    shown: { folder: 'out' },
  },
];
