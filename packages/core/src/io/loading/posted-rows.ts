import type { RowLayout } from '../../packing/row-layout.ts';
import type { RowSink } from '../formats/row-sink.ts';
import type { LoadReply } from './load-messages.ts';

/** Pieces that are filled or on their way at once. */
const PIECES = 4;

/** Posts rows to the page, which gives their memory back. */
export class PostedRows implements RowSink {
  readonly mayDetach = true;
  readonly #port: { postMessage(reply: LoadReply, transfer: Transferable[]): void };
  readonly #free: ArrayBuffer[] = [];
  #made = 0;
  #pieceBytes = 0;
  #onFree: (() => void) | null = null;

  constructor(port: { postMessage(reply: LoadReply, transfer: Transferable[]): void }) {
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

  giveBack(memory: ArrayBuffer): void {
    this.#free.push(memory);
    this.#onFree?.();
    this.#onFree = null;
  }
}
