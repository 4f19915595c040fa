import { join } from 'node:path';
import { HARD_CASES, type HardCaseReport } from '@websplatter/hardcases';
import { runInDeno } from '@websplatter/tools/deno';
import { beforeAll, expect } from 'vitest';
import { isFull } from './full-run.ts';
import { deno, lavapipe, testWith } from './second-webgpu.ts';
import { builtApp } from './server.ts';
import type { CompiledShaders } from './wgpu/shaders.ts';

const wgpuTest = testWith({ Deno: deno, 'lavapipe (mesa-vulkan-drivers)': lavapipe });

/** One of each kind, and those in which wgpu, naga or lavapipe have differed from Dawn and SwiftShader. */
const SHORT_CASES = [
  'scale-unit',
  'input-half-of-all-rows-nan',
  'depth-planes-one-ulp-apart',
  'camera-off-centre',
  'viewport-0x0',
  // lavapipe blends halves by truncation.
  'accumulate-600-layers',
  'tiles-splats-in-all',
  // Deno ends at a write of no bytes.
  'counts-no-clouds',
  'sort-0-keys',
  'sort-random-32-bits',
  'sort-153603-keys-in-rows-of-7',
  // Firefox has fewer features than Deno.
  'device-no-optional-features',
];

let folder: string;
beforeAll(async () => {
  folder = await builtApp('e2e/wgpu');
});

async function resultOf<T>(script: string, args: readonly string[]): Promise<T> {
  return JSON.parse(await runInDeno(deno, join(folder, script), { driverFile: lavapipe, args }));
}

wgpuTest('naga compiles every variant of every shader', async () => {
  const compiled = await resultOf<CompiledShaders>('shaders.js', isFull ? ['all'] : []);
  expect(compiled.failures).toEqual([]);
  expect(Object.keys(compiled.leftOut), 'features that the device lacks').toEqual(['subgroups']);
  expect(compiled.leftOut.subgroups).toBeLessThan(0.01 * compiled.moduleCount);
  expect(compiled.moduleCount).toBeGreaterThan(800);
  expect(compiled.pipelineCount).toBeGreaterThan(isFull ? 800 : 30);
});

wgpuTest('hard cases pass on wgpu', { timeout: 900_000 }, async () => {
  const report = await resultOf<HardCaseReport>('hard-cases.js', isFull ? [] : SHORT_CASES);
  expect(report.results.flatMap(({ failures }) => failures)).toEqual([]);
  expect(report.results).toHaveLength(isFull ? HARD_CASES.length : SHORT_CASES.length);
  expect(report.adapter).toMatch(/llvmpipe/);
  expect(report.isSoftware).toBe(true);
  expect(report.isTruncating, 'lavapipe blends halves by truncation').toBe(true);
});
