import { createReadStream } from 'node:fs';
import { stat } from 'node:fs/promises';
import type { IncomingMessage, ServerResponse } from 'node:http';
import { Transform } from 'node:stream';
import { pipeline } from 'node:stream/promises';
import { setTimeout as wait } from 'node:timers/promises';

/** Pieces in which a line of a limited rate sends. */
const PIECE_BYTES = 64 << 10;

interface LineOptions {
  /** Of all answers together; Infinity without a limit. */
  readonly bitsPerSecond: number;
  /** Between a request and its answer. */
  readonly latencyMs: number;
}

/** Sends files, whole or by ranges, at a line's rate, and notes the bytes and time of each piece. */
export class SceneLine {
  readonly #options: LineOptions;
  /** When all that it was given so far will have been sent, ms since 1970. */
  #freeAtMs = 0;
  #sent: { readonly atMs: number; readonly bytes: number }[] = [];
  #requests = 0;

  constructor(options: LineOptions) {
    this.#options = options;
  }

  /** Since {@link restart}. */
  get requests(): number {
    return this.#requests;
  }

  /** Bytes sent since {@link restart} and up to `atMs` since 1970. */
  bytesUntil(atMs = Number.POSITIVE_INFINITY): number {
    return this.#sent.reduce((sum, sent) => sum + (sent.atMs <= atMs ? sent.bytes : 0), 0);
  }

  restart(): void {
    this.#sent = [];
    this.#requests = 0;
  }

  /** Answers a request for a file; 404 where there is none. */
  async answer(file: string, { headers, method }: IncomingMessage, response: ServerResponse): Promise<void> {
    this.#requests++;
    // A missing file is answered by 404 below.
    const facts = await stat(file).catch(() => null);
    await wait(this.#options.latencyMs);
    if (!facts?.isFile()) return void response.writeHead(404).end();
    const { size, mtimeMs } = facts;
    const [, from, to] = /^bytes=(\d*)-(\d*)$/.exec(headers.range ?? '') ?? [];
    const start = from ? Number(from) : to ? Math.max(0, size - Number(to)) : 0;
    const end = from && to ? Math.min(Number(to), size - 1) : size - 1;
    if (start > end) return void response.writeHead(416, { 'content-range': `bytes */${size}` }).end();
    const isRange = Boolean(from || to);
    response.writeHead(isRange ? 206 : 200, {
      'accept-ranges': 'bytes',
      'content-length': end - start + 1,
      etag: `"${size.toString(36)}-${Math.round(mtimeMs).toString(36)}"`,
      ...(isRange && { 'content-range': `bytes ${start}-${end}/${size}` }),
    });
    if (method === 'HEAD') return void response.end();
    const bytes = createReadStream(file, { start, end, highWaterMark: PIECE_BYTES });
    // Pages may end a request in the middle.
    await pipeline(bytes, this.#line(), response).catch(() => {});
  }

  #line(): Transform {
    return new Transform({
      transform: async (piece: Buffer, _encoding, done) => {
        const tookMs = (8000 * piece.length) / this.#options.bitsPerSecond;
        const nowMs = Date.now();
        this.#freeAtMs = Math.max(nowMs, this.#freeAtMs) + tookMs;
        if (this.#freeAtMs > nowMs) await wait(this.#freeAtMs - nowMs);
        this.#sent.push({ atMs: performance.timeOrigin + performance.now(), bytes: piece.length });
        done(null, piece);
      },
    });
  }
}
