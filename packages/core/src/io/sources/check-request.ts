import { InvalidArgumentError } from '../../data/errors.ts';
import { given, wrongArgument } from '../../data/given.ts';
import type { RequestOptions } from './splat-source.ts';

const CREDENTIALS: readonly unknown[] = ['omit', 'same-origin', 'include'];
/** More retries would resemble an attack. */
const MOST_RETRIES = 100;
/** Longer timeouts overflow, and the timer fires at once. */
const LONGEST_TIMER_MS = 2 ** 31 - 1;

/** Returns the options with defaults. @throws InvalidArgumentError if an option is invalid. */
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

/** Converts headers in any form accepted by `fetch` to an object. */
function namesAndValues(headers: HeadersInit): Record<string, string> {
  try {
    return Object.fromEntries(new Headers(headers));
  } catch {
    // The invalid value may be a secret, and the cause quotes it.
    const message = 'headers must be names and values as HTTP allows them.';
    throw new InvalidArgumentError('headers', message);
  }
}
