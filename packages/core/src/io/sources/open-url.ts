import { InvalidArgumentError, SplatSourceError } from '../../data/errors.ts';
import { given, wrongArgument } from '../../data/given.ts';
import { messageOf } from './byte-reader.ts';
import { baseUrl, shortName } from './known-source.ts';
import type { OpenedSource, ReadOptions, RequestOptions, ResumedStream } from './splat-source.ts';
import { waitMs } from './wait-ms.ts';

const FIRST_WAIT_MS = 500;
/** A longer Retry-After fails at once. */
const LONGEST_WAIT_MS = 30_000;
/**
 * Transient HTTP statuses: timeout, too early, too many requests, gateway errors. All others are
 * permanent.
 */
const PASSING_STATUSES: readonly number[] = [408, 425, 429, 502, 503, 504];
/**
 * Attempts before any server has responded. Pages cannot distinguish a CORS refusal or an unknown
 * host from a lost connection, and that message should appear quickly.
 */
const UNANSWERED_TRIES = 2;

const ABSOLUTE_ADVICE =
  'cannot be fetched: outside a page only absolute http, https, data and blob URLs can be; read a local file yourself and pass its Blob or bytes';

/**
 * Opens a URL. Requests with a transient failure are retried. A broken transfer is resumed, if the
 * server can prove that the file is unchanged. Pages may be unable to read Content-Range and
 * Content-Encoding of another origin; the transfer then restarts from the first byte.
 *
 * Rejects with SplatSourceError (invalid URL, credentials in it, network, HTTP status),
 * InvalidArgumentError for invalid options, and the signal's reason.
 */
export async function openUrl(url: string, options: ReadOptions): Promise<OpenedSource> {
  const { name = shortName(url), signal, request = {} } = options;
  const checked = checkRequest(request);
  return new Transfer(addressOf(url, name), name, checked, signal).open();
}

/** @throws SplatSourceError, because the error of `fetch` would quote a URL with credentials. */
export function addressOf(url: string, name: string): URL {
  const base = baseUrl();
  if (!URL.canParse(url, base))
    throw new SplatSourceError(name, base === undefined ? ABSOLUTE_ADVICE : 'it is no valid address');
  const address = new URL(url, base);
  if (address.username === '' && address.password === '') return address;
  throw new SplatSourceError(
    name,
    'an address with credentials cannot be fetched; leave them out, and pass them in request.headers, as Authorization',
  );
}

/** Requests for one file, which share a budget of retries. */
export class Transfer {
  readonly #url: URL;
  readonly #name: string;
  readonly #request: Required<RequestOptions>;
  readonly #signal: AbortSignal | undefined;
  #retries = 0;
  #hasAnswered: boolean;
  /** Facts about the file from the first response; null before. */
  #file: FileFacts | null = null;

  /** @param hasAnswered whether the server has responded to other requests. */
  constructor(
    url: URL,
    name: string,
    request: Required<RequestOptions>,
    signal: AbortSignal | undefined,
    hasAnswered = false,
  ) {
    this.#url = url;
    this.#name = name;
    this.#request = request;
    this.#signal = signal;
    this.#hasAnswered = hasAnswered;
  }

  async open(): Promise<OpenedSource> {
    return this.openAnswer(await this.ask({}));
  }

  /** Opens a response that has the whole file. */
  openAnswer(response: Response): OpenedSource {
    const { headers } = response;
    const totalBytesCertain = response.type !== 'cors';
    this.#file = { ...factsOf(headers), hasRanges: totalBytesCertain };
    const { totalBytes } = this.#file;
    return {
      name: this.#name,
      totalBytes,
      totalBytesCertain,
      // The browser already has the bytes of a blob: URL.
      isLocal: !this.isRemote && totalBytesCertain && totalBytes !== undefined,
      sentBytes: lengthOf(headers),
      stream: bodyOf(response),
      idleTimeoutMs: this.#request.idleTimeoutMs,
      resume: this.isRemote ? (offset, failure) => this.#resume(offset, failure) : undefined,
      ...(this.isRemote && {
        fetched: { url: response.url || this.#url.href, request: this.#request },
        fileName: dispositionName(headers.get('content-disposition') ?? ''),
      }),
    };
  }

  /** See `ResumeSource`. */
  async #resume(offset: number, failure: SplatSourceError): Promise<ResumedStream> {
    const { validator, totalBytes, hasRanges } = this.#file!;
    if (validator === null) throw failure;
    await this.waitAfter(failure);
    const response = await this.#askAgain(
      hasRanges ? { range: `bytes=${offset}-`, 'if-range': validator } : {},
      failure,
    );
    const isPart = response.status === 206;
    const now = isPart ? rangeOf(response.headers) : { ...factsOf(response.headers), startsAt: 0 };
    const { startsAt } = now;
    const isSame =
      now.validator === validator &&
      (now.totalBytes === undefined || totalBytes === undefined || now.totalBytes === totalBytes);
    if (isSame && startsAt === (isPart ? offset : 0)) return { stream: bodyOf(response), startsAt };
    cancelBody(response);
    const whyNot =
      startsAt === null ? 'the server does not say which part it sent' : 'the server sent another part of it';
    throw new SplatSourceError(
      this.#name,
      `the transfer broke off after ${offset} bytes, and ${isSame ? whyNot : 'the file may have changed meanwhile'}. Load it again.`,
      undefined,
      { cause: failure },
    );
  }

  /** Sends a request. Rejects with `failure`, the more specific error, if there is no response. */
  async #askAgain(headers: Readonly<Record<string, string>>, failure: SplatSourceError): Promise<Response> {
    try {
      return await this.ask(headers);
    } catch (error) {
      this.#signal?.throwIfAborted();
      throw (error as SplatSourceError).status === undefined ? failure : error;
    }
  }

  /**
   * Sends the request until a response has a readable body. Rejects with SplatSourceError, and the
   * signal's reason.
   */
  async ask(headers: Readonly<Record<string, string>>): Promise<Response> {
    for (;;) {
      const answer = await this.#fetch(headers);
      if (answer instanceof SplatSourceError) {
        const isUnanswered = !this.#hasAnswered && this.#retries + 1 >= UNANSWERED_TRIES;
        if (isUnanswered || !this.isRemote) throw answer;
        await this.waitAfter(answer);
        continue;
      }
      this.#hasAnswered = true;
      if (answer.ok) return answer;
      cancelBody(answer);
      const { status, statusText } = answer;
      const reason = statusText === '' ? '' : ` ${statusText}`;
      const failure = new SplatSourceError(this.#name, `the server answered ${status}${reason}`, status);
      if (!PASSING_STATUSES.includes(status)) throw failure;
      await this.waitAfter(failure, askedWaitMs(answer.headers));
    }
  }

  /** Sends the request once. Returns an error if there is no response; throws the signal's reason. */
  async #fetch(headers: Readonly<Record<string, string>>): Promise<Response | SplatSourceError> {
    const { headers: own, credentials, idleTimeoutMs } = this.#request;
    const late = new AbortController();
    const timer = Number.isFinite(idleTimeoutMs) ? setTimeout(() => late.abort(), idleTimeoutMs) : undefined;
    const signals = this.#signal ? [this.#signal, late.signal] : [late.signal];
    try {
      return await fetch(this.#url.href, {
        headers: { ...own, ...headers },
        credentials,
        // Browsers strip only Authorization from redirects to another origin.
        redirect: this.#hasOwnHeaders ? 'error' : 'follow',
        signal: AbortSignal.any(signals),
      });
    } catch (cause) {
      this.#signal?.throwIfAborted();
      const why = late.signal.aborted
        ? `the server did not answer within ${idleTimeoutMs} ms`
        : this.#explain(cause);
      return new SplatSourceError(this.#name, why, undefined, { cause });
    } finally {
      clearTimeout(timer);
    }
  }

  /** Waits before a retry, at least `askedMs` milliseconds. Throws `failure` if no retry is left. */
  async waitAfter(failure: SplatSourceError, askedMs = 0): Promise<void> {
    if (this.#retries >= this.#request.maxRetries || askedMs > LONGEST_WAIT_MS) throw failure;
    // Jitter, so that clients refused together do not return together.
    const backoffMs = FIRST_WAIT_MS * 2 ** this.#retries * (0.5 + Math.random() / 2);
    this.#retries++;
    await waitMs(Math.min(Math.max(backoffMs, askedMs), LONGEST_WAIT_MS), this.#signal);
  }

  get #hasOwnHeaders(): boolean {
    return Object.keys(this.#request.headers).length > 0;
  }

  /** Whether a retry makes sense: the URL is on a server. */
  get isRemote(): boolean {
    return /^https?:$/.test(this.#url.protocol);
  }

  #explain(cause: unknown): string {
    if (typeof document === 'undefined' && this.#url.protocol === 'file:') return ABSOLUTE_ADVICE;
    // Node reports only "fetch failed"; the reason is the cause of the cause.
    const reason = cause instanceof Error && cause.cause instanceof Error ? cause.cause : cause;
    const redirected = this.#hasOwnHeaders
      ? ', or a redirect, which requests with headers do not follow'
      : '';
    return `cannot be fetched: ${messageOf(reason)} (offline, blocked by CORS, or no such host${redirected}?)`;
  }
}

/** Facts about the whole file from a response. */
interface AnswerFacts {
  /** Strong validator for conditional requests; null if there is none, and for compressed files. */
  readonly validator: string | null;
  /** File size in bytes; undefined if not stated, and for compressed files. */
  readonly totalBytes: number | undefined;
}

/** Facts from a partial response. */
export interface RangeFacts extends AnswerFacts {
  /** First byte of the range; null if not stated. */
  readonly startsAt: number | null;
}

interface FileFacts extends AnswerFacts {
  /** Whether a partial response states its range. */
  readonly hasRanges: boolean;
}

function factsOf(headers: Headers): AnswerFacts {
  if (isPacked(headers)) return { validator: null, totalBytes: undefined };
  return { validator: validatorOf(headers), totalBytes: lengthOf(headers) };
}

export function rangeOf(headers: Headers): RangeFacts {
  const [, start, total] = /^bytes (\d+)-\d+\/(\d+|\*)$/.exec(headers.get('content-range') ?? '') ?? [];
  const totalBytes = total === undefined || total === '*' ? undefined : Number(total);
  return { ...factsOf(headers), totalBytes, startsAt: start === undefined ? null : Number(start) };
}

function validatorOf(headers: Headers): string | null {
  const tag = headers.get('etag');
  // Weak tags may be equal for files that differ in some bytes.
  return tag !== null && !tag.startsWith('W/') ? tag : headers.get('last-modified');
}

/** An HTTP date. `Date.parse` alone also accepts other text, such as `-99999` for the year 99999. */
const HTTP_DATE = /^[A-Z][a-z]+, \d\d[ -][A-Z][a-z]{2}[ -]\d{2,4} [\d:]{8} GMT$/;

/** Milliseconds of Retry-After; 0 if absent. */
function askedWaitMs(headers: Headers): number {
  const asked = headers.get('retry-after') ?? '0';
  if (/^\d+$/.test(asked)) return 1000 * Number(asked);
  const waitMs = HTTP_DATE.test(asked) ? Date.parse(asked) - Date.now() : 0;
  return waitMs > 0 ? waitMs : 0;
}

export function isPacked(headers: Headers): boolean {
  return (headers.get('content-encoding') ?? 'identity') !== 'identity';
}

function lengthOf(headers: Headers): number | undefined {
  const length = headers.get('content-length');
  return length !== null && /^\d+$/.test(length) ? Number(length) : undefined;
}

export function bodyOf(response: Response): ReadableStream<Uint8Array> {
  return response.body ?? new Blob([]).stream();
}

export function cancelBody(response: Response): void {
  // Nobody reads the body, so its errors do not matter.
  response.body?.cancel().catch(() => {});
}

/** A header parameter: its name, and its value with or without quotes. */
const PARAMETER = /;\s*([\w!#$%&'*+.^`|~-]+)\s*=\s*(?:"((?:[^"\\]|\\.)*)"|([^;]*))/gs;
/** An extended value with a character set (RFC 8187). */
const EXTENDED = /^(utf-8|iso-8859-1)'[^']*'(.*)$/is;

/**
 * File name in a Content-Disposition (RFC 6266): `filename*`, else `filename`; undefined if there
 * is none. As with any name from a server, only its extension is trustworthy.
 */
export function dispositionName(header: string): string | undefined {
  let plain: string | undefined;
  for (const [, name, quoted, token = ''] of header.matchAll(PARAMETER)) {
    const value = quoted?.replace(/\\(.)/gs, '$1') ?? token.trim();
    if (name.toLowerCase() === 'filename') plain ??= value;
    if (name.toLowerCase() !== 'filename*') continue;
    const extended = decodedValue(value);
    if (extended !== undefined) return extended;
  }
  return plain;
}

/** Undefined if the value is malformed. */
function decodedValue(value: string): string | undefined {
  const [, charset, text] = EXTENDED.exec(value) ?? [];
  if (charset === undefined) return undefined;
  const octet = (_: string, digits: string) => String.fromCharCode(Number.parseInt(digits, 16));
  if (charset.toLowerCase() !== 'utf-8') return text.replace(/%([\da-f]{2})/gi, octet);
  try {
    return decodeURIComponent(text);
  } catch {
    // A name that is no valid UTF-8 is as good as none.
    return undefined;
  }
}

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
