import { InvalidArgumentError } from '../errors.ts';
import { shown } from '../printable.ts';
import type { RequestOptions } from './splat-source.ts';

const CREDENTIALS: readonly unknown[] = ['omit', 'same-origin', 'include'];
/** More would be an attack. */
const MOST_RETRIES = 100;
/** Timers that are set for longer fire at once. */
const LONGEST_TIMER_MS = 2 ** 31 - 1;

/** Returns the options with their defaults. @throws InvalidArgumentError for invalid ones. */
export function checkRequest(request: RequestOptions): Required<RequestOptions> {
  const { headers = {}, credentials = 'same-origin', idleTimeoutMs = 30_000, maxRetries = 4 } = request;
  const refuse = (argument: string, value: unknown, expected: string): never => {
    throw new InvalidArgumentError(argument, `${argument} is ${shown(value)}; it must be ${expected}.`);
  };
  if (!CREDENTIALS.includes(credentials)) refuse('credentials', credentials, CREDENTIALS.join(', '));
  if (!(typeof idleTimeoutMs === 'number' && idleTimeoutMs > 0))
    refuse('idleTimeoutMs', idleTimeoutMs, 'a number of milliseconds above 0');
  if (!(Number.isInteger(maxRetries) && maxRetries >= 0 && maxRetries <= MOST_RETRIES))
    refuse('maxRetries', maxRetries, `a whole number in 0…${MOST_RETRIES}`);
  try {
    new Headers(headers);
  } catch (cause) {
    // The value may be a secret.
    const message = 'headers must be names and values as HTTP allows them.';
    throw Object.assign(new InvalidArgumentError('headers', message), { cause });
  }
  const isTimed = idleTimeoutMs <= LONGEST_TIMER_MS;
  return {
    headers,
    credentials,
    idleTimeoutMs: isTimed ? idleTimeoutMs : Number.POSITIVE_INFINITY,
    maxRetries,
  };
}
