import { SplatSourceError } from '../../data/errors.ts';
import { messageOf } from './byte-reader.ts';
import { checkRequest } from './check-request.ts';
import { baseUrl, shortName } from './source-kind.ts';
import type { OpenedSource, ReadOptions, RequestOptions, ResumedStream } from './splat-source.ts';
import { waitMs } from './wait-ms.ts';

const FIRST_WAIT_MS = 500;
/** A server that wants a longer pause would keep the reader waiting too long. */
const LONGEST_WAIT_MS = 30_000;
/** Too early, too many requests, or a gateway without a server behind it. Other failures last. */
const PASSING_STATUSES: readonly number[] = [408, 425, 429, 502, 503, 504];
/**
 * Tries until a server has answered at all. Pages cannot tell a refusal by CORS or a host that does
 * not exist from a lost connection, and a person should not wait long for that message.
 */
const UNANSWERED_TRIES = 2;

const ABSOLUTE_ADVICE =
  'cannot be fetched: outside a page only absolute http, https, data and blob URLs can be; read a local file yourself and pass its Blob or bytes';

/**
 * Opens an address. Requests that a server cannot answer for the moment are repeated, and a
 * transfer that breaks off goes on where it was, if the server can tell that the file is still the
 * same. A page is not told which part another origin sends, nor whether that is packed; the file is
 * asked for from its beginning then.
 *
 * Rejects with SplatSourceError (no valid address, credentials in it, network, HTTP status),
 * InvalidArgumentError for options, and the signal's reason.
 */
export async function openUrl(url: string, options: ReadOptions): Promise<OpenedSource> {
  const { name = shortName(url), signal, request = {} } = options;
  const checked = checkRequest(request);
  return new Transfer(addressOf(url, name), name, checked, signal).open();
}

/** @throws SplatSourceError; the error of `fetch` would repeat the address with credentials. */
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

/** Requests of one file, with the number of tries that they share. */
export class Transfer {
  readonly #url: URL;
  readonly #name: string;
  readonly #request: Required<RequestOptions>;
  readonly #signal: AbortSignal | undefined;
  #retries = 0;
  #hasAnswered: boolean;
  /** Facts about the file from the first answer; null before. */
  #file: FileFacts | null = null;

  /** @param hasAnswered whether the server has, to other requests. */
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

  /** Opens an answer that has the whole file. */
  openAnswer(response: Response): OpenedSource {
    const { headers } = response;
    const totalBytesCertain = response.type !== 'cors';
    this.#file = { ...factsOf(headers), hasRanges: totalBytesCertain };
    const { totalBytes } = this.#file;
    return {
      name: this.#name,
      totalBytes,
      totalBytesCertain,
      // The bytes of a Blob's address are the browser's already.
      isHeld: !this.isRemote && totalBytesCertain && totalBytes !== undefined,
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
    const now = isPart ? partOf(response.headers) : { ...factsOf(response.headers), startsAt: 0 };
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

  /** Rejects with `failure`, which says more, if there is no answer. */
  async #askAgain(headers: Readonly<Record<string, string>>, failure: SplatSourceError): Promise<Response> {
    try {
      return await this.ask(headers);
    } catch (error) {
      this.#signal?.throwIfAborted();
      throw (error as SplatSourceError).status === undefined ? failure : error;
    }
  }

  /**
   * Sends the request until there is an answer that has a body to read. Rejects with
   * SplatSourceError, and the signal's reason.
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

  /** Sends the request. Returns a failure if there is no answer; throws the signal's reason. */
  async #fetch(headers: Readonly<Record<string, string>>): Promise<Response | SplatSourceError> {
    const { headers: own, credentials, idleTimeoutMs } = this.#request;
    const late = new AbortController();
    const timer = Number.isFinite(idleTimeoutMs) ? setTimeout(() => late.abort(), idleTimeoutMs) : undefined;
    const signals = this.#signal ? [this.#signal, late.signal] : [late.signal];
    try {
      return await fetch(this.#url.href, {
        headers: { ...own, ...headers },
        credentials,
        // Of all headers, browsers keep only Authorization from another origin.
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

  /** Waits before another try, at least as long as asked. Throws `failure` if no try is left. */
  async waitAfter(failure: SplatSourceError, askedMs = 0): Promise<void> {
    if (this.#retries >= this.#request.maxRetries || askedMs > LONGEST_WAIT_MS) throw failure;
    // Spread out, so that clients refused together do not return together.
    const backoffMs = FIRST_WAIT_MS * 2 ** this.#retries * (0.5 + Math.random() / 2);
    this.#retries++;
    await waitMs(Math.min(Math.max(backoffMs, askedMs), LONGEST_WAIT_MS), this.#signal);
  }

  get #hasOwnHeaders(): boolean {
    return Object.keys(this.#request.headers).length > 0;
  }

  /** Whether a server may be asked again. */
  get isRemote(): boolean {
    return /^https?:$/.test(this.#url.protocol);
  }

  #explain(cause: unknown): string {
    if (typeof document === 'undefined' && this.#url.protocol === 'file:') return ABSOLUTE_ADVICE;
    // Node says only "fetch failed", with the reason one level down.
    const reason = cause instanceof Error && cause.cause instanceof Error ? cause.cause : cause;
    const redirected = this.#hasOwnHeaders
      ? ', or a redirect, which requests with headers do not follow'
      : '';
    return `cannot be fetched: ${messageOf(reason)} (offline, blocked by CORS, or no such host${redirected}?)`;
  }
}

/** Facts about the whole file from an answer. */
interface AnswerFacts {
  /** Proof that the file is still the same; null without, and for packed files. */
  readonly validator: string | null;
  /** Undefined if it does not say, and for packed files. */
  readonly totalBytes: number | undefined;
}

/** Facts from an answer with a part of a file. */
export interface PartFacts extends AnswerFacts {
  /** Where it begins; null if the answer does not say. */
  readonly startsAt: number | null;
}

interface FileFacts extends AnswerFacts {
  /** Whether an answer with a part says which one that is. */
  readonly hasRanges: boolean;
}

function factsOf(headers: Headers): AnswerFacts {
  if (isPacked(headers)) return { validator: null, totalBytes: undefined };
  return { validator: validatorOf(headers), totalBytes: lengthOf(headers) };
}

export function partOf(headers: Headers): PartFacts {
  const [, start, total] = /^bytes (\d+)-\d+\/(\d+|\*)$/.exec(headers.get('content-range') ?? '') ?? [];
  const totalBytes = total === undefined || total === '*' ? undefined : Number(total);
  return { ...factsOf(headers), totalBytes, startsAt: start === undefined ? null : Number(start) };
}

function validatorOf(headers: Headers): string | null {
  const tag = headers.get('etag');
  // Weak tags are equal for files that differ in some bytes.
  return tag !== null && !tag.startsWith('W/') ? tag : headers.get('last-modified');
}

/** A date as HTTP has it: `Date.parse` takes other text, too, as `-99999` for the year 99999. */
const HTTP_DATE = /^[A-Z][a-z]+, \d\d[ -][A-Z][a-z]{2}[ -]\d{2,4} [\d:]{8} GMT$/;

/** Milliseconds that a server wants to be left alone; 0 if it does not say. */
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
  response.body?.cancel().catch(() => {});
}

/** A parameter of a header: its name, and its value in quotes or without. */
const PARAMETER = /;\s*([\w!#$%&'*+.^`|~-]+)\s*=\s*(?:"((?:[^"\\]|\\.)*)"|([^;]*))/gs;
/** A value with its character set (RFC 8187). */
const EXTENDED = /^(utf-8|iso-8859-1)'[^']*'(.*)$/is;

/**
 * The name that a Content-Disposition gives a file (RFC 6266): its `filename*`, else its
 * `filename`; undefined if it gives none. Only its end is to be trusted, as of any name from a server.
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

/** Undefined if the value cannot be decoded. */
function decodedValue(value: string): string | undefined {
  const [, charset, text] = EXTENDED.exec(value) ?? [];
  if (charset === undefined) return undefined;
  const octet = (_: string, digits: string) => String.fromCharCode(Number.parseInt(digits, 16));
  if (charset.toLowerCase() !== 'utf-8') return text.replace(/%([\da-f]{2})/gi, octet);
  try {
    return decodeURIComponent(text);
  } catch {
    return undefined;
  }
}
