import { expect, test } from 'vitest';
import { benchmarkAddress, conformanceAddress, movedAddress } from './lab-address.ts';

const address = (of: typeof benchmarkAddress, query: string) => of(new URLSearchParams(query));

test('the benchmark gets scene and accuracy of the viewer, and nothing else', () => {
  const viewer = 'src=a.ply&src=b.ply&accuracy=fast&camera=1,2,3&noui';
  expect(address(benchmarkAddress, viewer)).toBe('lab/?bench&src=a.ply&src=b.ply&accuracy=fast');
  expect(address(benchmarkAddress, '')).toBe('lab/?bench');
});

test('the hard cases are run all, or one', () => {
  expect(conformanceAddress()).toBe('lab/?conformance');
  expect(conformanceAddress('a b')).toBe('lab/?conformance&cases=a%20b');
});

test('old addresses of the benchmark and of the conformance page lead to the lab', () => {
  expect(address(movedAddress, 'bench&scene=still-life')).toBe('lab/?bench=&scene=still-life');
  expect(address(movedAddress, 'conformance&cases=a')).toBe('lab/?conformance=&cases=a');
  expect(address(movedAddress, 'scene=hard')).toBeNull();
});
