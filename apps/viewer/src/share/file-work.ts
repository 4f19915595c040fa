import { formatBytes } from '@websplatter/kit/format';
import { saveFile } from '@websplatter/kit/take-away';
import { joinedNames } from '../engine/scene-source.ts';
import type { Viewer } from '../engine/viewer.ts';
import type { FailureReport } from '../state/messages.ts';
import type { ViewerStore } from '../state/store.ts';
import { pathSegment } from '../ui/path-segment.ts';

export interface FileTask {
  readonly fileName: string;
  /** Begins the notice “… FILE was cancelled.”: `Saving` or `Drawing`. */
  readonly doing: string;
  readonly make: (signal: AbortSignal) => Promise<Blob>;
  /** Sentences without a full stop, which the notice adds once the file is saved. */
  readonly notes?: readonly string[];
  readonly failureOf: (error: unknown) => Omit<FailureReport, 'message'>;
  /** Called in the end, however it ends. */
  readonly onEnd: () => void;
}

/** Makes files of one kind from the viewer's state, one at a time, and hands them to the browser. */
export abstract class FileWork {
  protected readonly viewer: Viewer;
  protected readonly store: ViewerStore;
  #work: AbortController | null = null;

  constructor(viewer: Viewer, store: ViewerStore) {
    this.viewer = viewer;
    this.store = store;
  }

  protected get isBusy(): boolean {
    return this.#work !== null;
  }

  /** The store learns how it has ended. */
  protected async run({ fileName, doing, make, notes = [], failureOf, onEnd }: FileTask): Promise<void> {
    const { store } = this;
    const work = new AbortController();
    this.#work = work;
    try {
      const file = await make(work.signal);
      saveFile(file, fileName);
      const sentences = [
        `Saved ${fileName} (${formatBytes(file.size)}).`,
        ...notes.map((note) => `Note: ${note}.`),
      ];
      store.setState({ notice: sentences.join(' ') });
    } catch (error) {
      if (work.signal.aborted) store.setState({ notice: `${doing} ${fileName} was cancelled.` });
      else {
        const failure = failureOf(error);
        if (failure.isFault) console.error(error);
        store.setState({
          failure: { ...failure, message: error instanceof Error ? error.message : String(error) },
        });
      }
    } finally {
      // Ends other work that listens to the signal and has not finished.
      work.abort();
      this.#work = null;
      onEnd();
    }
  }

  cancel(): void {
    this.#work?.abort();
  }
}

/** Makes one of something for each viewer: its panel comes and goes while a file is made. */
export function perViewer<Made>(
  make: (viewer: Viewer, store: ViewerStore) => Made,
): (viewer: Viewer, store: ViewerStore) => Made {
  const all = new WeakMap<Viewer, { readonly made: Made }>();
  return (viewer, store) => {
    const entry = all.get(viewer) ?? { made: make(viewer, store) };
    all.set(viewer, entry);
    return entry.made;
  };
}

/**
 * A file name from the titles of scenes, their extensions replaced by `extension`: in lower case,
 * with hyphens in place of blanks and commas, which addresses and command lines would need quoted.
 */
export function savedName(titles: readonly string[], { extension }: { readonly extension: string }): string {
  const names = titles.map((title) => title.replace(/(\.compressed)?\.[a-z]+$/i, '').trim() || 'scene');
  const plain = joinedNames(names)
    .toLowerCase()
    .replace(/[\s,]+/g, '-');
  return pathSegment(`${plain}${extension}`);
}
