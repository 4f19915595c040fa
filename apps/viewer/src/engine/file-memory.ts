import type { ViewerStore } from '../state/store.ts';
import type { FileDropDecision } from './file-drop.ts';
import type { AskedHandle } from './file-handles.ts';
import { joinedNames } from './scene-source.ts';

/** A file of a scene as kept from one load of the page to the next. */
export interface KeptFile {
  readonly name: string;
  /** Where the browser has such: of the file, its folder, or all files of the scene. */
  readonly handles: readonly AskedHandle[];
}

/** Files that a person has opened. */
export interface OpenedNames extends Pick<KeptFile, 'handles'> {
  readonly names: readonly string[];
}

const NONE_OPENED: OpenedNames = { names: [], handles: [] };

/** Where the last file is kept. */
export interface FileStore {
  read(): Promise<KeptFile | null>;
  write(file: KeptFile): Promise<void>;
  clear(): Promise<void>;
}

/** Keeps the file that was opened last, and offers it again when the page has been loaded anew. */
export class FileMemory {
  readonly #store: ViewerStore;
  readonly #kept: FileStore;
  #offered: KeptFile | null = null;
  /** Files opened and added since the page was loaded. */
  #opened = NONE_OPENED;

  constructor(store: ViewerStore, kept: FileStore) {
    this.#store = store;
    this.#kept = kept;
  }

  /** Offers the file that was opened last, if there is one. */
  async offer(): Promise<void> {
    // Some windows have no storage, private ones above all: then nothing is offered.
    const file = await this.#kept.read().catch(() => null);
    if (!file) return;
    this.#offered = file;
    this.#store.setState({ lastFile: { name: file.name, isReachable: file.handles.length > 0 } });
  }

  /** Files were opened: offers them from now on, with those that they were added to. */
  remember(opened: OpenedNames, isAdded: boolean): void {
    this.#offered = null;
    const before = isAdded ? this.#opened : NONE_OPENED;
    const names = [...before.names, ...opened.names];
    const handles = [...before.handles, ...opened.handles];
    this.#opened = { names, handles };
    void this.#kept.write({ name: joinedNames(names), handles }).catch(() => {});
  }

  /** It is not wanted again. */
  forget(): void {
    this.#offered = null;
    this.#store.setState({ lastFile: null });
    void this.#kept.clear().catch(() => {});
  }

  /** Reads the offered file again; call it by a click: the browser may ask. Null if that fails. */
  async reopen(): Promise<FileDropDecision | null> {
    const file = this.#offered;
    if (!file) return null;
    const { reopenFile } = await import('./reopen-file.ts');
    return reopenFile(file.name, file.handles, this.#store);
  }
}
