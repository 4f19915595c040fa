import { formatBytes } from '@websplatter/kit/format';
import { saveFile } from '@websplatter/kit/take-away';
import { type SceneSource, shortened, titleOf } from '../engine/open/scene-source.ts';
import type { Viewer } from '../engine/viewer.ts';
import type { FailureReport } from '../state/messages.ts';
import type { ViewerStore } from '../state/store.ts';
import { tellFailure } from '../state/tell-failure.ts';
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
      else tellFailure(store, error, failureOf(error));
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
 * The names of a scene's files as one file name, with `extension` in place of theirs. People's files
 * keep their names; built-in scenes have the names that addresses call them by.
 */
export function savedName(
  sources: readonly SceneSource[],
  { extension }: { readonly extension: string },
): string {
  const names = sources.map((source) =>
    source.kind === 'builtin'
      ? source.scene.name
      : titleOf(source)
          .replace(/(?:\.compressed)?\.[a-z]+(?:\.gz)?$/i, '')
          .trim(),
  );
  return pathSegment(`${shortened(names).join('-and-') || 'scene'}${extension}`);
}

/** File name of something that is made of the whole scene on the screen. */
export function sceneFileName({ scenes }: Viewer, format: { readonly extension: string }): string {
  return savedName(scenes.newest?.parts.map(({ source }) => source) ?? [], format);
}
