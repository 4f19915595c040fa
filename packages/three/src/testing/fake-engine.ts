import {
  type Accuracy,
  type AccuracySettings,
  type CloudLease,
  type CloudPrecision,
  resolveAccuracy,
  type SplatCloud,
  type SplatEngine,
} from '@websplatter/core';
import { vi } from 'vitest';

/**
 * An engine whose only cloud records claims and meets them at once. Its loads end by `ends`, one for
 * each, and when they are aborted.
 */
export function fakeEngine({ accuracy = 'balanced' }: { accuracy?: Accuracy } = {}) {
  const destroyed = vi.fn();
  const state = { accuracy: resolveAccuracy(accuracy), pages: {} };
  const claim = vi.fn(async (_precision: CloudPrecision) => {
    await Promise.resolve();
    state.pages = {};
  });
  const releaseOwn = vi.fn();
  const released = vi.fn();
  const hold = (precision: CloudPrecision): CloudLease => {
    const lease = {
      met: claim(precision),
      change: (changed: CloudPrecision) => {
        lease.met = claim(changed);
        return lease.met;
      },
      release: released,
    };
    return lease as unknown as CloudLease;
  };
  const cloud = {
    isPreview: false,
    isDestroyed: false,
    uploaded: Promise.resolve(),
    destroy: destroyed,
    pagesFor: () => state.pages,
    hold,
    ownLease: { release: releaseOwn },
  } as unknown as SplatCloud;
  const addPacked = vi.fn<SplatEngine['addPacked']>(() => cloud);
  const ends: { readonly resolve: (loaded: SplatCloud) => void; readonly reject: (error: Error) => void }[] =
    [];
  const load = vi.fn<SplatEngine['load']>(
    (_source, { signal } = {}) =>
      new Promise((resolve, reject) => {
        ends.push({ resolve, reject });
        signal?.addEventListener('abort', () => reject(signal.reason as Error));
      }),
  );
  let lose = () => {};
  const lost = new Promise<void>((resolve) => {
    lose = resolve;
  });
  const engine = {
    addPacked,
    load,
    lost,
    get accuracy(): AccuracySettings {
      return state.accuracy;
    },
    resolveAccuracy: (asked?: Accuracy) => ({
      settings: asked ? resolveAccuracy(asked) : state.accuracy,
      notices: [],
    }),
  } as unknown as SplatEngine;
  const setAccuracy = (changed: Accuracy) => {
    state.accuracy = resolveAccuracy(changed);
  };
  return { engine, cloud, addPacked, load, ends, lose, claim, released, releaseOwn, destroyed, setAccuracy };
}
