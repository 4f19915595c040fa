// Proves: naga compiles every variant of every shader; hard cases on wgpu and lavapipe.
import { join } from 'node:path';
import { HARD_CASES, type HardCaseReport } from '@websplatter/conformance';
import { runInDeno } from '@websplatter/tools/deno';
import { beforeAll, expect } from 'vitest';
import { deno, lavapipe, testWith } from './second-webgpu.ts';
import { builtApp } from './server.ts';
import type { CompiledShaders } from './wgpu/shaders.ts';
import type { CompiledTogether } from './wgpu/together.ts';

const wgpuTest = testWith({ Deno: deno, 'lavapipe (mesa-vulkan-drivers)': lavapipe });

let folder: string;
beforeAll(async () => {
  folder = await builtApp('e2e/wgpu');
});

async function resultOf<T>(script: string, ...args: readonly string[]): Promise<T> {
  return JSON.parse(await runInDeno(deno, join(folder, script), lavapipe, args));
}

/** Processes for the hard cases: Deno waits for most of the time that a readback takes. */
const PROCESSES = 4;

/**
 * @fault Other WebGPUs: naga, another shader compiler, refuses a shader
 * @consequence found before a release
 */
wgpuTest('naga compiles every variant of every shader', async () => {
  const compiled = await resultOf<CompiledShaders>('shaders.js');
  expect(compiled.failures).toEqual([]);
  expect(Object.keys(compiled.leftOut), 'features that the device lacks').toEqual(['subgroups']);
  expect(compiled.leftOut.subgroups).toBeLessThan(0.01 * compiled.moduleCount);
  expect(compiled.moduleCount).toBeGreaterThan(800);
  expect(compiled.pipelineCount).toBeGreaterThan(800);
});

/**
 * @fault Other WebGPUs: naga refuses a shader of features that meet in one frame
 * @consequence found before a release
 */
wgpuTest('naga compiles the shaders of everything that may be in one frame', async () => {
  const { failures, frameCount, moduleCount } = await resultOf<CompiledTogether>('together.js');
  expect(failures).toEqual([]);
  expect(frameCount).toBeGreaterThan(900);
  expect(moduleCount).toBeGreaterThan(400);
});

/**
 * @fault Other WebGPUs: no subgroups
 * @consequence the sort ranks by masks; the images are the same
 */
wgpuTest('hard cases pass on wgpu', { timeout: 900_000 }, async () => {
  const reports = await Promise.all(
    Array.from({ length: PROCESSES }, (_, first) =>
      resultOf<HardCaseReport>('hard-cases.js', `${first}`, `${PROCESSES}`),
    ),
  );
  const results = reports.flatMap((report) => report.results);
  expect(results.flatMap(({ failures }) => failures)).toEqual([]);
  expect(new Set(results.map(({ name }) => name)).size).toBe(HARD_CASES.length);
  for (const { adapter, isSoftware, isTruncating } of reports) {
    expect(adapter).toMatch(/llvmpipe/);
    expect(isSoftware).toBe(true);
    expect(isTruncating, 'lavapipe blends halves by truncation').toBe(true);
  }
});
