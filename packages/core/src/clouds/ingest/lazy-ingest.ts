import { fetched } from '../../data/errors.ts';
import type { RowLayout } from '../../data/packing/row-layout.ts';
import type { RowSink } from '../../io/formats/rows/row-sink.ts';
import type { DispatchContext } from './dispatches.ts';
import type { IngestedCloud, RowIngest, RowIngestOptions, RowKind } from './row-ingest.ts';

/**
 * A `RowIngest` whose code is fetched once a file turns out to have rows for it. It is destroyed as
 * soon as its signal aborts, unless it has finished.
 */
export class LazyIngest implements RowSink {
  readonly mayDetach = false;
  readonly #context: DispatchContext;
  readonly #options: RowIngestOptions;
  #ingest: RowIngest | null = null;
  readonly #stop = () => this.destroy();
  #isDestroyed = false;

  constructor(context: DispatchContext, options: RowIngestOptions) {
    this.#context = context;
    this.#options = options;
    options.signal.addEventListener('abort', this.#stop);
  }

  /** Fetches the code and compiles the pipelines early, in case such rows arrive. */
  foresee(kind: RowKind): void {
    const prepare = async () => {
      const { rowStages } = await import('./row-ingest.ts');
      await this.#context.pipelines.prepare(rowStages({ ...this.#options, ...kind }));
    };
    // `begin` fetches and compiles the same, and reports the error.
    prepare().catch(() => {});
  }

  async begin(layout: RowLayout): Promise<void> {
    const { RowIngest } = await fetched('loading', import('./row-ingest.ts'));
    if (this.#isDestroyed) return;
    this.#ingest = new RowIngest(this.#context, this.#options);
    await this.#ingest.begin(layout);
  }

  memory(): Promise<Uint8Array<ArrayBuffer>> {
    return this.#ingest!.memory();
  }

  take(rowCount: number): void {
    this.#ingest!.take(rowCount);
  }

  note(text: string): void {
    this.#ingest!.note(text);
  }

  async finish(): Promise<IngestedCloud> {
    const cloud = await this.#ingest!.finish();
    this.#ignoreSignal();
    return cloud;
  }

  destroy(): void {
    this.#ignoreSignal();
    this.#isDestroyed = true;
    this.#ingest?.destroy();
  }

  /** A signal that outlives the load would keep this object in memory. */
  #ignoreSignal(): void {
    this.#options.signal.removeEventListener('abort', this.#stop);
  }
}
