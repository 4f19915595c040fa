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
const stageTests = 'packages/core/src/stages/*.gpu.test.ts';

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
    .filter((path) => /^[^/]+\/[^/]+\/src\/.*(?<!\.gpu)\.test\.tsx?$/.test(path))
    .filter((path) => /\bvi\.(?:do)?[mM]ock\(/.test(readFileSync(path, 'utf8'))),
);

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
          exclude: ['**/*.gpu.test.ts', ...mockingTests],
        },
      },
      {
        resolve,
        ssr,
        test: {
          ...unit,
          name: 'unit-mocking',
          include: mockingTests,
        },
      },
      {
        resolve,
        ssr,
        test: {
          ...gpu,
          name: 'gpu-stages',
          // Small tests of one shader each: starting a process and Vulkan for each would take a quarter of their time.
          isolate: false,
          include: [stageTests],
        },
      },
      {
        resolve,
        ssr,
        test: {
          ...gpu,
          name: 'gpu',
          // A process per file: devices are kept for as long as it lives.
          include: ['packages/*/src/**/*.gpu.test.ts'],
          exclude: [stageTests],
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
