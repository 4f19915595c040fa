import { BaseSequencer, type TestSpecification } from 'vitest/node';

/** Ends of the files that take longest, the longest first. */
const LONGEST = [
  'hardcases/src/hard-cases.gpu.test.ts',
  'e2e/viewer.test.ts',
  'e2e/react.test.ts',
  'e2e/examples.test.ts',
  'e2e/three.test.ts',
  'e2e/accuracy.test.ts',
  'hardcases/src/mutations.gpu.test.ts',
  'views/steady-frames.gpu.test.ts',
  'e2e/firefox.test.ts',
  'e2e/tarball.test.ts',
  'e2e/bench.test.ts',
  'e2e/hard-cases.test.ts',
];

/** Begins with the files that take longest: one that began last would keep a single core busy in the end. */
export default class LongestFirst extends BaseSequencer {
  override async sort(files: TestSpecification[]): Promise<TestSpecification[]> {
    const rank = ({ moduleId }: TestSpecification) => {
      const index = LONGEST.findIndex((end) => moduleId.endsWith(end));
      return index < 0 ? LONGEST.length : index;
    };
    return (await super.sort(files)).toSorted((a, b) => rank(a) - rank(b));
  }
}
