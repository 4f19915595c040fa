import { type PackedCloud, packCloud, transferablesOf } from '../../data/packing/packed-cloud.ts';
import type { GeometryPrecision, ShPrecision } from '../../data/packing/precision.ts';
import type { RowLayout } from '../../data/packing/row-layout.ts';
import type { DecodeMeshopt, PackedView } from '../containers/meshopt.ts';
import type { FormatReaders } from '../formats/read-format.ts';
import type { Passed, RowFiles, RowSink, RowsTo } from '../formats/rows/row-sink.ts';
import { fromPostedError, type PostedError, toPostedError } from '../posted-error.ts';
import type { KnownSource } from '../sources/known-source.ts';
import type { LoadProgress, ReadOptions, SourceOptions } from '../sources/splat-source.ts';
import { OtherFormat, readSource } from './read-source.ts';

/** Settings of a load besides its source. All can be posted. */
export interface LoadSettings extends SourceOptions {
  readonly shPrecision: ShPrecision;
  readonly geometryPrecision: GeometryPrecision;
}

/** Page to worker. */
export type LoadRequest =
  /** A job. The next one follows only after the outcome of this one. */
  | {
      readonly kind: 'load';
      readonly source: KnownSource;
      readonly settings: LoadSettings;
      /** Limits of the files that are posted as raw rows; null to post no rows. */
      readonly rows: RowFiles | null;
    }
  /** Row memory that the page returns for reuse. */
  | { readonly kind: 'memory'; readonly memory: ArrayBuffer };

/** Worker to page. */
export type LoadReply =
  /**
   * The worker's script is running. The job is posted only now, because posted streams cannot be
   * taken back.
   */
  | { readonly kind: 'ready' }
  | { readonly kind: 'progress'; readonly progress: LoadProgress }
  | { readonly kind: 'cloud'; readonly cloud: PackedCloud }
  /**
   * The page can use the file's rows unchanged. Pieces of rows follow, then an optional note, then
   * the end.
   */
  | { readonly kind: 'layout'; readonly layout: RowLayout }
  | { readonly kind: 'rows'; readonly memory: ArrayBuffer; readonly rowCount: number }
  | { readonly kind: 'rows-note'; readonly text: string }
  | { readonly kind: 'rows-end' }
  /** A compressed part of the file whose decoder only the page can fetch. */
  | { readonly kind: 'packed-view'; readonly view: PackedView; readonly reply: MessagePort }
  /** The file is no PLY. `stream` replaces a stream source and starts at its first byte. */
  | { readonly kind: 'other-format'; readonly stream: ReadableStream<Uint8Array> | null }
  | { readonly kind: 'error'; readonly error: PostedError };

/** Page to worker, through the port of a packed view. */
export type UnpackedReply =
  | { readonly bytes: Uint8Array<ArrayBuffer> | null }
  | { readonly error: PostedError };

/** Most pieces that are being filled or are in transit. */
const PIECES = 4;

/** The used part of a worker's global scope; a MessagePort has it too. */
export interface LoadPort {
  onmessage: ((event: MessageEvent<LoadRequest>) => void) | null;
  postMessage(reply: LoadReply, transfer: Transferable[]): void;
}

/**
 * Runs a whole load in the calling thread, for the formats of `readers`. Resolves with `passed` if
 * the file's raw rows went to `rowsTo`.
 */
export async function readAndPack(
  source: KnownSource,
  { geometryPrecision, ...settings }: LoadSettings,
  { signal, onProgress }: Pick<ReadOptions, 'signal' | 'onProgress'>,
  readers: FormatReaders,
  rowsTo?: RowsTo,
): Promise<PackedCloud | Passed> {
  let last: LoadProgress | undefined;
  const watched = (progress: LoadProgress) => {
    last = progress;
    onProgress?.(progress);
  };
  const set = await readSource(source, { ...settings, signal, onProgress: watched }, readers, rowsTo);
  if (last) onProgress?.({ ...last, phase: 'arrange' });
  // Packing cannot be interrupted: this is the last check of the signal.
  signal?.throwIfAborted();
  if (set === 'passed') return set;
  return packCloud(set, { geometryPrecision, shPrecision: settings.shPrecision });
}

/**
 * Serves the load requests of a page, one after another, and posts progress and outcome.
 *
 * @param readers the formats to read; files of other formats are handed back.
 */
export function serveLoad(port: LoadPort, readers: FormatReaders): void {
  let sink = new PostedRows(port);
  port.onmessage = async ({ data: request }) => {
    if (request.kind === 'memory') {
      sink.giveBack(request.memory);
      return;
    }
    const { source, settings, rows } = request;
    sink = new PostedRows(port);
    try {
      const watch = {
        onProgress: (progress) => port.postMessage({ kind: 'progress', progress }, []),
      } satisfies Parameters<typeof readAndPack>[2];
      const cloud = await readAndPack(
        source,
        settings,
        watch,
        readers,
        rows ? { sink, files: rows } : undefined,
      );
      if (cloud === 'passed') port.postMessage({ kind: 'rows-end' }, []);
      else port.postMessage({ kind: 'cloud', cloud }, transferablesOf(cloud));
    } catch (error) {
      if (error instanceof OtherFormat) {
        const { stream } = error;
        port.postMessage({ kind: 'other-format', stream }, stream ? [stream] : []);
      } else port.postMessage({ kind: 'error', error: toPostedError(error) }, []);
    }
  };
  port.postMessage({ kind: 'ready' }, []);
}

/**
 * Returns `readers` that send meshopt data over `port`, to be decoded on the main thread: the worker
 * cannot fetch the decoder.
 */
export function withPageDecoder(port: LoadPort, readers: FormatReaders): FormatReaders {
  const decodeMeshopt: DecodeMeshopt = (view) =>
    new Promise((resolve, reject) => {
      const { port1, port2 } = new MessageChannel();
      port1.onmessage = ({ data }: MessageEvent<UnpackedReply>) => {
        port1.close();
        if ('error' in data) reject(fromPostedError(data.error));
        else resolve(data.bytes);
      };
      port.postMessage({ kind: 'packed-view', view, reply: port2 }, [port2, view.bytes.buffer]);
    });
  return { ...readers, decodeMeshopt };
}

/** Posts rows to the page, which returns their memory. */
class PostedRows implements RowSink {
  readonly mayDetach = true;
  readonly #port: LoadPort;
  readonly #free: ArrayBuffer[] = [];
  #made = 0;
  #pieceBytes = 0;
  #onFree: (() => void) | null = null;

  constructor(port: LoadPort) {
    this.#port = port;
  }

  async begin(layout: RowLayout): Promise<void> {
    this.#pieceBytes = Math.min(layout.count, layout.pieceRows) * layout.strideBytes;
    this.#port.postMessage({ kind: 'layout', layout }, []);
  }

  async memory(): Promise<Uint8Array<ArrayBuffer>> {
    while (this.#free.length === 0 && this.#made === PIECES) {
      await new Promise<void>((resolve) => {
        this.#onFree = resolve;
      });
    }
    if (this.#free.length === 0) {
      this.#made++;
      this.#free.push(new ArrayBuffer(this.#pieceBytes));
    }
    return new Uint8Array(this.#free.pop()!);
  }

  take(rowCount: number, { buffer: memory }: Uint8Array<ArrayBuffer>): void {
    this.#port.postMessage({ kind: 'rows', memory, rowCount }, [memory]);
  }

  note(text: string): void {
    this.#port.postMessage({ kind: 'rows-note', text }, []);
  }

  giveBack(memory: ArrayBuffer): void {
    this.#free.push(memory);
    this.#onFree?.();
    this.#onFree = null;
  }
}
