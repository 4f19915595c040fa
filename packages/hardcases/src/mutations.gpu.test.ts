import { createNodeGpu } from '@websplatter/node';
import { gpuTest } from '@websplatter/node/gpu-test';
import { afterAll, beforeAll, describe, expect } from 'vitest';
import { HARD_CASES } from './catalogue.ts';
import { HardCaseRunner } from './run.ts';
import { MUTATIONS } from './testing/mutations.ts';

/** Also keeps adapters and devices from being garbage-collected, which Dawn does not survive. */
const gpu = { requestAdapter: async () => (await createNodeGpu()).adapter };

let runner: HardCaseRunner;
beforeAll(async () => {
  runner = await HardCaseRunner.create({ gpu });
});
afterAll(() => runner?.destroy());

describe('without a remedy, one of its cases fails', () => {
  for (const { cases, remedy, spareOnGpus, ...mutation } of MUTATIONS) {
    gpuTest(remedy, async ({ skip }) => {
      if (spareOnGpus && !runner.isSoftware) skip(spareOnGpus);
      const verdicts: string[] = [];
      for (const name of cases) {
        const hardCase = HARD_CASES.find((each) => each.name === name);
        expect(hardCase, name).toBeDefined();
        const { verdict } = await runner.run(hardCase!, { presets: ['reference'], mutation });
        verdicts.push(verdict);
      }
      expect(verdicts).toContain('fail');
    });
  }
});
