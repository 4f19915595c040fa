import { copyFileSync, mkdirSync, writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { join } from 'node:path';
import { build, type InlineConfig, type Plugin } from 'vite';
import { sceneFiles } from '../../../examples/scenes/scene-files.ts';
import { type KitManifest, MEASURE_ENTRY, MOUNT_ENTRY } from '../playground/kit-manifest.ts';
import { DocsError } from './markdown.ts';

/** Packages that readers may import in addition to the examples' imports. */
const ALWAYS = [
  'react',
  'react/jsx-runtime',
  'react-dom',
  'react-dom/client',
  'three',
  'three/webgpu',
  'three/tsl',
  'three/addons/controls/OrbitControls.js',
  '@react-three/fiber',
  '@react-three/drei',
  '@websplatter/core',
  '@websplatter/core/effects',
  '@websplatter/core/measure',
  '@websplatter/core/write',
  '@websplatter/react',
  '@websplatter/react/components',
  '@websplatter/react/hooks',
  '@websplatter/three',
];

/** CommonJS modules, whose export names are only found by running them. */
const COMMONJS = new Set(['react', 'react/jsx-runtime', 'react-dom', 'react-dom/client']);

/**
 * Components of drei that need no WebGL, in addition to the examples' imports. The whole of drei is
 * several times larger than everything else here.
 */
const DREI = [
  'Billboard',
  'Bounds',
  'Center',
  'Float',
  'Html',
  'KeyboardControls',
  'Loader',
  'MapControls',
  'OrbitControls',
  'OrthographicCamera',
  'PerspectiveCamera',
  'TrackballControls',
  'TransformControls',
  'useBounds',
  'useCursor',
  'useKeyboardControls',
  'useProgress',
];

const ENTRY = 'websplatter-kit:';

/**
 * Builds packages and dependencies for the examples into one folder; `kit.json` lists the files.
 *
 * @param docs folder of apps/docs.
 * @param packages entry points that the examples import.
 * @param dreiNames names that the examples import from drei.
 * @throws DocsError if something cannot be bundled.
 */
export async function buildKit(
  docs: string,
  outDir: string,
  packages: readonly string[],
  dreiNames: readonly string[],
): Promise<void> {
  mkdirSync(outDir, { recursive: true });
  const specifiers = [...new Set([...ALWAYS, ...packages])];
  const modules = new Map(specifiers.map((name) => [name, entryModule(docs, name, dreiNames)]));
  for (const [name, path] of [
    [MOUNT_ENTRY, 'src/playground/mount.tsx'],
    [MEASURE_ENTRY, 'src/live/measure.ts'],
  ])
    modules.set(name, `export * from ${JSON.stringify(join(docs, path))};`);
  const manifest: { -readonly [Key in keyof KitManifest]: KitManifest[Key] } = {
    entries: {},
    imports: {},
    scenes: [],
  };
  const input = Object.fromEntries([...modules.keys()].map((name) => [fileName(name), ENTRY + name]));
  await build({
    ...common(docs, outDir),
    plugins: [entryModules(modules), collectManifest(modules, manifest), sceneFiles()],
    build: {
      ...common(docs, outDir).build,
      rolldownOptions: {
        input,
        preserveEntrySignatures: 'strict',
        output: { chunkFileNames: '[name]-[hash].js' },
      },
    },
  });
  for (const [name, entry] of [
    ['runner', join(docs, 'src/playground/runner.ts')],
    ['load-worker', '@websplatter/core/load-worker'],
  ])
    await buildScript(docs, outDir, name, entry);
  if (manifest.scenes.length === 0) throw new DocsError('The kit has no scenes.');
  copyFileSync(join(docs, '../examples/src/examples.css'), join(outDir, 'examples.css'));
  writeFileSync(join(outDir, 'kit.json'), JSON.stringify(manifest));
}

function common(docs: string, outDir: string): InlineConfig & { build: object } {
  return {
    configFile: false,
    // Examples import packages that are installed there, including drei.
    root: join(docs, '../examples'),
    logLevel: 'error',
    publicDir: false,
    define: { 'process.env.NODE_ENV': '"production"' },
    // A server build leaves workers and dynamic imports unchanged; it still targets browsers and
    // bundles everything.
    ssr: { target: 'webworker', noExternal: true },
    resolve: { conditions: ['module', 'browser', 'production'] },
    build: { ssr: true, target: 'es2022', minify: true, outDir, emptyOutDir: false, copyPublicDir: false },
  };
}

/** Builds one classic script without imports. */
async function buildScript(docs: string, outDir: string, name: string, entry: string): Promise<void> {
  await build({
    ...common(docs, outDir),
    build: {
      ...common(docs, outDir).build,
      rolldownOptions: {
        input: { [name]: entry },
        output: { format: 'iife', entryFileNames: '[name].js', codeSplitting: false },
      },
    },
  });
}

const fileName = (specifier: string): string =>
  specifier.replace(/^@/, '').replace(/\.js$/, '').replaceAll('/', '-');

function entryModule(docs: string, name: string, dreiNames: readonly string[]): string {
  const from = JSON.stringify(name);
  if (name === '@react-three/drei') {
    const names = [...new Set([...DREI, ...dreiNames])].sort();
    return `export { ${names.join(', ')} } from ${from};`;
  }
  if (!COMMONJS.has(name)) return `export * from ${from};`;
  const names = Object.keys(createRequire(join(docs, 'package.json'))(name)).filter((each) =>
    /^[\p{L}_$][\w$]*$/u.test(each),
  );
  return `import all from ${from};\nexport default all;\nexport const { ${names.join(', ')} } = all;`;
}

function entryModules(modules: ReadonlyMap<string, string>): Plugin {
  return {
    name: 'websplatter:kit-entries',
    enforce: 'pre',
    resolveId: (id) => (id.startsWith(ENTRY) ? `\0${id}` : null),
    load: (id) => (id.startsWith(`\0${ENTRY}`) ? modules.get(id.slice(ENTRY.length + 1)) : null),
  };
}

/** Fills in the manifest. */
function collectManifest(
  modules: ReadonlyMap<string, string>,
  manifest: { -readonly [Key in keyof KitManifest]: KitManifest[Key] },
): Plugin {
  return {
    name: 'websplatter:kit-manifest',
    // After the plugin that emits the scenes.
    enforce: 'post',
    generateBundle(_, bundle) {
      const entries: Record<string, string> = {};
      const imports: Record<string, readonly string[]> = {};
      for (const [file, output] of Object.entries(bundle)) {
        if (output.type === 'asset') {
          manifest.scenes = [...manifest.scenes, file];
          continue;
        }
        const name = output.facadeModuleId?.slice(ENTRY.length + 1);
        if (output.isEntry && name && modules.has(name)) entries[name] = file;
        imports[file] = [...new Set([...output.imports, ...output.dynamicImports])].filter(
          (each) => bundle[each],
        );
      }
      manifest.entries = entries;
      manifest.imports = imports;
    },
  };
}
