import { createNodeGpu } from '@websplatter/node';
import { gpuTest } from '@websplatter/node/gpu-test';
import { afterAll, beforeAll, describe, expect } from 'vitest';
import { HARD_CASES } from './catalogue.ts';
import { HardCaseRunner } from './run.ts';

/** Also keeps what it gives alive, as Dawn needs it. */
const gpu = { requestAdapter: async () => (await createNodeGpu()).adapter };
/** For the whole catalogue, in software, at 64×64. */
const BUDGET_MS = 180_000;

let runner: HardCaseRunner;
let elapsedMs = 0;
let casesRun = 0;
beforeAll(async () => {
  runner = await HardCaseRunner.create({ gpu });
});
afterAll(() => runner?.destroy());

describe('hard case', () => {
  for (const hardCase of HARD_CASES) {
    gpuTest(hardCase.name, async () => {
      const result = await runner.run(hardCase);
      elapsedMs += result.elapsedMs;
      casesRun++;
      if (result.verdict === 'fail') expect.fail(result.failures.join('\n'));
    });
  }

  gpuTest('all of them within the budget on a software adapter', ({ skip }) => {
    if (!runner.isSoftware || casesRun < HARD_CASES.length) skip('needs every case, on a software adapter');
    expect(elapsedMs).toBeLessThan(BUDGET_MS);
  });
});
