import { beforeEach } from 'vitest';
import { NO_TIME } from './src/patience.ts';

/**
 * When no further test may begin, milliseconds since 1970. Continuous integration sets it: the full run
 * takes an hour, but a machine can be three times slower than at other times, and a run that is cut off
 * tells nothing.
 */
const endMs = Number(process.env.WEBSPLATTER_TESTS_END_MS ?? Number.POSITIVE_INFINITY);

beforeEach(({ skip }) => {
  if (Date.now() > endMs) skip(NO_TIME);
});
