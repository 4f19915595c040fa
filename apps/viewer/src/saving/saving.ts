import type { WritableFormat } from '@websplatter/core/write';
import { upAxisOf } from '../camera/up-axis.ts';
import { lastingScene } from '../rereading/lasting-scene.ts';
import { type SceneSource, titleOf } from '../scene/scene-source.ts';
import type { ViewerStore } from '../state/store.ts';
import { formatBytes } from '../words/format.ts';
import { download } from './download.ts';
import type { SaveReply, SaveRequest } from './save-messages.ts';

/** Saves the scene on the screen as a file, one at a time. */
export class Saving {
  readonly #store: ViewerStore;
  readonly #sourceOf: () => SceneSource | undefined;
  #worker: Worker | null = null;

  /** @param sourceOf where the scene on the screen comes from. */
  constructor(store: ViewerStore, sourceOf: () => SceneSource | undefined) {
    this.#store = store;
    this.#sourceOf = sourceOf;
  }

  /** Writes the scene in another format and hands the file to the browser. Does nothing where there is nothing to save. */
  start(format: WritableFormat): void {
    const sceneSource = this.#sourceOf();
    const source = sceneSource && lastingScene(sceneSource);
    if (!source || this.#worker) return;
    const fileName = savedName(titleOf(sceneSource), format);
    const state = this.#store.getState();
    const up = upAxisOf(state);
    const { crop } = state.inspecting;
    this.#store.setState({ saving: { fileName, phase: 'read', part: undefined }, failure: null });
    const worker = new Worker(new URL('../rereading/scene.worker.ts', import.meta.url), { type: 'module' });
    this.#worker = worker;
    worker.onmessage = ({ data }: MessageEvent<SaveReply>) => this.#take(data, fileName);
    worker.onerror = ({ message }) =>
      this.#fail(fileName, message || 'The worker could not be started, or had no memory.', true);
    const request: SaveRequest = { kind: 'save', source, formatName: format.name, up, crop };
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

/** The name of a scene's file, or of what is in it, with another end. */
export function savedName(title: string, { extension }: Pick<WritableFormat, 'extension'>): string {
  return `${title.replace(/(\.compressed)?\.[a-z]+$/i, '') || 'scene'}${extension}`;
}
