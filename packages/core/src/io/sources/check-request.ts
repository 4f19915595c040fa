import { InvalidArgumentError } from '../../data/errors.ts';
import { given, wrongArgument } from '../../data/given.ts';
import type { RequestOptions } from './splat-source.ts';

const CREDENTIALS: readonly unknown[] = ['omit', 'same-origin', 'include'];
/** More retries would look like an attack. */
const MOST_RETRIES = 100;
/** Timers that are set for longer fire at once. */
const LONGEST_TIMER_MS = 2 ** 31 - 1;

/** Returns the options with their defaults. @throws InvalidArgumentError for invalid ones. */
export function checkRequest(request: RequestOptions): Required<RequestOptions> {
  const {
    headers = {},
    credentials = 'same-origin',
    idleTimeoutMs = 30_000,
    maxRetries = 4,
  } = given(request, {}, 'request');
  if (!CREDENTIALS.includes(credentials))
    throw wrongArgument('credentials', credentials, CREDENTIALS.join(', '));
  if (!(typeof idleTimeoutMs === 'number' && idleTimeoutMs > 0))
    throw wrongArgument('idleTimeoutMs', idleTimeoutMs, 'a number of milliseconds above 0');
  if (!(Number.isInteger(maxRetries) && maxRetries >= 0 && maxRetries <= MOST_RETRIES))
    throw wrongArgument('maxRetries', maxRetries, `a whole number in 0…${MOST_RETRIES}`);
  const isTimed = idleTimeoutMs <= LONGEST_TIMER_MS;
  return {
    headers: namesAndValues(headers),
    credentials,
    idleTimeoutMs: isTimed ? idleTimeoutMs : Number.POSITIVE_INFINITY,
    maxRetries,
  };
}

/** Headers in any form that `fetch` takes, as an object. */
function namesAndValues(headers: HeadersInit): Record<string, string> {
  try {
    return Object.fromEntries(new Headers(headers));
  } catch {
    // The faulty value may be a secret, which the cause repeats.
    const message = 'headers must be names and values as HTTP allows them.';
    throw new InvalidArgumentError('headers', message);
  }
}
