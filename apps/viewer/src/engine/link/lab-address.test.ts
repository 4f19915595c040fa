import { expect, test } from 'vitest';
import { benchmarkAddress, galleryAddress, movedAddress } from './lab-address.ts';

const address = (of: typeof benchmarkAddress, query: string) => of(new URLSearchParams(query));

test('the benchmark gets scene and accuracy of the viewer, and nothing else', () => {
  const viewer = 'src=a.ply&src=b.ply&accuracy=fast&camera=1,2,3&noui';
  expect(address(benchmarkAddress, viewer)).toBe('lab/?bench&src=a.ply&src=b.ply&accuracy=fast');
  expect(address(benchmarkAddress, '')).toBe('lab/?bench');
});

test('the gallery shows all hard cases, or one', () => {
  expect(galleryAddress()).toBe('lab/?gallery');
  expect(galleryAddress('a b')).toBe('lab/?gallery&case=a%20b');
});

test('old addresses of the benchmark and of the conformance page lead to the lab', () => {
  expect(address(movedAddress, 'bench&scene=still-life')).toBe('lab/?bench=&scene=still-life');
  expect(address(movedAddress, 'conformance&cases=a')).toBe('lab/?conformance=&cases=a');
});

test('so do old addresses of the gallery, but not the addresses of a case as a scene', () => {
  expect(address(movedAddress, 'scene=hard')).toBe('lab/?gallery=');
  expect(address(movedAddress, 'scene=hard&q=scale&case=a')).toBe('lab/?gallery=&q=scale&case=a');
  expect(address(movedAddress, 'scene=hard:a')).toBeNull();
  expect(address(movedAddress, 'scene=hard&src=a.ply')).toBeNull();
});
