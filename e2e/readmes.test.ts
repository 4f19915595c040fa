// Proves: examples of READMEs and of the site type-check as pasted, with the packages of their install
// lines.
import { spawnSync } from 'node:child_process';
import { mkdirSync, mkdtempSync, readFileSync, rmSync, symlinkSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { expect, test } from 'vitest';
import { completedExample, examplesIn, installedBy, packagesOf } from './readme-examples.ts';

const repositoryRoot = fileURLToPath(new URL('..', import.meta.url));

/** Arrays of own splats. */
const ARRAYS = { positions: 'Float32Array', scales: 'Float32Array', colors: 'Float32Array' };

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

/** READMEs, and the names that their examples presuppose. */
const READMES: Readonly<Record<string, Given>> = {
  'README.md': {},
  'packages/node/README.md': {},
  'packages/core/README.md': {
    ...FRAME,
    engine: "import('@websplatter/core').SplatEngine",
    clouds: "import('@websplatter/core').CloudInstance[]",
    frame: "import('@websplatter/core').FrameRequest",
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
    calm: "import('@websplatter/three/own-data').SplatsInMemory",
    smiling: "import('@websplatter/three/own-data').SplatsInMemory",
    files: 'File[]',
    render: '() => void',
    pane: "import('three/webgpu').Mesh<import('three/webgpu').BufferGeometry, import('three/webgpu').MeshBasicMaterial>",
    min: "import('three').Vector3",
    max: "import('three').Vector3",
    selection: "import('@websplatter/core/effects').SplatSelection",
    ...ARRAYS,
  },
};

/**
 * Names that pages of the documentation site presuppose, by their path; the rest of their text
 * comes from READMEs.
 */
const PAGES: Readonly<Record<string, Readonly<Record<string, string>>>> = {
  'learn/camera.md': { ...FRAME, aspect: 'number' },
  'guides/effects.md': FRAME,
  'learn/quick-start.md': {},
  'guides/loading.md': { engine: "import('@websplatter/core').SplatEngine", controller: 'AbortController' },
  'guides/events.md': { ...FRAME, xPx: 'number', yPx: 'number' },
  'shipping/servers.md': { Garden: "() => import('react').ReactNode" },
  'shipping/next.md': {},
  'guides/physics.md': {
    raycaster: "import('three').Raycaster",
    position: "import('three').Vector3",
    cloud: "import('@websplatter/three').SplatCloudObject",
    eyeHeight: 'number',
  },
  'guides/post-processing.md': {},
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

test('examples of READMEs, and of the site’s pages, type-check, strictly; a wrong one is found', () => {
  const modules: Record<string, string> = {};
  const pages = Object.entries(PAGES).map(([page, given]): [string, Given] => [
    `apps/docs/pages/${page}`,
    given,
  ]);
  for (const [path, given] of [...Object.entries(READMES), ...pages]) {
    const examples = examplesIn(readFileSync(join(repositoryRoot, path), 'utf8'));
    expect(examples.length, path).toBeGreaterThan(path.endsWith('README.md') ? 1 : 0);
    for (const { line, language, code } of examples) {
      // A new file of the repository has its path in its first line.
      const file = /^\/\/ (packages\/\S+)\n/.exec(code)?.[1];
      const name = file ?? `${path.replaceAll('/', '-')}-line-${line}.${language}`;
      modules[name] = completedExample(code, given);
    }
  }
  const wrong = `import type { SplatCloudObject } from '@websplatter/react';
import { useRef } from 'react';

const cloud = useRef<SplatCloudObject>(null);
cloud.current.pick(1, 2);
`;
  modules['wrong.tsx'] = completedExample(wrong, {});
  const said = compile(modules).trim().split('\n');
  expect(said).toEqual([
    expect.stringMatching(/^wrong\.tsx\(6,1\): error TS18047: 'cloud\.current' is possibly/),
  ]);
});

/**
 * @fault Pages and packages: an example of a README lacks an import, or an install line
 * @consequence the tests fail with the place
 */
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
  expect(examplesIn('# A\n\n```ts\na\n```\n\n```\nno\n```\n```tsx\n<b />\n```\n')).toEqual([
    { line: 4, language: 'ts', code: 'a\n' },
    { line: 11, language: 'tsx', code: '<b />\n' },
  ]);
});
