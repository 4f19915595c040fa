import { SplatFileError, SplatSourceError, WebSplatterError } from '../../data/errors.ts';
import { onAbort } from '../../data/on-abort.ts';
import { shown } from '../../data/printable.ts';
import { Turns } from '../../data/turns.ts';
import type { OpenedSource, ResumeSource } from './splat-source.ts';

type ReaderSource = Pick<OpenedSource, 'name' | 'stream' | 'idleTimeoutMs' | 'resume'>;

type Reader =
  | { readonly kind: 'into'; readonly reader: ReadableStreamBYOBReader }
  | { readonly kind: 'chunks'; readonly reader: ReadableStreamDefaultReader<Uint8Array> };

/** Most bytes of the window, unless an item needs more: bounds memory and the work between pauses. */
const WINDOW_BYTES = 1 << 20;
/** Most bytes per read that is copied into the window. */
const CHUNK_BYTES = 1 << 18;
/** A server that sends less than this per timeout counts as stalled: it could hold a reader for days. */
const LEAST_BYTES_IN_TIME = 1 << 14;

const NO_BYTES: Uint8Array<ArrayBuffer> = new Uint8Array(0);

/**
 * Exposes a stream as a window of contiguous bytes that moves forward. Chunks are copied into the
 * window, at most `WINDOW_BYTES` at a time. Items that straddle chunks therefore need no special
 * case, and a huge chunk is never duplicated.
 *
 * A stream that fails or stalls is resumed if its source supports it.
 *
 * Rejects with the signal's reason once it aborts. Rejects with `SplatSourceError` if the stream
 * fails for good or yields anything but bytes, and with `SplatFileError` 'too-large' beyond
 * `maxBytes`.
 */
export class ByteReader {
  /**
   * The window's memory, valid for `available` bytes from `start` until a `fill` or `skip`. It grows with what
   * arrives, so that small sources take little.
   */
  bytes: Uint8Array<ArrayBuffer> = NO_BYTES;
  /** A view of the same memory as `bytes`. */
  view = new DataView(this.bytes.buffer);
  /** Index in `bytes` of the next byte. */
  start = 0;
  /** Source name for messages. */
  readonly name: string;

  readonly #signal: AbortSignal | undefined;
  readonly #maxBytes: number;
  readonly #idleTimeoutMs: number;
  readonly #resumeSource: ResumeSource | undefined;
  #reader: Reader;
  /** Bytes at the beginning of a resumed stream to discard, because they were read before. */
  #toDrop = 0;
  /** Waiting time in milliseconds, and bytes received, in the current stall-detection interval. */
  #waitedMs = 0;
  #cameBytes = 0;
  #ignoreSignal: () => void;
  #end = 0;
  /** Offset in the file of `bytes[0]`. */
  #base = 0;
  /** The part of the last chunk that is not yet copied to the window. */
  #pending: Uint8Array = NO_BYTES;
  /** Buffer for the next read of a byte stream. */
  #chunkMemory = new ArrayBuffer(0);
  readonly #turns: Turns;
  /** When reading began, by `performance.now()`. */
  readonly openedMs = performance.now();
  #isHandedOn = false;

  constructor(source: ReaderSource, signal?: AbortSignal, maxBytes = Number.POSITIVE_INFINITY) {
    this.name = source.name;
    this.#signal = signal;
    this.#turns = new Turns(signal);
    this.#maxBytes = maxBytes;
    this.#idleTimeoutMs = source.idleTimeoutMs ?? Number.POSITIVE_INFINITY;
    this.#resumeSource = source.resume;
    signal?.throwIfAborted();
    if (source.stream.locked) throw lockedStreamError(source.name);
    this.#reader = readerOf(source.stream);
    // Cancelling ends a pending read at once, even on a stream that never delivers.
    this.#ignoreSignal = onAbort(signal, () => this.#cancel(signal?.reason));
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

  /** Waits until at least `byteCount` bytes are available; false if the stream ends first. */
  async fill(byteCount: number): Promise<boolean> {
    if (this.available >= byteCount) return true;
    this.#moveToStart();
    while (this.available < byteCount) {
      if (this.#pending.length === 0 && !(await this.#readChunk())) return false;
      this.#growWindow(Math.max(byteCount, Math.min(this.#end + this.#pending.length, WINDOW_BYTES)));
      const part = this.#pending.subarray(0, this.bytes.length - this.#end);
      this.bytes.set(part, this.#end);
      this.#end += part.length;
      this.#pending = this.#pending.subarray(part.length);
      await this.pause();
    }
    return true;
  }

  /**
   * Fills `bytes` with the next bytes of the stream, bypassing the window; null if the stream ends
   * first.
   *
   * @param mayDetach whether `bytes` may be transferred to another buffer of the same size, which
   *   byte streams do.
   * @param onPart called when some bytes have arrived.
   * @returns `bytes`, or the view of the buffer to which it was transferred.
   */
  async readInto(
    bytes: Uint8Array<ArrayBuffer>,
    mayDetach: boolean,
    onPart: () => void,
  ): Promise<Uint8Array<ArrayBuffer> | null> {
    const { byteOffset, length } = bytes;
    const startOffset = this.byteOffset;
    let target = bytes;
    let detaches = mayDetach;
    let at = 0;
    const onMore = (byteCount: number) => {
      at += byteCount;
      onPart();
    };
    const held = Math.min(this.available, length);
    target.set(this.bytes.subarray(this.start, this.start + held));
    this.advance(held);
    onMore(held);
    while (at < length) {
      if (this.#pending.length === 0 && detaches && this.#reader.kind === 'into' && this.#toDrop === 0) {
        const memoryBytes = target.buffer.byteLength;
        const read = await this.#readByReader(new Uint8Array(target.buffer, byteOffset + at, length - at));
        if (read === undefined) return null;
        if (read instanceof SplatSourceError) {
          // The memory and its bytes were lost with the stream. Retries do not detach.
          detaches = false;
          await this.#resume(startOffset, read);
          target = new Uint8Array(new ArrayBuffer(memoryBytes), byteOffset, length);
          this.#base = startOffset - this.#end;
          at = 0;
          continue;
        }
        target = new Uint8Array(read.buffer as ArrayBuffer, byteOffset, length);
        this.#base += read.length;
        onMore(read.length);
      } else {
        if (this.#pending.length === 0 && !(await this.#readChunk())) return null;
        const part = this.#pending.subarray(0, length - at);
        target.set(part, at);
        this.#base += part.length;
        this.#pending = this.#pending.subarray(part.length);
        onMore(part.length);
      }
      await this.pause();
    }
    return target;
  }

  /** The next `byteCount` bytes, or all bytes left, without consuming them. */
  async peek(byteCount: number): Promise<Uint8Array<ArrayBuffer>> {
    await this.fill(byteCount);
    return this.bytes.subarray(this.start, this.start + Math.min(byteCount, this.available));
  }

  /** Skips `byteCount` bytes without storing them; false if the stream ends first. */
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

  /** Yields to the event loop if the last yield was long ago; throws if aborted. */
  pause(): Promise<void> {
    return this.#turns.give();
  }

  /** The unread bytes as a stream of its own. This reader must not be used afterwards. */
  rest(): ReadableStream<Uint8Array<ArrayBuffer>> {
    this.#isHandedOn = true;
    return new ReadableStream(
      {
        pull: async (controller) => {
          if (!(await this.fill(1))) return controller.close();
          controller.enqueue(this.bytes.slice(this.start, this.#end));
          this.advance(this.available);
        },
        cancel: (reason) => this.#cancel(reason),
      },
      { highWaterMark: 0 },
    );
  }

  /** Releases the stream and cancels its unread rest, unless `rest` has passed it on. */
  close(): void {
    if (!this.#isHandedOn) this.#cancel(undefined);
  }

  #cancel(reason: unknown): void {
    this.#ignoreSignal();
    // If the stream has failed, this rejects with the error that the read has already reported.
    this.#reader.reader.cancel(reason).catch(() => {});
  }

  /** Moves the available bytes to the start of the window. */
  #moveToStart(): void {
    // Only if necessary: small reads must not move the whole window each time.
    if (this.start > 0) this.bytes.copyWithin(0, this.start, this.#end);
    this.#base += this.start;
    this.#end -= this.start;
    this.start = 0;
  }

  /** Makes the window at least this large. */
  #growWindow(byteCount: number): void {
    if (byteCount <= this.bytes.length) return;
    // Twice as large also beyond the usual size: items may grow byte by byte.
    const roomy = Math.max(byteCount, 2 * this.bytes.length);
    const larger = new Uint8Array(byteCount > WINDOW_BYTES ? roomy : Math.min(roomy, WINDOW_BYTES));
    larger.set(this.bytes.subarray(0, this.#end));
    this.bytes = larger;
    this.view = new DataView(larger.buffer);
  }

  /** Returns false at the end of the stream. */
  async #readChunk(): Promise<boolean> {
    for (;;) {
      const offset = this.#base + this.#end;
      const chunk = await this.#readByReader();
      if (chunk === undefined) return false;
      if (chunk instanceof SplatSourceError) {
        await this.#resume(offset, chunk);
        continue;
      }
      if (!ArrayBuffer.isView(chunk) || !('subarray' in chunk) || chunk.BYTES_PER_ELEMENT !== 1) {
        throw new SplatSourceError(
          this.name,
          `the stream gave ${describeChunk(chunk)}; it must give Uint8Array chunks`,
        );
      }
      const dropped = Math.min(this.#toDrop, chunk.length);
      this.#toDrop -= dropped;
      this.#pending = chunk.subarray(dropped);
      if (this.#reader.kind === 'into') this.#chunkMemory = chunk.buffer as ArrayBuffer;
      if (this.#pending.length > 0) return true;
      // A stream may yield empty chunks for ever without a task in between.
      await this.pause();
    }
  }

  /** Resumes at byte `offset` after the stream has failed. */
  async #resume(offset: number, failure: SplatSourceError): Promise<void> {
    if (!this.#resumeSource) throw failure;
    const { stream, startsAt } = await this.#resumeSource(offset, failure);
    this.#reader = readerOf(stream);
    this.#toDrop = offset - startsAt;
    this.#waitedMs = 0;
    this.#cameBytes = 0;
    this.#ignoreSignal = onAbort(this.#signal, () => this.#cancel(this.#signal?.reason));
    if (this.#signal?.aborted) this.#cancel(this.#signal.reason);
  }

  /** Reads some bytes, into `target` if possible; undefined at the end, an error if the read failed. */
  async #readByReader(target?: Uint8Array<ArrayBuffer>): Promise<Uint8Array | SplatSourceError | undefined> {
    this.#signal?.throwIfAborted();
    const startMs = performance.now();
    const timeLeftMs = this.#idleTimeoutMs - this.#waitedMs;
    let isLate = false;
    const onLate = () => {
      isLate = true;
      // The read that waits reports the time-out.
      this.#reader.reader.cancel().catch(() => {});
    };
    const timer = Number.isFinite(timeLeftMs) ? setTimeout(onLate, timeLeftMs) : undefined;
    try {
      const { done, value } = await this.#readSome(target);
      if (done) this.#ignoreSignal();
      this.#signal?.throwIfAborted();
      if (isLate) {
        const late = `the server sent less than ${LEAST_BYTES_IN_TIME} bytes in ${this.#idleTimeoutMs} ms`;
        return new SplatSourceError(this.name, `reading stopped: ${late}`);
      }
      if (!done) this.#noteArrival(value?.byteLength ?? 0, performance.now() - startMs);
      return done ? undefined : value;
    } catch (cause) {
      this.#ignoreSignal();
      this.#signal?.throwIfAborted();
      if (cause instanceof WebSplatterError) throw cause;
      return new SplatSourceError(this.name, `reading stopped: ${messageOf(cause)}`, undefined, { cause });
    } finally {
      clearTimeout(timer);
    }
  }

  #noteArrival(byteCount: number, waitedMs: number): void {
    this.#waitedMs += waitedMs;
    this.#cameBytes += byteCount;
    if (this.#cameBytes >= LEAST_BYTES_IN_TIME) {
      this.#waitedMs = 0;
      this.#cameBytes = 0;
    }
    const givenBytes = this.#base + this.#end + byteCount - this.#toDrop;
    if (givenBytes > this.#maxBytes) {
      throw new SplatFileError(
        'too-large',
        this.name,
        `there are more than ${this.#maxBytes} bytes, unpacked. Pass a larger maxBytes if that is right.`,
        { byte: this.#maxBytes },
      );
    }
  }

  async #readSome(target?: Uint8Array<ArrayBuffer>): Promise<{ done: boolean; value?: Uint8Array }> {
    if (this.#reader.kind === 'chunks') return this.#reader.reader.read();
    return this.#reader.reader.read(target ?? this.#chunkTarget());
  }

  /** Free part of the read buffer; a used-up buffer is replaced. */
  #chunkTarget(): Uint8Array<ArrayBuffer> {
    if (this.#chunkMemory.byteLength !== CHUNK_BYTES) this.#chunkMemory = new ArrayBuffer(CHUNK_BYTES);
    return new Uint8Array(this.#chunkMemory);
  }
}

/**
 * A BYOB reader for byte streams of files and responses, which most browsers support; else a
 * default reader.
 */
function readerOf(stream: ReadableStream<Uint8Array>): Reader {
  try {
    return { kind: 'into', reader: stream.getReader({ mode: 'byob' }) };
  } catch {
    // The stream is no byte stream; a locked stream throws again below.
    return { kind: 'chunks', reader: stream.getReader() };
  }
}

export function lockedStreamError(name: string): SplatSourceError {
  return new SplatSourceError(
    name,
    'the stream is locked: something else is reading it, or has read it. Pass a fresh stream, or the Blob or URL itself.',
  );
}

export function messageOf(cause: unknown): string {
  return cause instanceof Error ? cause.message : shown(cause);
}

function describeChunk(chunk: unknown): string {
  return typeof chunk === 'object' && chunk !== null
    ? `a chunk of ${chunk.constructor?.name}`
    : `a ${typeof chunk}`;
}
