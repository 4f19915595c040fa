import { NOT_FETCHED } from '../../state/messages.ts';
import type { ViewerStore } from '../../state/store.ts';
import type { AskedHandle, FileDropDecision } from '../open/file-drop.ts';
import { joinedNames } from '../open/scene-source.ts';

/** The files of a scene as remembered across page loads. */
export interface KeptFile {
  readonly name: string;
  /**
   * Handles of the file, of its folder or of all files of the scene; none in browsers without
   * handles.
   */
  readonly handles: readonly AskedHandle[];
}

/** Files that the user has opened. */
export interface OpenedNames extends Pick<KeptFile, 'handles'> {
  readonly names: readonly string[];
}

const NONE_OPENED: OpenedNames = { names: [], handles: [] };

/** Storage for the last file and the ones before. */
export interface FileStore {
  /** The last file. */
  read(): Promise<KeptFile | null>;
  /** The newest first. */
  readRecent(): Promise<readonly KeptFile[]>;
  write(file: KeptFile): Promise<void>;
  clear(): Promise<void>;
}

/** Remembers the file opened last, and offers to reopen it after a page load. */
export class FileMemory {
  readonly #store: ViewerStore;
  readonly #kept: () => Promise<FileStore>;
  #offered: KeptFile | null = null;
  /** Files opened and added since the page was loaded. */
  #opened = NONE_OPENED;

  constructor(store: ViewerStore, kept: () => Promise<FileStore>) {
    this.#store = store;
    this.#kept = kept;
  }

  /** Offers the remembered file, if there is one. */
  async offer(): Promise<void> {
    // Some windows, above all private ones, have no storage: nothing is offered.
    const file = await this.#kept()
      .then((kept) => kept.read())
      .catch(() => null);
    if (!file) return;
    this.#offered = file;
    this.#store.setState({ lastFile: { name: file.name, isReachable: file.handles.length > 0 } });
  }

  /** Remembers opened files; with `isAdded`, together with the files opened before. */
  remember(opened: OpenedNames, isAdded: boolean): void {
    this.#offered = null;
    const before = isAdded ? this.#opened : NONE_OPENED;
    const names = [...before.names, ...opened.names];
    const handles = [...before.handles, ...opened.handles];
    this.#opened = { names, handles };
    // Without storage, the file is not offered again.
    void this.#kept()
      .then((kept) => kept.write({ name: joinedNames(names), handles }))
      .catch(() => {});
  }

  /** Withdraws the offer and clears the stored file. */
  forget(): void {
    this.#offered = null;
    this.#store.setState({ lastFile: null });
    // What cannot be cleared is offered again by the next visit.
    void this.#kept()
      .then((kept) => kept.clear())
      .catch(() => {});
  }

  /** Remembered files that can be opened again, the newest first. */
  async recent(): Promise<readonly KeptFile[]> {
    // Without storage, no files are listed.
    const files = await this.#kept()
      .then((kept) => kept.readRecent())
      .catch(() => []);
    return files.filter(({ handles }) => handles.length > 0);
  }

  /**
   * Reads a remembered file, by default the offered one. Call it in a click handler: the browser may
   * ask for permission. Null if reading fails.
   */
  async reopen(file: KeptFile | null = this.#offered): Promise<FileDropDecision | null> {
    if (!file) return null;
    return import('./reopen-file.ts').then(
      ({ reopenFile }) => reopenFile(file.name, file.handles, this.#store),
      () => ({ opened: [], notice: NOT_FETCHED }),
    );
  }
}
