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
import { adoptRenderer, findSplatEngine, splatEngineOf } from '../renderer/adopt-renderer.ts';
import { type DataOptions, SplatData } from './splat-data.ts';

/** Precision of streamed scenes, for any accuracy. */
const STREAMED = { geometryPrecision: 'packed', shPrecision: 'u8' } as const;

/**
 * A Loader of all sources whose type is also a Loader of URLs, as react-three-fiber's `useLoader`
 * requires.
 */
type SourceLoader = Loader<SplatData, string> & Loader<SplatData, SplatSource>;

/**
 * Loads splats of any supported format, in a worker if workers are available. A source is a URL, a
 * File or Blob, a buffer or a stream. Reports to its LoadingManager.
 *
 * URLs, Files and Blobs can be read again for a finer precision or another renderer, so their splats
 * leave memory once they are on a GPU. Splats of buffers and streams stay in memory. The loader's
 * headers and credentials apply to every request, but are sent to the URL's own origin only.
 *
 * @example
 * const data = await new SplatLoader().loadAsync('/garden.ply');
 * scene.add(new SplatCloudObject(data));
 */
export class SplatLoader extends (Loader as new (manager?: LoadingManager) => SourceLoader) {
  /**
   * Called again and again with the part of a large binary PLY that has been read, while it is loaded
   * for the renderer of `detectSupport`. Show each preview in place of the one before, which is not
   * drawn any more; the last one looks like the loaded splats. Only that renderer draws previews, and
   * only until their load fails. Set this before `load`.
   */
  onPreview?: (preview: SplatData) => void;
  /**
   * Format, name, limits and requests of later loads. Headers and credentials have three's own
   * setters. Set a format for sources without a file extension: `loader.sourceOptions = { format:
   * 'splat' }`.
   */
  sourceOptions: SourceOptions = {};
  /**
   * Most bytes of GPU memory for a streamed scene, on each renderer. Default: an equal share of the
   * renderer's `streamBudgetBytes`, which is 512 MiB for all scenes. Scenes that need less take
   * less. A streamed scene is loaded as soon as its coarsest part is; without
   * `detectSupport`, it is read as a whole.
   */
  budgetBytes?: number;
  #renderer: object | null = null;
  #accuracy: AccuracySettings | null = null;
  #aborter = new AbortController();

  /**
   * Loads later URLs, Files and Blobs straight into the memory of this renderer's GPU, which also
   * packs large files. Splats that no cloud shows stay there until `data.dispose()`.
   *
   * @throws SplatsUnsupportedRendererError for a renderer that cannot draw splats.
   */
  detectSupport(renderer: object): this {
    findSplatEngine(renderer);
    this.#renderer = renderer;
    return this;
  }

  /**
   * Packs later loads for renderers or clouds of this accuracy. Default: the accuracy of the renderer
   * in `detectSupport`, else `balanced`. A target counts as the default, because its settings are
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
    // A renderer that cannot draw splats throws when it draws; another may show these splats.
    const engine = this.#renderer && (await adoptRenderer(this.#renderer).then(splatEngineOf, () => null));
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
        // The engine has ended: load into memory for the renderer that replaces this one.
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
