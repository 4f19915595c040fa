import { SplatSourceError, WebSplatterError } from '../errors.ts';
import type { OpenedSource } from './splat-source.ts';

/** Bytes held at once, unless one item needs more: bounds both memory and the work between two pauses. */
const WINDOW_BYTES = 1 << 20;
/** Longest time a page's thread is kept busy before its event loop gets a turn. */
const MAX_BUSY_MS = 16;

const NO_BYTES = new Uint8Array(0);

/**
 * Shows a stream as a window of contiguous bytes that moves forward. Chunks are copied into the window, at most
 * `WINDOW_BYTES` at a time, so that items which straddle chunks need no special case and a huge chunk is never doubled.
 *
 * Rejects with the signal's reason once it aborts, and with `SplatSourceError` if the stream fails or yields anything
 * but bytes.
 */
export class ByteReader {
  /** The window's memory; valid from `start` on for `available` bytes, until the next `fill` or `skip`. */
  bytes: Uint8Array<ArrayBuffer> = new Uint8Array(WINDOW_BYTES);
  /** The same memory as `bytes`. */
  view = new DataView(this.bytes.buffer);
  /** Index in `bytes` of the next byte. */
  start = 0;

  readonly #name: string;
  readonly #signal: AbortSignal | undefined;
  readonly #reader: ReadableStreamDefaultReader<Uint8Array>;
  readonly #onAbort = () => this.#cancel(this.#signal?.reason);
  #end = 0;
  /** Offset in the file of `bytes[0]`. */
  #base = 0;
  /** The part of the last chunk that has not been copied yet. */
  #pending: Uint8Array = NO_BYTES;
  #lastPauseMs = performance.now();

  constructor(source: Pick<OpenedSource, 'name' | 'stream'>, signal?: AbortSignal) {
    this.#name = source.name;
    this.#signal = signal;
    signal?.throwIfAborted();
    if (source.stream.locked) throw lockedStreamError(source.name);
    this.#reader = source.stream.getReader();
    // Cancelling ends a pending read at once, even one on a stream that would never deliver.
    signal?.addEventListener('abort', this.#onAbort, { once: true });
  }

  /** Number of bytes in the window from `start` on. */
  get available(): number {
    return this.#end - this.start;
  }

  /** Offset in the file of the next byte. */
  get byteOffset(): number {
    return this.#base + this.start;
  }

  advance(byteCount: number): void {
    this.start += byteCount;
  }

  /** Makes at least `byteCount` bytes available; false if the stream ends first. */
  async fill(byteCount: number): Promise<boolean> {
    if (this.available >= byteCount) return true;
    this.#makeRoom(byteCount);
    while (this.available < byteCount) {
      if (this.#pending.length === 0 && !(await this.#readChunk())) return false;
      const part = this.#pending.subarray(0, this.bytes.length - this.#end);
      this.bytes.set(part, this.#end);
      this.#end += part.length;
      this.#pending = this.#pending.subarray(part.length);
    }
    await this.pause();
    return true;
  }

  /**
   * Fills `bytes` with what comes next, past the window; false if the stream ends first.
   *
   * @param onPart called when some have arrived.
   */
  async readInto(bytes: Uint8Array, onPart: () => void): Promise<boolean> {
    const held = Math.min(this.available, bytes.length);
    bytes.set(this.bytes.subarray(this.start, this.start + held));
    this.advance(held);
    onPart();
    for (let at = held; at < bytes.length; ) {
      if (this.#pending.length === 0 && !(await this.#readChunk())) return false;
      const part = this.#pending.subarray(0, bytes.length - at);
      bytes.set(part, at);
      at += part.length;
      this.#base += part.length;
      this.#pending = this.#pending.subarray(part.length);
      onPart();
      await this.pause();
    }
    return true;
  }

  /** Skips `byteCount` bytes without holding them; false if the stream ends first. */
  async skip(byteCount: number): Promise<boolean> {
    let left = byteCount;
    for (;;) {
      const step = Math.min(left, this.available);
      this.advance(step);
      left -= step;
      if (left === 0) return true;
      if (!(await this.fill(1))) return false;
    }
  }

  /** Gives the event loop a turn if it has waited long; throws if aborted. */
  async pause(): Promise<void> {
    this.#signal?.throwIfAborted();
    if (performance.now() - this.#lastPauseMs < MAX_BUSY_MS) return;
    await nextTask();
    this.#lastPauseMs = performance.now();
    this.#signal?.throwIfAborted();
  }

  /** A stream of everything from `start` on. Do not use this reader afterwards. */
  rest(): ReadableStream<Uint8Array> {
    const parts = [this.bytes.slice(this.start, this.#end), this.#pending].filter((part) => part.length > 0);
    return new ReadableStream<Uint8Array>(
      {
        pull: async (controller) => {
          const held = parts.shift();
          if (held) controller.enqueue(held);
          else if (await this.#readChunk()) controller.enqueue(this.#pending);
          else controller.close();
        },
        cancel: (reason) => this.#cancel(reason),
      },
      { highWaterMark: 0 },
    );
  }

  /** Releases the stream and cancels what has not been read. */
  close(): void {
    this.#cancel(undefined);
  }

  #cancel(reason: unknown): void {
    this.#signal?.removeEventListener('abort', this.#onAbort);
    // If the stream has failed already, this rejects with the error that the read has reported.
    this.#reader.cancel(reason).catch(() => {});
  }

  /** Moves the available bytes to the start of the window, so that `byteCount` bytes fit. */
  #makeRoom(byteCount: number): void {
    if (byteCount > this.bytes.length) {
      const larger = new Uint8Array(Math.max(byteCount, 2 * this.bytes.length));
      larger.set(this.bytes.subarray(this.start, this.#end));
      this.bytes = larger;
      this.view = new DataView(larger.buffer);
    } else if (this.start > 0) {
      // Only then: reading byte by byte must not move the whole window each time.
      this.bytes.copyWithin(0, this.start, this.#end);
    }
    this.#base += this.start;
    this.#end -= this.start;
    this.start = 0;
  }

  /** False at the end of the stream. */
  async #readChunk(): Promise<boolean> {
    for (;;) {
      this.#signal?.throwIfAborted();
      const chunk = await this.#read();
      this.#signal?.throwIfAborted();
      if (chunk === undefined) return false;
      if (!ArrayBuffer.isView(chunk) || !('subarray' in chunk) || chunk.BYTES_PER_ELEMENT !== 1) {
        throw new SplatSourceError(
          this.#name,
          `the stream gave ${describeChunk(chunk)}; it must give Uint8Array chunks`,
        );
      }
      this.#pending = chunk;
      if (chunk.length > 0) return true;
    }
  }

  async #read(): Promise<Uint8Array | undefined> {
    try {
      const { done, value } = await this.#reader.read();
      if (done) this.#signal?.removeEventListener('abort', this.#onAbort);
      return value;
    } catch (cause) {
      this.#signal?.removeEventListener('abort', this.#onAbort);
      this.#signal?.throwIfAborted();
      if (cause instanceof WebSplatterError) throw cause;
      throw new SplatSourceError(this.#name, `reading stopped: ${messageOf(cause)}`, undefined, { cause });
    }
  }
}

export function lockedStreamError(name: string): SplatSourceError {
  return new SplatSourceError(
    name,
    'the stream is locked: something else is reading it, or has read it. Pass a fresh stream, or the Blob or URL itself.',
  );
}

export function messageOf(cause: unknown): string {
  return cause instanceof Error ? cause.message : String(cause);
}

function describeChunk(chunk: unknown): string {
  return typeof chunk === 'object' && chunk !== null
    ? `a chunk of ${chunk.constructor?.name}`
    : `a ${typeof chunk}`;
}

/** Resolves in a new task. Uses a message, since timers are held back to 4 ms in pages and to 1 s in hidden ones. */
function nextTask(): Promise<void> {
  return new Promise((resolve) => {
    const { port1, port2 } = new MessageChannel();
    port1.onmessage = () => {
      port1.close();
      resolve();
    };
    port2.postMessage(null);
  });
}
