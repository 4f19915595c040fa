import { BaseSequencer, type TestSpecification } from 'vitest/node';

/** Projects whose files share processes, which end where a file of another project comes next, after all others. */
const SHARING = ['e2e', 'gpu'];

/** Ends of the files that take longest, the longest first. */
const LONGEST = [
  'e2e/viewer.test.ts',
  'e2e/react.test.ts',
  'e2e/examples.test.ts',
  'e2e/three.test.ts',
  'e2e/accuracy.test.ts',
  'e2e/firefox.test.ts',
  'e2e/tarball.test.ts',
  'e2e/hard-cases.test.ts',
  'hardcases/src/hard-cases.gpu.test.ts',
  'hardcases/src/mutations.gpu.test.ts',
  'views/steady-frames.gpu.test.ts',
];

/** Begins with the files that take longest: one that began last would keep a single core busy in the end. */
export default class LongestFirst extends BaseSequencer {
  override async sort(files: TestSpecification[]): Promise<TestSpecification[]> {
    const rank = ({ moduleId, project }: TestSpecification) => {
      const index = LONGEST.findIndex((end) => moduleId.endsWith(end));
      return [SHARING.indexOf(project.name), index < 0 ? LONGEST.length : index] as const;
    };
    const inOrder = ([a, longA]: readonly [number, number], [b, longB]: readonly [number, number]) =>
      a - b || longA - longB;
    return (await super.sort(files)).toSorted((a, b) => inOrder(rank(a), rank(b)));
  }
}
