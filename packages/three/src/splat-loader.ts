import {
  type AccuracyRequest,
  type AccuracySettings,
  callListener,
  checkAccuracy,
  DEFAULT_ACCURACY,
  DestroyedError,
  type LoadProgress,
  lastingSource,
  loadSplats,
  resolveAccuracy,
  type SourceOptions,
  type SplatCloud,
  type SplatSource,
} from '@websplatter/core';
import { Loader, type LoadingManager } from 'three/webgpu';
import { adoptRenderer, findSplatEngine } from './adopt-renderer.ts';
import { type DataOptions, SplatData } from './splat-data.ts';

/** Precision of scenes that stream, whatever is asked for. */
const STREAMED = { geometryPrecision: 'packed', shPrecision: 'u8' } as const;

/**
 * A Loader of all sources, and by its type also of addresses alone, as react-three-fiber's
 * `useLoader` asks for.
 */
type SourceLoader = Loader<SplatData, string> & Loader<SplatData, SplatSource>;

/**
 * Loads splats of any supported format, in a worker if workers are available. A source is an
 * address, a File or Blob, a buffer or a stream. Reports to its LoadingManager.
 *
 * Addresses, Files and Blobs can be read again for a finer precision or another renderer, so their
 * splats leave memory once they are on a GPU. Buffers and streams cannot; their splats stay. The
 * loader's headers and credentials hold for every request; they go to no other origin than the
 * address's.
 */
export class SplatLoader extends (Loader as new (manager?: LoadingManager) => SourceLoader) {
  /**
   * Receives the arrived part of a large binary PLY, again and again, while it is loaded for the
   * renderer of `detectSupport`. Show it in place of the preview before, which is drawn no more;
   * the last one looks as the loaded splats do. Previews are drawn by that renderer alone, and no
   * more once their load has failed. Set this before `load`.
   */
  onPreview?: (preview: SplatData) => void;
  /**
   * Format, name and limits of later loads, and how addresses are fetched, but for headers and
   * credentials, which three has its own setters for. Give a format to sources whose names tell
   * none: `loader.sourceOptions = { format: 'splat' }`.
   */
  sourceOptions: SourceOptions = {};
  /**
   * GPU memory for a scene that streams, on each renderer, at most; default 512 MiB. Scenes that
   * need less take less. Such a scene is there as soon as its coarsest part is; loaded without
   * `detectSupport`, it is read as a whole.
   */
  budgetBytes?: number;
  #renderer: object | null = null;
  #accuracy: AccuracySettings | null = null;
  #aborter = new AbortController();

  /**
   * Loads later sources that can be read again straight into the memory of this renderer's GPU,
   * where large files are packed, too. Splats that no cloud shows then stay there until
   * `data.dispose()`.
   *
   * @throws SplatsUnsupportedRendererError for a renderer that cannot draw splats.
   */
  detectSupport(renderer: object): this {
    findSplatEngine(renderer);
    this.#renderer = renderer;
    return this;
  }

  /**
   * Packs later loads for renderers or clouds of this accuracy; default that of the renderer in
   * `detectSupport`, else `balanced`. A target counts as the default, because its settings are
   * unknown before anything is drawn.
   *
   * @throws InvalidArgumentError for unknown settings and invalid targets.
   */
  setAccuracy(accuracy: AccuracyRequest): this {
    this.#accuracy = checkAccuracy(accuracy);
    return this;
  }

  /** Aborts all running loads: their `onError` receives an AbortError. */
  override abort(): this {
    this.#aborter.abort(new DOMException('Loading was aborted.', 'AbortError'));
    this.#aborter = new AbortController();
    return this;
  }

  /**
   * Loads one source. `onError` receives a SplatFileError, a SplatSourceError or an AbortError;
   * `loaded` and `total` of progress events are bytes.
   */
  override load(...address: Parameters<Loader<SplatData, string>['load']>): void;
  override load(...source: Parameters<Loader<SplatData, SplatSource>['load']>): void;
  override load(
    source: SplatSource,
    onLoad: (data: SplatData) => void,
    onProgress?: (event: ProgressEvent) => void,
    onError?: (error: unknown) => void,
  ): void {
    const { manager } = this;
    const isAddress = typeof source === 'string' || source instanceof URL;
    const address = isAddress ? manager.resolveURL(`${this.path}${source}`) : '';
    const item = address || ((source as Partial<File>).name ?? 'splats');
    manager.itemStart(item);
    const onFailure = (error: unknown) => {
      if (onError) callListener(onError, error);
      else console.error(error);
      manager.itemError(item);
    };
    this.#load(address || source, this.sourceOptions.name ?? item, onProgress)
      .then((data) => callListener(onLoad, data), onFailure)
      .finally(() => manager.itemEnd(item));
  }

  async #load(
    source: SplatSource,
    name: string,
    onProgress: ((event: ProgressEvent) => void) | undefined,
  ): Promise<SplatData> {
    const { onPreview } = this;
    const wanted = this.#accuracy;
    const readAgainFrom = lastingSource(source);
    const { requestHeader: headers, withCredentials, sourceOptions: given } = this;
    const credentials = withCredentials ? 'include' : 'same-origin';
    const request: SourceOptions['request'] = { headers, credentials, ...given.request };
    const sourceOptions: DataOptions = { ...given, request, budgetBytes: this.budgetBytes };
    const signal = AbortSignal.any([this.#aborter.signal, this.manager.abortController.signal]);
    const options = {
      ...sourceOptions,
      name,
      signal,
      onProgress: onProgress && ((progress: LoadProgress) => onProgress(progressEvent(progress))),
    };
    // What keeps the renderer from drawing is told when it draws; another may show the splats.
    const engine = this.#renderer && (await adoptRenderer(this.#renderer).catch(() => null));
    signal.throwIfAborted();
    const accuracy = wanted ?? engine?.accuracy ?? resolveAccuracy(DEFAULT_ACCURACY);
    const { geometryPrecision, shPrecision } = accuracy;
    if (engine && readAgainFrom !== null) {
      try {
        const precision = { geometryPrecision, shPrecision };
        const dataOf = (cloud: SplatCloud) => {
          const loaded = { engine, cloud, precision: cloud.stream ? STREAMED : precision };
          return new SplatData(loaded, name, readAgainFrom, sourceOptions);
        };
        const show = onPreview && ((preview: SplatCloud) => signal.aborted || onPreview(dataOf(preview)));
        return dataOf(await engine.load(readAgainFrom, { ...options, precision, onPreview: show }));
      } catch (error) {
        // The splats may be shown by the renderer that takes the place of this one.
        if (!(error instanceof DestroyedError)) throw error;
      }
    }
    const packed = await loadSplats(source, { ...options, geometryPrecision, shPrecision });
    return new SplatData(packed, name, readAgainFrom, sourceOptions);
  }
}

/** Node has no ProgressEvent. */
function progressEvent({ loadedBytes, totalBytes }: LoadProgress): ProgressEvent {
  return Object.assign(new Event('progress'), {
    lengthComputable: totalBytes !== undefined,
    loaded: loadedBytes,
    total: totalBytes ?? 0,
  }) as ProgressEvent;
}
