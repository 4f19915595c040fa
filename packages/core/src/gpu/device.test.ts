import { expect, test } from 'vitest';
import { hasNarrowSubgroups } from './device.ts';

test.each([
  ['SwiftShader', 4, true],
  ['a driver for 256-bit vectors', 8, true],
  ['most GPUs', 32, false],
  ['a browser that names the limits of the specification', 128, false],
  ['a browser that knows nothing', 0, false],
  ['a browser without subgroups', undefined, false],
])('%s: subgroups of up to %s threads', (_, subgroupMaxSize, isNarrow) => {
  const adapterInfo = { subgroupMaxSize } as GPUAdapterInfo;
  expect(hasNarrowSubgroups({ adapterInfo })).toBe(isNarrow);
});
