import {
  type AccuracyRequest,
  type AccuracySettings,
  DEFAULT_ACCURACY,
  isAccuracyWish,
  type LoadProgress,
  lastingSource,
  loadSplats,
  resolveAccuracy,
  type SplatSource,
  SplatSourceError,
} from '@websplatter/core';
import { Loader } from 'three/webgpu';
import { SplatData } from './splat-data.ts';

/**
 * Loads splats of any supported format, in a worker if workers are available. A source is an address, a File or Blob, a
 * buffer or a stream. Reports to its LoadingManager.
 *
 * Addresses, Files and Blobs can be read again if a finer precision is needed later; buffers, streams, and addresses that
 * need the loader's headers or credentials cannot.
 */
export class SplatLoader extends Loader<SplatData, SplatSource> {
  #accuracy: AccuracySettings = resolveAccuracy(DEFAULT_ACCURACY);
  #aborter = new AbortController();

  /**
   * Packs later loads for renderers or clouds of this accuracy; default `balanced`, as theirs is. A wish counts as
   * `balanced`, because its settings are unknown before anything is drawn.
   *
   * @throws InvalidArgumentError for unknown settings.
   */
  setAccuracy(accuracy: AccuracyRequest): this {
    this.#accuracy = resolveAccuracy(isAccuracyWish(accuracy) ? DEFAULT_ACCURACY : accuracy);
    return this;
  }

  /** Aborts all running loads: their `onError` receives an AbortError. */
  override abort(): this {
    this.#aborter.abort(new DOMException('Loading was aborted.', 'AbortError'));
    this.#aborter = new AbortController();
    return this;
  }

  /**
   * Loads one source. `onError` receives a SplatFileError, a SplatSourceError or an AbortError; `loaded` and `total` of
   * progress events are bytes.
   */
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
      if (onError) onError(error);
      else console.error(error);
      manager.itemError(item);
    };
    this.#load(isAddress ? address : source, item, onProgress)
      .then(onLoad, onFailure)
      .finally(() => manager.itemEnd(item));
  }

  async #load(
    source: SplatSource,
    name: string,
    onProgress: ((event: ProgressEvent) => void) | undefined,
  ): Promise<SplatData> {
    const { geometryPrecision, shPrecision } = this.#accuracy;
    const readAgainFrom = this.#guardedAddress(source) === null ? lastingSource(source) : null;
    const signal = AbortSignal.any([this.#aborter.signal, this.manager.abortController.signal]);
    const packed = await loadSplats(await this.#opened(source, name, signal), {
      name,
      signal,
      geometryPrecision,
      shPrecision,
      onProgress: onProgress && ((progress) => onProgress(progressEvent(progress))),
    });
    return new SplatData(packed, name, readAgainFrom);
  }

  /** Returns the address if its request needs headers or credentials that only this loader knows; otherwise null. */
  #guardedAddress(source: SplatSource): string | null {
    const isGuarded = Object.keys(this.requestHeader).length > 0 || this.withCredentials;
    return isGuarded && typeof source === 'string' ? source : null;
  }

  async #opened(source: SplatSource, name: string, signal: AbortSignal): Promise<SplatSource> {
    const address = this.#guardedAddress(source);
    if (address === null) return source;
    const credentials = this.withCredentials ? 'include' : 'same-origin';
    const response = await fetch(address, { headers: this.requestHeader, credentials, signal });
    if (!response.ok || !response.body) {
      throw new SplatSourceError(name, `the server answered ${response.status}`, response.status);
    }
    return response.body;
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
