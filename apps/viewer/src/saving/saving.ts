import type { WritableFormat } from '@websplatter/core/write';
import { upAxisOf } from '../camera/up-axis.ts';
import { formatBytes } from '../formatting/format.ts';
import { lastingScene } from '../reload/lasting-scene.ts';
import { titleOf } from '../scene/scene-source.ts';
import { cloudKey, type ShownPart } from '../scene/shown-scene.ts';
import type { Selecting } from '../state/selecting.ts';
import type { ViewerStore } from '../state/store.ts';
import { download } from './download.ts';
import type { SavedPart, SavedRows, SaveReply, SaveRequest } from './save-messages.ts';
import { savedName } from './saved-name.ts';

/** Saves the scene on the screen as a file, one at a time. */
export class Saving {
  readonly #store: ViewerStore;
  readonly #partsOf: () => readonly ShownPart[];
  #worker: Worker | null = null;

  /** @param partsOf the files of the scene on the screen. */
  constructor(store: ViewerStore, partsOf: () => readonly ShownPart[]) {
    this.#store = store;
    this.#partsOf = partsOf;
  }

  /** Writes the scene in another format and hands the browser the file, if there is a scene. */
  start(format: WritableFormat): void {
    const state = this.#store.getState();
    const { crop, selecting } = state.inspecting;
    const seen = this.#partsOf().filter(({ look }) => !look.isHidden && look.opacity > 0);
    const parts = seen.map((part) => savedPart(part, selecting)).filter((part) => part !== null);
    if (parts.length === 0 || this.#worker) return;
    const fileName = savedName(
      seen.map(({ source }) => titleOf(source)),
      format,
    );
    const up = upAxisOf(state);
    this.#store.setState({ saving: { fileName, phase: 'read', part: undefined }, failure: null });
    const worker = new Worker(new URL('../reload/scene.worker.ts', import.meta.url), { type: 'module' });
    this.#worker = worker;
    worker.onmessage = ({ data }: MessageEvent<SaveReply>) => this.#take(data, fileName);
    worker.onerror = ({ message }) =>
      this.#fail(fileName, message || 'The worker could not be started, or had no memory.', true);
    const request: SaveRequest = { kind: 'save', parts, formatName: format.name, up, crop };
    worker.postMessage(request);
  }

  cancel(): void {
    const { saving } = this.#store.getState();
    this.#end();
    if (saving) this.#store.setState({ notice: `Saving ${saving.fileName} was cancelled.` });
  }

  #take(reply: SaveReply, fileName: string): void {
    if (reply.kind === 'progress') {
      const { phase, part } = reply;
      this.#store.setState({ saving: { fileName, phase, part } });
      return;
    }
    if (reply.kind === 'failed') {
      this.#fail(fileName, reply.message, reply.isFault);
      return;
    }
    this.#end();
    download(new Blob([reply.bytes]), fileName);
    this.#store.setState({ notice: `Saved ${fileName} (${formatBytes(reply.bytes.length)}).` });
  }

  #fail(fileName: string, message: string, isFault: boolean): void {
    this.#end();
    const failure = { title: `${fileName} cannot be saved`, message, advice: '', isFault };
    this.#store.setState({ failure });
  }

  #end(): void {
    this.#worker?.terminate();
    this.#worker = null;
    this.#store.setState({ saving: null });
  }
}

/** Null for what is no file. */
function savedPart(
  { key, source: shown, look: { opacity, placement } }: ShownPart,
  selecting: Selecting,
): SavedPart | null {
  const source = lastingScene(shown);
  // Sources that last have one cloud each.
  return source && { source, opacity, placement, rows: savedRows(cloudKey(key, 0), selecting) };
}

function savedRows(key: string, selecting: Selecting): SavedRows | null {
  if (savesSelection(selecting))
    return { words: selecting.selected.get(key) ?? new Uint32Array(), areSaved: true };
  const words = selecting.removed.get(key);
  return words ? { words, areSaved: false } : null;
}

/** Whether only the selected splats are saved. */
export function savesSelection({ savesSelection: isAsked, selected }: Selecting): boolean {
  return isAsked && selected.size > 0;
}
