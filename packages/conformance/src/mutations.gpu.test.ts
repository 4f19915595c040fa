// Proves: without a remedy in a shader, its hard case fails with each rasteriser.
import { sharedTestGpu as gpu, gpuTest } from '@websplatter/node/gpu-test';
import { afterAll, beforeAll, describe, expect } from 'vitest';
import { HARD_CASES } from './catalogue.ts';
import { MUTATIONS } from './mutations.ts';
import { HardCaseRunner } from './run.ts';
import { CASE_RASTERIZERS } from './run-result.ts';

let runner: HardCaseRunner;
beforeAll(async () => {
  runner = await HardCaseRunner.create({ gpu });
});
afterAll(() => runner?.destroy());

describe('without a remedy, one of its cases fails with each rasteriser that needs it', () => {
  for (const { cases, remedy, rasterizer: only, spareOnGpus, ...mutation } of MUTATIONS) {
    gpuTest(remedy, async ({ skip }) => {
      if (spareOnGpus && !runner.isSoftware) skip(spareOnGpus);
      for (const rasterizer of CASE_RASTERIZERS) {
        let fails = false;
        for (const name of cases) {
          if (fails) break;
          const hardCase = HARD_CASES.find((each) => each.name === name);
          expect(hardCase, name).toBeDefined();
          const options = {
            presets: ['reference'],
            rasterizers: [rasterizer],
            endsAtFailure: true,
            mutation,
          } as const;
          fails = (await runner.run(hardCase!, options)).verdict === 'fail';
        }
        const needsIt = only === undefined || only === rasterizer;
        expect(fails, `${rasterizer}: a case fails`).toBe(needsIt);
      }
    });
  }
});
