import { expect } from 'vitest';
import { SplatFileError } from '../data/errors.ts';

/** The SplatFileError with which a reading rejects; any other outcome fails the test. */
export async function fileErrorOf(reading: Promise<unknown>): Promise<SplatFileError> {
  const error = await reading.then(
    () => undefined,
    (reason) => reason,
  );
  expect(error).toBeInstanceOf(SplatFileError);
  return error;
}
