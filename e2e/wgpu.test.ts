// Proves: naga compiles every variant of every shader; hard cases on wgpu and lavapipe.
import { join } from 'node:path';
import { HARD_CASES, type HardCaseReport } from '@websplatter/conformance';
import { runInDeno } from '@websplatter/tools/deno';
import { beforeAll, expect } from 'vitest';
import { deno, lavapipe, testWith } from './second-webgpu.ts';
import { builtApp } from './server.ts';
import type { CompiledShaders } from './wgpu/shaders.ts';

const wgpuTest = testWith({ Deno: deno, 'lavapipe (mesa-vulkan-drivers)': lavapipe });

let folder: string;
beforeAll(async () => {
  folder = await builtApp('e2e/wgpu');
});

async function resultOf<T>(script: string): Promise<T> {
  return JSON.parse(await runInDeno(deno, join(folder, script), lavapipe));
}

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
 * @fault Other WebGPUs: no subgroups
 * @consequence the sort ranks by masks; the images are the same
 */
wgpuTest('hard cases pass on wgpu', { timeout: 900_000 }, async () => {
  const report = await resultOf<HardCaseReport>('hard-cases.js');
  expect(report.results.flatMap(({ failures }) => failures)).toEqual([]);
  expect(report.results).toHaveLength(HARD_CASES.length);
  expect(report.adapter).toMatch(/llvmpipe/);
  expect(report.isSoftware).toBe(true);
  expect(report.isTruncating, 'lavapipe blends halves by truncation').toBe(true);
});
