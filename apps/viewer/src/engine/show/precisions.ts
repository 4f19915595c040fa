import {
  ACCURACY_PRESETS,
  type AccuracySettings,
  type CloudLease,
  DestroyedError,
  type LoadProgress,
  type SplatCloud,
} from '@websplatter/core';
import type { Comparison } from '../../state/accuracy.ts';
import type { ViewerStore } from '../../state/store.ts';
import type { SessionOwner } from './session-owner.ts';

export interface PrecisionsOptions {
  readonly store: ViewerStore;
  readonly sessions: SessionOwner;
  /** The clouds of the newest scene. */
  readonly clouds: () => readonly SplatCloud[];
  /** Called when the clouds hold the requested precisions, or as many of them as fit. */
  readonly onHeld: () => void;
}

/**
 * Decides which precisions the clouds hold: the chosen accuracy's and the compared ones'. New
 * clouds start with the engine's accuracy. Nothing else in the viewer requests precisions.
 */
export class Precisions {
  readonly #options: PrecisionsOptions;
  #held: Promise<void> = Promise.resolve();
  /** The request in progress, if any. */
  #work: AbortController | null = null;
  /** Leases on the precisions that are compared with the chosen accuracy. */
  #compared: readonly CloudLease[] = [];

  constructor(options: PrecisionsOptions) {
    this.#options = options;
  }

  /** Resolves when the clouds hold the last requested precisions, as far as they can. */
  whenHeld(): Promise<void> {
    return this.#held;
  }

  /**
   * Requests the precisions of the store's accuracy and comparison. The engine makes or reads
   * missing ones in the background, and the image follows. The GPU's limits are written to the
   * store.
   */
  request(): void {
    this.#held = this.#ask();
  }

  /**
   * Cancels reading and conversion. The store's accuracy is set back to the precisions on the GPU,
   * or the comparison ends.
   */
  cancel(): void {
    const { store, clouds } = this.#options;
    const { accuracy, comparison } = store.getState();
    const [cloud] = clouds();
    if (!this.#work || !cloud) return;
    this.#work.abort();
    const { geometryPrecision, shPrecision } = cloud.pagesFor(accuracy);
    // The comparison's precisions are requested after the accuracy's own.
    const isThere = geometryPrecision === accuracy.geometryPrecision && shPrecision === accuracy.shPrecision;
    store.setState(
      isThere && comparison
        ? { comparison: null }
        : { accuracy: { ...accuracy, geometryPrecision, shPrecision } },
    );
    this.request();
  }

  async #ask(): Promise<void> {
    const { store, sessions, clouds, onHeld } = this.#options;
    const session = sessions.current;
    if (!session) return;
    const { engine } = session;
    const { target, accuracy, comparison, scene } = store.getState();
    const asked = target ?? accuracy;
    const work = new AbortController();
    this.#work = work;
    const options = {
      signal: work.signal,
      onProgress: (progress: LoadProgress) => {
        if (this.#work === work) store.setState({ preparing: { title: scene?.title ?? '', ...progress } });
      },
    };
    const isCurrent = () => {
      const now = store.getState();
      return (
        sessions.current === session &&
        (now.target ?? now.accuracy) === asked &&
        now.comparison === comparison
      );
    };
    const request = engine.setAccuracy(asked, options);
    store.setState({
      accuracyNotices: engine.notices,
      // Until the scene has been measured: the last choice for the same target, or the default.
      ...(target && { accuracy: engine.accuracy }),
    });
    const problems = (await request).map(({ error }) => error.message);
    if (!isCurrent()) return this.#end(work);
    const former = this.#compared;
    this.#compared = comparedWith(comparison).flatMap((other) =>
      clouds().map((cloud) => cloud.hold(other, options)),
    );
    for (const { met } of this.#compared) {
      await met.catch((error: Error) => {
        const isOver = error.name === 'AbortError' || error instanceof DestroyedError;
        if (!isOver) problems.push(error.message);
      });
    }
    // Released last: an accuracy that stays compared never leaves the GPU.
    for (const lease of former) lease.release();
    this.#end(work);
    if (!isCurrent()) return;
    store.setState({ accuracyNotices: [...new Set([...engine.notices, ...problems])] });
    onHeld();
  }

  /** Clears the work in progress, unless newer work has replaced it. */
  #end(work: AbortController): void {
    if (this.#work !== work) return;
    this.#work = null;
    this.#options.store.setState({ preparing: null });
  }
}

/** The accuracies that a comparison shows besides the chosen one. */
function comparedWith(comparison: Comparison | null): readonly AccuracySettings[] {
  if (comparison?.kind === 'error') return [ACCURACY_PRESETS.reference];
  if (comparison === null) return [];
  return [comparison.left, comparison.right].filter((side) => side !== 'current');
}
