import { createHash } from 'node:crypto';
import { existsSync, readdirSync, readFileSync } from 'node:fs';
import { join, relative } from 'node:path';
import { defaultClientConditions, defaultServerConditions } from 'vite';
import { defineConfig, type TestProjectInlineConfiguration } from 'vitest/config';
import { BaseSequencer, type TestSpecification } from 'vitest/node';
import { PATIENCE_MS } from './packages/tools/src/patience.ts';

// Tests run on the sources, not on dist: every workspace package exports its src under this condition.
const conditions = ['@websplatter/source', ...defaultClientConditions];
// puppeteer-core and playwright-core run in Node, where their builds for browsers fail.
const nodeConditions = ['@websplatter/source', ...defaultServerConditions];

function resolvedBy(names: readonly string[]) {
  const resolve = { conditions: [...names] };
  return { resolve, ssr: { resolve: { ...resolve, externalConditions: [...names] } } };
}

/** Limit for tests whose own waits do not end. */
const TEST_TIMEOUT_MS = 300_000;

/** Continuous integration has two cores, of which Vitest would take one. */
const MAX_WORKERS = Number(process.env.WEBSPLATTER_WORKERS ?? 2);

const SETUP_FILES = [
  'packages/tools/costs/measure-costs.ts',
  'packages/tools/deadline.ts',
  'packages/tools/equal-arrays.ts',
  'packages/tools/seed-fast-check.ts',
  'packages/tools/settle-imports.ts',
];

const EXPECT = { poll: { timeout: PATIENCE_MS } };
/** A test in which nothing was asserted fails. Tests of pages may assert by waiting alone. */
const ASSERTING = { ...EXPECT, requireAssertions: true };

type ProjectConfig = NonNullable<TestProjectInlineConfiguration['test']>;

const common = {
  environment: 'node',
  testTimeout: TEST_TIMEOUT_MS,
  hookTimeout: TEST_TIMEOUT_MS,
  expect: EXPECT,
  setupFiles: SETUP_FILES,
  maxWorkers: MAX_WORKERS,
  tags: [{ name: 'deeper', description: 'Tries more in the full run than in the first tier.' }],
} satisfies ProjectConfig;

/** Dawn in Node: on SwiftShader where there is no GPU. */
const gpu = {
  ...common,
  pool: 'forks',
  setupFiles: [...SETUP_FILES, 'packages/node/src/testing/watch-devices.ts'],
} satisfies ProjectConfig;

/** Vitest takes the filter from each project, and its types only from the command line. */
const DEEPER_ALONE = { tagsFilter: ['deeper'] } as object;

/** Two processes run one test file after another, and keep imported modules and compiled shaders. */
const inSharedProcesses = { isolate: false };

const unitTests = [
  'packages/*/src/**/*.test.{ts,tsx}',
  'packages/tools/**/*.test.mjs',
  'apps/*/src/**/*.test.{ts,tsx}',
];
const gpuTests = 'packages/*/src/**/*.gpu.test.ts';
const longTests = ['packages/*/src/**/*.long{,.gpu}.test.ts', 'packages/conformance/src/**/*.gpu.test.ts'];
/** Tests of processes that remember which rasteriser was faster. */
const terminalTests = 'packages/cli/src/*.gpu.test.ts';

/** Files in a folder of a package or app, if it has that folder. */
const filesIn = (folder: string, recursive: boolean) =>
  existsSync(folder)
    ? readdirSync(folder, { recursive, encoding: 'utf8' }).map((path) =>
        join(folder, path).replaceAll('\\', '/'),
      )
    : [];

/** Test files in the sources of packages and apps, and their texts. */
const testTexts = ['packages', 'apps']
  .flatMap((room) => readdirSync(room).map((name) => join(room, name)))
  .flatMap((home) => [
    ...filesIn(join(home, 'src'), true),
    // Dependencies of its own are below it.
    ...filesIn(join(home, 'package-checks'), false),
  ])
  .filter((path) => /\.test\.(?:tsx?|mjs)$/.test(path))
  .map((path) => [path, readFileSync(path, 'utf8')] as const);

const testsWith = (pattern: RegExp) =>
  testTexts.filter(([, text]) => pattern.test(text)).map(([path]) => path);

/** Tests that call `vi.mock` must be the first of their process to import the replaced modules. */
const mockingTests = testsWith(/^\s*vi\.(?:do)?[mM]ock\(/m);
/** Files with tests that try more in the full run: of these files, it runs no others again. */
const deeperTests = testsWith(/\btags: 'deeper'/);
const apartGpuTests = [...mockingTests.filter((path) => path.endsWith('.gpu.test.ts')), terminalTests];
/** Long tests that share no process: they mock, or look at a process as a whole. */
const apartLongTests = [
  ...mockingTests.filter((path) => path.includes('.long.')),
  'packages/cli/src/*.long.gpu.test.ts',
  'packages/conformance/src/**/*.gpu.test.ts',
];

const e2e = (name: string, include: string[], exclude: string[] = [], maxWorkers = MAX_WORKERS) =>
  ({
    ...resolvedBy(nodeConditions),
    test: {
      ...common,
      maxWorkers,
      ...inSharedProcesses,
      name,
      include,
      exclude,
      pool: 'forks',
      globalSetup: 'e2e/built-apps.ts',
    },
  }) satisfies TestProjectInlineConfiguration;

const viewerTests = ['e2e/viewer*.test.ts', 'e2e/{accuracy,effects,hard-cases,lab-gallery}.test.ts'];
const hostTests = ['e2e/{react,react-streaming,poster,three,drei,examples}.test.ts'];
const secondWebGpuTests = ['e2e/{firefox*,wgpu}.test.ts'];
const smokeTests = ['e2e/smoke/*.test.ts'];

/**
 * Groups of projects, which run one after another. The projects of a group share the workers, none of which then idles while
 * another ends a project. `npm test` runs the first two groups. The others, named `full:…`, are `npm run test:full` and its
 * shards.
 */
const groups: TestProjectInlineConfiguration[][] = [
  [
    {
      ...resolvedBy(conditions),
      test: {
        ...common,
        ...inSharedProcesses,
        expect: ASSERTING,
        name: 'unit',
        pool: 'threads',
        include: unitTests,
        exclude: [gpuTests, ...longTests, ...mockingTests],
      },
    },
    {
      ...resolvedBy(conditions),
      test: {
        ...common,
        expect: ASSERTING,
        name: 'unit-mocking',
        pool: 'threads',
        include: mockingTests,
        exclude: [gpuTests],
      },
    },
  ],
  [
    {
      ...resolvedBy(conditions),
      test: {
        ...gpu,
        ...inSharedProcesses,
        expect: ASSERTING,
        name: 'gpu',
        include: [gpuTests],
        exclude: [...longTests, ...apartGpuTests],
      },
    },
    {
      ...resolvedBy(conditions),
      test: { ...gpu, expect: ASSERTING, name: 'gpu-apart', include: apartGpuTests, exclude: longTests },
    },
    e2e('smoke', smokeTests),
  ],
  // One Firefox at a time: lavapipe takes all cores for each.
  [e2e('full:second-webgpu', secondWebGpuTests, [], 1)],
  [
    e2e('full:viewer', viewerTests),
    e2e('full:hosts', hostTests),
    e2e(
      'full:packages',
      ['e2e/**/*.test.ts'],
      [...smokeTests, ...viewerTests, ...hostTests, ...secondWebGpuTests],
    ),
    {
      ...resolvedBy(conditions),
      test: {
        ...gpu,
        ...DEEPER_ALONE,
        ...inSharedProcesses,
        name: 'full:deeper',
        include: deeperTests,
        exclude: [...longTests, ...mockingTests],
      },
    },
    {
      ...resolvedBy(conditions),
      test: {
        ...gpu,
        ...DEEPER_ALONE,
        name: 'full:deeper-apart',
        include: mockingTests.filter((path) => deeperTests.includes(path)),
        exclude: longTests,
      },
    },
    // Last: on a slow machine, the tests at the end of a run are skipped (`deadline.ts`).
    {
      ...resolvedBy(conditions),
      test: {
        ...gpu,
        ...inSharedProcesses,
        expect: ASSERTING,
        name: 'full:long',
        include: longTests,
        exclude: apartLongTests,
      },
    },
    {
      ...resolvedBy(conditions),
      test: { ...gpu, name: 'full:long-apart', include: apartLongTests },
    },
  ],
];
const projectNames = groups.flat().map(({ test }) => test?.name);

/**
 * Keeps the files of a project together: shared processes end before a file of another project.
 * `--sequence.shuffle` orders the files of each project by `--sequence.seed`.
 */
class ByProject extends BaseSequencer {
  override async sort(files: TestSpecification[]): Promise<TestSpecification[]> {
    const { root, sequence } = this.ctx.config;
    const { shuffle, seed } = sequence;
    const rank = ({ moduleId }: TestSpecification) =>
      createHash('sha256')
        .update(`${seed} ${relative(root, moduleId)}`)
        .digest('hex');
    const sorted = shuffle
      ? files.toSorted((a, b) => rank(a).localeCompare(rank(b)))
      : await super.sort(files);
    const place = ({ project }: TestSpecification) => projectNames.indexOf(project.name);
    return sorted.toSorted((a, b) => place(a) - place(b));
  }
}

export default defineConfig({
  test: {
    sequence: { sequencer: ByProject },
    reporters: ['default', './packages/tools/plain-line-reporter.ts'],
    projects: groups.flatMap((projects, groupOrder) =>
      projects.map((project) => ({ ...project, test: { ...project.test, sequence: { groupOrder } } })),
    ),
  },
});
