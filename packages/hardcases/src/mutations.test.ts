import { readFileSync } from 'node:fs';
import { fileURLToPath } from 'node:url';
import { expect, test } from 'vitest';
import { MUTATIONS } from './testing/mutations.ts';

// If the line is missing, the shader does not compile, and a case that fails for that reason proves nothing.
test.each(MUTATIONS)('$remedy replaces a line that occurs once', ({ file, find }) => {
  const path = fileURLToPath(new URL(`../../../shaders/${file}.wgsl`, import.meta.url));
  expect(readFileSync(path, 'utf8').split(find)).toHaveLength(2);
});
