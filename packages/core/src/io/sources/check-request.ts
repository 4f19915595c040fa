import { InvalidArgumentError } from '../../data/errors.ts';
import { wrongArgument } from '../../data/given.ts';
import type { RequestOptions } from './splat-source.ts';

const CREDENTIALS: readonly unknown[] = ['omit', 'same-origin', 'include'];
/** More retries would look like an attack. */
const MOST_RETRIES = 100;
/** Timers that are set for longer fire at once. */
const LONGEST_TIMER_MS = 2 ** 31 - 1;

/** Returns the options with their defaults. @throws InvalidArgumentError for invalid ones. */
export function checkRequest(request: RequestOptions): Required<RequestOptions> {
  if (typeof request !== 'object' || request === null) refuse('request', request, 'an object of options');
  const { headers = {}, credentials = 'same-origin', idleTimeoutMs = 30_000, maxRetries = 4 } = request;
  if (!CREDENTIALS.includes(credentials)) refuse('credentials', credentials, CREDENTIALS.join(', '));
  if (!(typeof idleTimeoutMs === 'number' && idleTimeoutMs > 0))
    refuse('idleTimeoutMs', idleTimeoutMs, 'a number of milliseconds above 0');
  if (!(Number.isInteger(maxRetries) && maxRetries >= 0 && maxRetries <= MOST_RETRIES))
    refuse('maxRetries', maxRetries, `a whole number in 0…${MOST_RETRIES}`);
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

function refuse(argument: string, value: unknown, expected: string): never {
  throw wrongArgument(argument, value, `${expected}`);
}
