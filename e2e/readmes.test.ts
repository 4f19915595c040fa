// Proves: examples of READMEs and of the site type-check as pasted, with the packages of their install
// lines.
import { spawnSync } from 'node:child_process';
import {
  mkdirSync,
  mkdtempSync,
  readdirSync,
  readFileSync,
  rmSync,
  symlinkSync,
  writeFileSync,
} from 'node:fs';
import { tmpdir } from 'node:os';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { HARD_CASES } from '@websplatter/conformance';
import { expect, test } from 'vitest';
import { completedExample, examplesIn, installedBy, packagesOf } from './readme-examples.ts';

const repositoryRoot = fileURLToPath(new URL('..', import.meta.url));

/** Arrays of own splats. */
const ARRAYS = { positions: 'Float32Array', scales: 'Float32Array', colors: 'Float32Array' };

/** Weights of joints, and their matrices. */
const SKIN = { indices: 'Uint8Array', weights: 'Float32Array', matrices: 'Float32Array' };

/** Names that examples presuppose, with their types. */
type Given = Readonly<Record<string, string>>;

/** Names that draw a frame of the engine, with their types. */
const FRAME = {
  view: "import('@websplatter/core').SplatView",
  camera: "import('@websplatter/core').Camera",
  cloud: "import('@websplatter/core').SplatCloud",
  widthPx: 'number',
  heightPx: 'number',
};

/** Names of a scene of three.js, with their types. */
const THREE = {
  canvas: 'HTMLCanvasElement',
  renderer: "import('three/webgpu').WebGPURenderer",
  scene: "import('three/webgpu').Scene",
  camera: "import('three/webgpu').PerspectiveCamera",
  cloud: "import('@websplatter/three').SplatCloudObject",
};

/** Type of the ref of a `<Splats>`. */
const SPLATS_REF = "import('react').RefObject<import('@websplatter/react').SplatCloudObject | null>";

const PLACEHOLDER = { Placeholder: "() => import('react').ReactNode" };

const FRAME_REQUEST = "import('@websplatter/core').FrameRequest";

/** READMEs, and the names that their examples presuppose. */
const READMES: Readonly<Record<string, Given>> = {
  'README.md': {},
  'packages/node/README.md': {},
  'packages/scenes/README.md': {},
  'packages/core/README.md': {
    ...FRAME,
    engine: "import('@websplatter/core').SplatEngine",
    clouds: "import('@websplatter/core').CloudInstance[]",
    frame: FRAME_REQUEST,
    from: "import('@websplatter/core').SplatSet",
    to: "import('@websplatter/core').SplatSet",
    selection: "import('@websplatter/core/effects').SplatSelection",
    rotations: 'Float32Array',
    opacities: 'Float32Array',
    ...ARRAYS,
  },
  'packages/react/README.md': {
    Placeholder: "() => import('react').ReactNode",
    splats: "import('react').RefObject<import('@websplatter/react').SplatCloudObject | null>",
    center: "import('three').Vector3",
    radius: 'number',
    sources: 'string[]',
    ...ARRAYS,
  },
  'packages/three/README.md': {
    canvas: 'HTMLCanvasElement',
    renderer: "import('three/webgpu').WebGPURenderer",
    scene: "import('three/webgpu').Scene",
    camera: "import('three/webgpu').PerspectiveCamera",
    cloud: "import('@websplatter/three').SplatCloudObject",
    data: "import('@websplatter/three').SplatData",
    calm: "import('@websplatter/three/own-data').SplatDataInput",
    smiling: "import('@websplatter/three/own-data').SplatDataInput",
    files: 'File[]',
    render: '() => void',
    pane: "import('three/webgpu').Mesh<import('three/webgpu').BufferGeometry, import('three/webgpu').MeshBasicMaterial>",
    min: "import('three').Vector3",
    max: "import('three').Vector3",
    selection: "import('@websplatter/core/effects').SplatSelection",
    ...ARRAYS,
  },
};

/** Documents whose examples install nothing, and the names that these presuppose. */
const DOCUMENTS: Readonly<Record<string, Given>> = {
  'docs/effects.md': {
    ...FRAME,
    splatCloudObject: "import('@websplatter/three').SplatCloudObject",
    useFrame: "typeof import('@react-three/fiber').useFrame",
    isMoving: 'boolean',
    timeS: '{ current: number }',
    amplitude: 'number',
    splats: "import('react').RefObject<import('@websplatter/react').SplatCloudObject | null>",
    windSway:
      "(options: { amplitude: number; timeS: number; ground?: number; tall?: number }) => import('@websplatter/core/effects').EffectUse",
    windSwayReference: 'never',
    set: "import('@websplatter/core').SplatSet",
    pixels: 'Float32Array',
    renderer: THREE.renderer,
    requestFrame: '() => void',
    rowCount: 'number',
    depthTexture: 'GPUTexture',
    cameraOfSun: "import('@websplatter/core').Camera",
    mapsDrawn: 'number',
  },
  'docs/formats.md': { engine: "import('@websplatter/core').SplatEngine" },
  'docs/streamed-scenes.md': {
    engine: "import('@websplatter/core').SplatEngine",
    file: 'File',
    signal: 'AbortSignal',
  },
  'docs/detail.md': {
    ...FRAME,
    canvas: 'HTMLCanvasElement',
    // In one example the engine's, in another that of three.
    cloud: "import('@websplatter/core').SplatCloud & import('@websplatter/three').SplatCloudObject",
  },
};

/**
 * Names that pages of the documentation site presuppose, by their path; the rest of their text
 * comes from READMEs.
 */
const PAGES: Readonly<Record<string, Readonly<Record<string, string>>>> = {
  'learn/quick-start.md': {},
  'learn/get-a-scene.md': {},
  'learn/which-api.md': {},
  'learn/migrate.md': {},
  'guides/loading.md': {
    ...THREE,
    ...PLACEHOLDER,
    engine: "import('@websplatter/core').SplatEngine",
    controller: 'AbortController',
  },
  'guides/streaming.md': { file: 'File' },
  'guides/events.md': {
    ...FRAME,
    ...THREE,
    engine: "import('@websplatter/core').SplatEngine",
    xPx: 'number',
    yPx: 'number',
  },
  'guides/labels.md': {},
  'guides/instances.md': { ...THREE, ...FRAME },
  'guides/sequences.md': {
    ...THREE,
    ...PLACEHOLDER,
    sources: 'string[]',
    files: 'File[]',
    render: '() => void',
  },
  'guides/own-data.md': {
    ...THREE,
    ...FRAME,
    ...ARRAYS,
    rotations: 'Float32Array',
    opacities: 'Float32Array',
    engine: "import('@websplatter/core').SplatEngine",
    frame: FRAME_REQUEST,
    count: 'number',
    simulation: 'GPUCommandBuffer',
    from: "import('@websplatter/core').SplatSet",
    to: "import('@websplatter/core').SplatSet",
    selection: "import('@websplatter/core/effects').SplatSelection",
    ...SKIN,
  },
  'guides/moving-scenes.md': { ...FRAME, cloudObject: THREE.cloud },
  'guides/effects.md': {
    cloud: THREE.cloud,
    scene: THREE.scene,
    splats: SPLATS_REF,
  },
  'guides/shadows.md': {},
  'guides/depth.md': {
    ...THREE,
    data: "import('@websplatter/three').SplatData",
    pane: "import('three/webgpu').Mesh<import('three/webgpu').BufferGeometry, import('three/webgpu').MeshBasicMaterial>",
  },
  'guides/xr.md': THREE,
  'guides/testing.md': {},
  'guides/saving.md': { ...THREE, view: FRAME.view, file: 'File' },
  'hood/accuracy-here.md': { ...FRAME, clouds: "import('@websplatter/core').CloudInstance[]" },
  'shipping/bundlers.md': {},
  'shipping/errors.md': { engine: "import('@websplatter/core').SplatEngine" },
  'shipping/performance.md': {},
  'shipping/next.md': {},
  'guides/physics.md': {
    raycaster: "import('three').Raycaster",
    position: "import('three').Vector3",
    cloud: "import('@websplatter/three').SplatCloudObject",
    eyeHeight: 'number',
  },
  'guides/post-processing.md': THREE,
  'contribute/add-a-format.md': {},
  'contribute/debug-a-picture.md': {},
};

/** Compiles modules by name, strictly; returns the compiler's messages. */
function compile(modules: Readonly<Record<string, string>>): string {
  const folder = mkdtempSync(join(tmpdir(), 'websplatter-readmes-'));
  try {
    symlinkSync(join(repositoryRoot, 'node_modules'), join(folder, 'node_modules'), 'junction');
    for (const [name, text] of Object.entries(modules)) {
      mkdirSync(dirname(join(folder, name)), { recursive: true });
      writeFileSync(join(folder, name), text);
    }
    const ofExamples = join(repositoryRoot, 'apps/examples/node_modules');
    const compilerOptions = {
      // Further packages of examples have an installation of their own.
      paths: Object.fromEntries(
        ['@react-three/drei', '@react-three/rapier'].map((name) => [name, [join(ofExamples, name)]]),
      ),
      // So that new files of the repository import others by relative paths.
      rootDirs: [folder, repositoryRoot],
      target: 'ES2022',
      module: 'ESNext',
      moduleResolution: 'bundler',
      // The sources, whether or not they are built.
      customConditions: ['@websplatter/source'],
      allowImportingTsExtensions: true,
      lib: ['ES2023', 'DOM', 'DOM.Iterable', 'DOM.AsyncIterable'],
      types: ['@webgpu/types', 'vite/client', 'node'],
      jsx: 'react-jsx',
      strict: true,
      skipLibCheck: true,
      noEmit: true,
    };
    writeFileSync(
      join(folder, 'tsconfig.json'),
      JSON.stringify({ compilerOptions, files: Object.keys(modules) }),
    );
    const tsc = join(repositoryRoot, 'node_modules/typescript/bin/tsc');
    const args = [tsc, '-p', folder, '--pretty', 'false'];
    return spawnSync(process.execPath, args, { cwd: folder, encoding: 'utf8' }).stdout;
  } finally {
    rmSync(folder, { recursive: true, force: true });
  }
}

/** Finds the examples of READMEs, documents and the site's pages, as modules by name. */
function documentExamples(): Record<string, string> {
  const modules: Record<string, string> = {};
  const pages = Object.entries(PAGES).map(([page, given]): [string, Given] => [
    `apps/docs/pages/${page}`,
    given,
  ]);
  for (const [path, given] of [...Object.entries(READMES), ...Object.entries(DOCUMENTS), ...pages]) {
    const examples = examplesIn(readFileSync(join(repositoryRoot, path), 'utf8'));
    expect(examples.length, path).toBeGreaterThan(0);
    for (const { line, language, code } of examples) {
      // Excerpts of a file that another test compiles.
      if (code.includes('// …')) continue;
      // A new file of the repository has its path in its first line.
      const file = /^\/\/ (packages\/\S+)\n/.exec(code)?.[1];
      const name = file ?? `${path.replaceAll('/', '-')}-line-${line}.${language}`;
      modules[name] = completedExample(code, given);
    }
  }
  return modules;
}

test('examples of READMEs, of the site’s pages and of docstrings type-check, strictly; a wrong one is found', async () => {
  const wrong = `import type { SplatCloudObject } from '@websplatter/react';
import { useRef } from 'react';

const cloud = useRef<SplatCloudObject>(null);
cloud.current.pickAt({ clientX: 1, clientY: 2 });
`;
  const modules = {
    ...documentExamples(),
    ...(await docstringModules()),
    'wrong.tsx': completedExample(wrong, {}),
  };
  const said = compile(modules).trim().split('\n');
  expect(said).toEqual([
    expect.stringMatching(/^wrong\.tsx\(6,1\): error TS18047: 'cloud\.current' is possibly/),
  ]);
});

/**
 * @fault Pages and packages: an example of a README lacks an import, or an install line
 * @consequence the tests fail with the place
 */
test('every page with code is among those that are compiled', () => {
  const withCode = (folder: string) =>
    readdirSync(join(repositoryRoot, folder), { recursive: true, encoding: 'utf8' }).filter(
      (path) =>
        path.endsWith('.md') &&
        examplesIn(readFileSync(join(repositoryRoot, folder, path), 'utf8')).length > 0,
    );
  expect(Object.keys(PAGES)).toEqual(expect.arrayContaining(withCode('apps/docs/pages')));
  expect(Object.keys(DOCUMENTS)).toEqual(
    expect.arrayContaining(withCode('docs').map((path) => `docs/${path}`)),
  );
});

test.each(Object.keys(READMES).filter((path) => path !== 'packages/node/README.md'))(
  'what examples of %s import is in an install line of it',
  (path) => {
    const text = readFileSync(join(repositoryRoot, path), 'utf8');
    const installed = installedBy(text);
    for (const { line, code } of examplesIn(text))
      expect(installed, `${path}:${line}`).toEqual(expect.arrayContaining(packagesOf(code)));
  },
);

test('an example gets the names that it lacks, and no others', () => {
  const code =
    "import { Canvas } from '@react-three/fiber';\nconst splats = useRef(Splats), more = a.tint;\n";
  const { 0: first, length } = completedExample(code, { splats: 'never', a: 'any' }).split('\n');
  expect(first).toBe('declare const a: any; export {};');
  expect(length).toBe(4);
  expect(packagesOf(code)).toEqual(['@react-three/fiber']);
  expect(installedBy('npm install a @b/c\nnpm install --save-dev d # for e\n')).toEqual(['a', '@b/c', 'd']);
  expect(installedBy('npm install ~/packed/*.tgz a')).toEqual(
    expect.arrayContaining(['@websplatter/react', 'a']),
  );
  expect(examplesIn('# A\n\n```ts\na\n```\n\n```\nno\n```\n```tsx\n<b />\n```\n')).toEqual([
    { line: 4, language: 'ts', code: 'a\n' },
    { line: 11, language: 'tsx', code: '<b />\n' },
  ]);
});

/** Names that examples of docstrings presuppose. */
const GIVEN: Readonly<Record<string, string>> = {
  ...FRAME,
  ...SKIN,
  canvas: 'HTMLCanvasElement',
  depthTexture: 'GPUTexture',
  cameraOfSun: "import('@websplatter/core').Camera",
  engine: "import('@websplatter/core').SplatEngine",
  file: 'File',
  files: 'File[]',
  label: 'HTMLElement',
  renderer: "import('three/webgpu').WebGPURenderer",
  scene: "import('three/webgpu').Scene",
  stream: 'FileSystemWritableFileStream',
  worker: 'Worker',
  threeCamera: "import('three/webgpu').PerspectiveCamera",
};
/** In packages for three.js, names mean its objects. */
const GIVEN_IN_THREE = {
  ...GIVEN,
  camera: GIVEN.threeCamera,
  cloud: "import('@websplatter/three').SplatCloudObject",
  simulation: "import('three/webgpu').ComputeNode",
  bones: "import('three/webgpu').Bone[]",
  set: "import('@websplatter/core').SplatSet",
};
const NAMES_OF_THREE = { 'three/webgpu': ['Box3', 'Matrix4', 'Skeleton', 'Vector3', 'WebGPURenderer'] };
/** Names that examples of each package use besides its own, by where they come from. */
const OTHER_NAMES: Readonly<Record<string, Readonly<Record<string, readonly string[]>>>> = {
  core: {},
  three: {
    '@websplatter/core': ['readSplats'],
    '@websplatter/core/effects': ['tint', 'volumes'],
    ...NAMES_OF_THREE,
    'three/addons/controls/OrbitControls.js': ['OrbitControls'],
    'three/addons/loaders/GLTFLoader.js': ['GLTFLoader'],
    'three/tsl': ['instancedArray', 'sin', 'time', 'vec3'],
  },
  react: {
    ...NAMES_OF_THREE,
    '@react-three/drei': ['Html'],
    '@react-three/fiber': ['Canvas', 'useFrame'],
    '@react-three/rapier': ['RigidBody', 'TrimeshCollider'],
    react: ['useRef'],
  },
};

/** Finds the examples in docstrings of what packages export, as modules by name. */
async function docstringModules(): Promise<Record<string, string>> {
  const modules: Record<string, string> = {};
  for (const [name, others] of Object.entries(OTHER_NAMES)) {
    const own: Record<string, readonly string[]> = {};
    for (const path of entriesOf(name)) {
      const exported = Object.keys(await import(path));
      // Entries repeat names of others, for apps that install only one package.
      own[path] = exported.filter((each) => !Object.values(own).flat().includes(each));
    }
    const exported = Object.values(own).flat();
    for (const { symbol, code } of docstringExamples(join(repositoryRoot, 'packages', name, 'src'))) {
      // Examples of other functions are for readers of the source.
      if (!exported.includes(symbol)) continue;
      const imports = Object.entries({ ...own, ...others }).map(([path, names]) => {
        const used = names.filter((each) => new RegExp(`\\b${each}\\b`).test(code));
        return used.length > 0 ? `import { ${used.join(', ')} } from '${path}';\n` : '';
      });
      modules[`${name}-${symbol}.tsx`] = completedExample(
        imports.join('') + code,
        name === 'core' ? GIVEN : GIVEN_IN_THREE,
      );
    }
  }
  expect(Object.keys(modules).length).toBeGreaterThan(120);
  return modules;
}

/** Entry points that are for tests and tools of this repository, or a script. */
const UNCHECKED_ENTRIES = /^@websplatter\/core\/(?:inspect|load-worker|reference)$/;

/** Import names of a package's entry points for users. */
function entriesOf(folder: string): string[] {
  const manifest = readFileSync(join(repositoryRoot, 'packages', folder, 'package.json'), 'utf8');
  return Object.keys(JSON.parse(manifest).exports)
    .map((subpath) => `@websplatter/${folder}${subpath.slice(1)}`)
    .filter((path) => !UNCHECKED_ENTRIES.test(path));
}

/** Finds the examples in docstrings of exported functions, classes and types of a folder. */
function docstringExamples(folder: string): { symbol: string; code: string }[] {
  const sources = readdirSync(folder, { recursive: true, encoding: 'utf8' }).filter((path) =>
    /^(?!.*\.test\.).*\.tsx?$/.test(path),
  );
  const documented =
    /\/\*\*((?:(?!\*\/)[\s\S])*)\*\/\nexport (?:async )?(?:abstract )?(?:function|class|const|type) (\w+)/g;
  return sources.flatMap((path) =>
    [...readFileSync(join(folder, path), 'utf8').matchAll(documented)].flatMap(([, doc, symbol]) => {
      const [, lines] = /@example\n((?: \*(?! @).*\n)+)/.exec(`${doc}\n`) ?? [];
      if (lines === undefined || /@(?:hidden|internal)/.test(doc)) return [];
      return [{ symbol, code: lines.replace(/^ \* ?/gm, '') }];
    }),
  );
}

test('README and the first page count hard cases and examples as the code does', () => {
  const examples = readdirSync(join(repositoryRoot, 'apps/examples/src/routes')).length;
  const counted = ['README.md', 'apps/docs/pages/index.md'].flatMap((path) => {
    const text = readFileSync(join(repositoryRoot, path), 'utf8');
    return [...text.matchAll(/\b(\d+)\s+\[?(hard\s+cases|examples)/g)];
  });
  expect(counted.length).toBeGreaterThan(2);
  for (const [all, count, what] of counted)
    expect(Number(count), all).toBe(what === 'examples' ? examples : HARD_CASES.length);
});
