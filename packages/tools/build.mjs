// `npm run build`: builds the packages that run outside of this repository, and the viewer, into
// their dist folders: JavaScript by Vite, declarations by tsc. Skips unchanged parts.
// `--packages` leaves out the viewer.
import { spawnSync } from 'node:child_process';
import { createHash, randomUUID } from 'node:crypto';
import {
  cpSync,
  existsSync,
  mkdirSync,
  readdirSync,
  readFileSync,
  rmSync,
  statSync,
  writeFileSync,
} from 'node:fs';
import { basename, isAbsolute, join, relative } from 'node:path';
import { pathToFileURL } from 'node:url';
import { fail, repositoryRoot } from './setup.mjs';
import { slimShaders } from './slim-shaders.mjs';

/**
 * Third-party code that is bundled into packages without dependencies: see docs/dependencies.md.
 */
const BUNDLED = ['meshoptimizer'];

/**
 * Packages in order of dependence. `entries` are public modules, and workers, which must be
 * separate files. `hosted` are scripts that others serve unchanged: each is one minified file
 * without imports. `inputs` are bundled in addition to the package's own sources.
 */
const PACKAGES = [
  {
    name: 'core',
    entries: {
      index: 'src/index.ts',
      effects: 'src/gpu/effects/index.ts',
      'effect-options': 'src/options/index.ts',
      reference: 'src/reference/index.ts',
      inspect: 'src/inspect.ts',
      measure: 'src/measure/index.ts',
      formats: 'src/io/formats/index.ts',
      write: 'src/write.ts',
      'own-data': 'src/own-data.ts',
      collider: 'src/clouds/collider/index.ts',
      keep: 'src/keep.ts',
      frames: 'src/frames.ts',
      make: 'src/make.ts',
      'ply-worker': 'src/io/formats/ply/ply-worker.ts',
      'scene-worker': 'src/io/formats/scene-worker.ts',
      'formats-worker': 'src/io/formats/formats-worker.ts',
      'collider-worker': 'src/clouds/collider/collider-worker.ts',
      'framing-worker': 'src/framing/framing-worker.ts',
      'ray-worker': 'src/clouds/rays/ray-worker.ts',
      'keep-worker': 'src/io/keep/keep-worker.ts',
    },
    hosted: { 'load-worker': 'src/load-worker.ts' },
    inputs: ['shaders'],
    hasDeclarations: true,
  },
  { name: 'charts', entries: { index: 'src/index.ts' }, inputs: [], hasDeclarations: true },
  { name: 'node', entries: { index: 'src/index.ts' }, inputs: [], hasDeclarations: true },
  { name: 'scenes', entries: { index: 'src/index.ts' }, inputs: [], hasDeclarations: true },
  { name: 'conformance', entries: { index: 'src/index.ts' }, inputs: [], hasDeclarations: true },
  {
    name: 'cli',
    entries: { main: 'src/main.ts', 'brick-worker': 'src/brick-worker.ts' },
    inputs: ['packages/tools/src/commit.ts'],
    hasDeclarations: false,
  },
  {
    name: 'three',
    entries: {
      index: 'src/index.ts',
      gltf: 'src/gltf.ts',
      'own-data': 'src/own-data.ts',
      sequence: 'src/sequence.ts',
      testing: 'src/testing.ts',
      tsl: 'src/tsl.ts',
      xr: 'src/xr.ts',
    },
    inputs: [],
    hasDeclarations: true,
  },
  {
    name: 'react',
    entries: {
      index: 'src/index.ts',
      components: 'src/components.ts',
      gltf: 'src/gltf.ts',
      hooks: 'src/hooks.ts',
      'own-data': 'src/own-data.ts',
      sequence: 'src/sequence.ts',
      testing: 'src/testing.ts',
      tsl: 'src/tsl.ts',
    },
    inputs: [],
    hasDeclarations: true,
  },
];

/** The viewer and the lab are bundled from the sources of these folders. */
const VIEWER_INPUTS = [
  'apps/viewer',
  'apps/kit',
  'apps/lab',
  ...PACKAGES.map(({ name }) => `packages/${name}/src`),
  'shaders',
];

const cacheFolder = join(repositoryRoot, 'node_modules/.cache/websplatter-build');

/** Inputs of every build. */
const TOOLS = [
  'packages/tools/build.mjs',
  'packages/tools/slim-shaders.mjs',
  'packages/tools/tsconfig.library.json',
  'tsconfig.json',
  'node_modules/vite/package.json',
  'node_modules/typescript/package.json',
];

/**
 * Builds the packages that have changed.
 *
 * @param last name of the last one to build: those after it are left as they are.
 */
export async function build(last = PACKAGES.at(-1).name) {
  let hash = hashOf(TOOLS);
  for (const item of PACKAGES) {
    const folder = `packages/${item.name}`;
    const sources = [
      `${folder}/src`,
      `${folder}/package.json`,
      `${folder}/tsconfig.build.json`,
      ...item.inputs,
    ];
    // Includes the hash so far, because declarations are checked against the previous packages.
    hash = hashOf(sources, hash);
    const built = Object.keys({ ...item.entries, ...item.hosted }).map(
      (entry) => `${folder}/dist/${entry}.js`,
    );
    const wanted = hash;
    const isDone = () => isBuilt(item.name, wanted, built);
    if (!isDone()) await timeBuild(item.name, wanted, () => buildPackage(item, isDone));
    if (item.name === last) return;
  }
}

/**
 * Builds the viewer if it has changed: with the lab for any path of a web server, and as one file.
 */
async function buildViewer() {
  const hash = hashOf([...TOOLS, ...VIEWER_INPUTS, 'package-lock.json']);
  if (
    isBuilt(
      'viewer',
      hash,
      ['index.html', 'embed.html', 'lab/index.html'].map((file) => `apps/viewer/dist/${file}`),
    )
  )
    return;
  const { build: buildApp } = await import('vite');
  await timeBuild('viewer', hash, async () => {
    for (const config of ['vite.config.ts', 'vite.embed.config.ts'])
      await buildApp({ configFile: join(repositoryRoot, 'apps/viewer', config), logLevel: 'error' });
    await buildApp({
      configFile: join(repositoryRoot, 'apps/lab/vite.config.ts'),
      logLevel: 'error',
      build: { outDir: join(repositoryRoot, 'apps/viewer/dist/lab'), emptyOutDir: true },
    });
  });
}

/** Whether the files `built` exist and were made from inputs with this `hash`. */
function isBuilt(name, hash, built) {
  if (!existsSync(stampPath(name)) || readFileSync(stampPath(name), 'utf8') !== hash) return false;
  return built.every((path) => existsSync(join(repositoryRoot, path)));
}

async function timeBuild(name, hash, run) {
  const startedMs = performance.now();
  await run();
  mkdirSync(cacheFolder, { recursive: true });
  writeFileSync(stampPath(name), hash);
  console.log(`Built @websplatter/${name} in ${((performance.now() - startedMs) / 1000).toFixed(1)} s`);
}

/** @param isDone whether another process, such as a test, has built the same meanwhile. */
async function buildPackage(item, isDone) {
  const folder = join(repositoryRoot, 'packages', item.name);
  // Built into another folder first, so that a failed build keeps the previous dist. The folder's
  // name is random: builds in two containers may have the same process id.
  const aside = join(cacheFolder, `${item.name}-${randomUUID()}`);
  try {
    await bundle(item.entries, folder, aside, { minify: false, emptyOutDir: true });
    for (const [name, path] of Object.entries(item.hosted ?? {}))
      await bundle({ [name]: path }, folder, aside, { minify: true, emptyOutDir: false });
    checkDirectives(item, folder, aside);
    if (item.hasDeclarations) emitDeclarations(folder, aside);
    if (isDone()) return;
    rmSync(join(folder, 'dist'), { recursive: true, force: true, maxRetries: 10 });
    cpSync(aside, join(folder, 'dist'), { recursive: true });
  } finally {
    rmSync(aside, { recursive: true, force: true });
  }
}

/** Writes `entries` of the package in `folder` to `outDir`; minified, each is one file. */
async function bundle(entries, folder, outDir, { minify, emptyOutDir }) {
  const vite = await import('vite');
  const input = Object.fromEntries(Object.entries(entries).map(([name, path]) => [name, join(folder, path)]));
  await vite.build({
    configFile: false,
    root: folder,
    logLevel: 'warn',
    ssr: { noExternal: BUNDLED },
    // Vite's build for Node keeps `new URL(…, import.meta.url)`. Its build for browsers would make
    // the worker's URL relative to the root of a web server.
    build: {
      ssr: true,
      target: 'es2022',
      outDir,
      emptyOutDir,
      minify,
      sourcemap: true,
      rolldownOptions: {
        input,
        // Directives inside a bundle have no effect; `checkDirectives` checks the entries'
        // directives.
        checks: { moduleLevelDirective: false },
        external: (id) =>
          !id.startsWith('.') &&
          !id.startsWith('\0') &&
          !isAbsolute(id) &&
          !BUNDLED.includes(id.split('/')[0]),
        output: {
          format: 'es',
          entryFileNames: '[name].js',
          chunkFileNames: '[name]-[hash].js',
          codeSplitting: !minify,
        },
      },
    },
    plugins: [workerFiles(entries), slimShaders()],
  });
}

/**
 * Points `new URL('./some-worker.ts', import.meta.url)` to the built file. All built files are in
 * one folder, so that other bundlers still recognise the worker.
 */
function workerFiles(entries) {
  return {
    name: 'websplatter:worker-files',
    enforce: 'pre',
    transform(code, id) {
      if (!/\.tsx?$/.test(id) || !code.includes('import.meta.url')) return null;
      const replaced = code.replace(
        /new URL\((['"])(\.[^'"]*\.ts)\1, import\.meta\.url\)/g,
        (_, quote, path) => {
          const name = basename(path, '.ts');
          if (!Object.hasOwn(entries, name))
            this.error(`${id}: ${path} is not among the entries of packages/tools/build.mjs`);
          return `new URL(${quote}./${name}.js${quote}, import.meta.url)`;
        },
      );
      // No line moves, so the previous source map stays valid.
      return { code: replaced, map: null };
    },
  };
}

/** Throws if an entry begins with a directive, e.g. "use client", and its built file lacks it. */
function checkDirectives(item, folder, outDir) {
  // A comment may precede it.
  const directiveOf = (path) =>
    /^(?:\/\*[\s\S]*?\*\/\s*)?(['"])(use \w+)\1/.exec(readFileSync(path, 'utf8'))?.[2];
  for (const [name, path] of Object.entries(item.entries)) {
    const directive = directiveOf(join(folder, path));
    if (directive !== directiveOf(join(outDir, `${name}.js`)))
      throw new Error(`packages/${item.name}: "${directive}" of ${path} is lost in ${name}.js`);
  }
}

function emitDeclarations(folder, outDir) {
  const tsc = join(repositoryRoot, 'node_modules/typescript/bin/tsc');
  const config = join(folder, 'tsconfig.build.json');
  const { status } = spawnSync(process.execPath, [tsc, '-p', config, '--outDir', outDir], {
    stdio: 'inherit',
  });
  if (status !== 0) throw new Error(`No declarations for ${relative(repositoryRoot, folder)}: tsc failed.`);
  for (const path of filesIn(outDir).filter((file) => file.endsWith('.d.ts'))) {
    // tsc keeps the sources' extension in import specifiers; users need the built files' extension.
    const text = readFileSync(path, 'utf8');
    writeFileSync(
      path,
      text.replace(/((?:from|import|import\()\s*)(['"])(\.[^'"]*)\.tsx?\2/g, '$1$2$3.js$2'),
    );
  }
}

/** Hashes the contents of files and folders (repository-relative), without tests. */
function hashOf(paths, seed = '') {
  const hash = createHash('sha256').update(seed);
  for (const path of paths.flatMap((each) => filesIn(join(repositoryRoot, each)))) {
    if (/\.test(?:-d)?\.tsx?$/.test(path)) continue;
    hash.update(relative(repositoryRoot, path)).update('\0').update(readFileSync(path)).update('\0');
  }
  return hash.digest('hex');
}

/** Lists all files at or below `path` in a fixed order; empty if it does not exist. */
function filesIn(path) {
  if (!existsSync(path)) return [];
  if (statSync(path).isFile()) return [path];
  return readdirSync(path)
    .filter((name) => name !== 'node_modules' && name !== 'dist')
    .sort()
    .flatMap((name) => filesIn(join(path, name)));
}

function stampPath(name) {
  return join(cacheFolder, `${name}.hash`);
}

if (process.argv[1] && import.meta.url === pathToFileURL(process.argv[1]).href) {
  const all = process.argv.includes('--packages') ? build() : build().then(buildViewer);
  await all.catch((error) => fail(error.message));
}
