import { readFileSync } from 'node:fs';
import { fileURLToPath } from 'node:url';
import { expect, test } from 'vitest';
import { MUTATIONS } from './mutations.ts';

// A shader without the line does not compile, and a case that fails for that proves nothing.
test.each(MUTATIONS)('$remedy replaces a line that occurs once', ({ file, find }) => {
  const path = fileURLToPath(new URL(`../../../shaders/${file}.wgsl`, import.meta.url));
  expect(readFileSync(path, 'utf8').split(find)).toHaveLength(2);
});
