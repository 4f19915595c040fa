import { readdirSync, readFileSync } from 'node:fs';
import { join } from 'node:path';
import { defaultClientConditions, defaultServerConditions } from 'vite';
import { defineConfig } from 'vitest/config';
import LongestFirst from './packages/tools/longest-first.ts';
import { PATIENCE_MS } from './packages/tools/src/patience.ts';

// Tests run on the sources, not on dist: every workspace package exports its src under this condition.
const conditions = ['@websplatter/source', ...defaultClientConditions];
const resolve = { conditions };
const ssr = { resolve: { conditions, externalConditions: conditions } };

// What drives browsers runs in Node: puppeteer-core's WebSockets are of no use under the condition `browser`.
const nodeConditions = ['@websplatter/source', ...defaultServerConditions];
const node = {
  resolve: { conditions: nodeConditions },
  ssr: { resolve: { conditions: nodeConditions, externalConditions: nodeConditions } },
};

/** Ends what hangs. No test waits for it, nor should a machine that does other things, too, ever come near. */
const TEST_TIMEOUT_MS = 300_000;
/** For `expect.poll`, which would wait for a second. */
const patience = { poll: { timeout: PATIENCE_MS } };

const unit = {
  // As many as there are cores in CI, where Vitest would take one of two.
  maxWorkers: 2,
  pool: 'threads',
  testTimeout: TEST_TIMEOUT_MS,
  hookTimeout: TEST_TIMEOUT_MS,
  expect: patience,
  environment: 'node',
} as const;
/** For tests with Dawn in Node. Two files at a time: SwiftShader rests while twins compute. */
const gpu = {
  sequence: { groupOrder: 1 },
  maxWorkers: 2,
  environment: 'node',
  pool: 'forks',
  setupFiles: 'packages/node/src/testing/watch-devices.ts',
  testTimeout: TEST_TIMEOUT_MS,
  expect: patience,
  hookTimeout: TEST_TIMEOUT_MS,
} as const;

const unitTests = [
  'packages/*/src/**/*.test.ts',
  'packages/tools/**/*.test.mjs',
  'apps/*/src/**/*.test.ts',
  'apps/*/src/**/*.test.tsx',
];

/** Tests that put other modules in place of imported ones, for which they must be the first to import them. */
const mockingTests = ['packages', 'apps'].flatMap((room) =>
  readdirSync(room, { recursive: true, encoding: 'utf8' })
    .map((path) => join(room, path))
    .filter((path) => /^[^/]+\/[^/]+\/src\/.*\.test\.tsx?$/.test(path))
    .filter((path) => /\bvi\.(?:do)?[mM]ock\(/.test(readFileSync(path, 'utf8'))),
);
const gpuTests = 'packages/*/src/**/*.gpu.test.ts';
/** Tests that must have a process of their own: the terminal's, too, since a process knows which rasteriser was faster before. */
const apartGpuTests = [
  ...mockingTests.filter((path) => path.endsWith('.gpu.test.ts')),
  'packages/cli/src/*.gpu.test.ts',
];

export default defineConfig({
  test: {
    sequence: { sequencer: LongestFirst },
    reporters: ['default', './packages/tools/plain-line-reporter.ts'],
    projects: [
      {
        resolve,
        ssr,
        test: {
          ...unit,
          name: 'unit',
          // The same two threads take file after file: importing the sources again for each would take as long as the tests.
          isolate: false,
          include: unitTests,
          exclude: [gpuTests, ...mockingTests],
        },
      },
      {
        resolve,
        ssr,
        test: {
          ...unit,
          name: 'unit-mocking',
          include: mockingTests,
          exclude: [gpuTests],
        },
      },
      {
        resolve,
        ssr,
        test: {
          ...gpu,
          name: 'gpu',
          // Two processes take file after file: each by itself would start Vulkan, and import and compile core, again.
          isolate: false,
          include: [gpuTests],
          exclude: apartGpuTests,
        },
      },
      {
        resolve,
        ssr,
        test: {
          ...gpu,
          name: 'gpu-apart',
          include: apartGpuTests,
        },
      },
      {
        ...node,
        test: {
          name: 'e2e',
          globalSetup: 'e2e/built-apps.ts',
          // With those before: pages wait more than they compute.
          sequence: { groupOrder: 1 },
          maxWorkers: 2,
          environment: 'node',
          // Each file would import Vite, Playwright and the sources again.
          isolate: false,
          include: ['e2e/**/*.test.ts'],
          pool: 'forks',
          testTimeout: TEST_TIMEOUT_MS,
          expect: patience,
          hookTimeout: TEST_TIMEOUT_MS,
        },
      },
    ],
  },
});
