import {
  type Accuracy,
  type AccuracySettings,
  type CloudPrecision,
  resolveAccuracy,
  type SplatCloud,
  type SplatEngine,
} from '@websplatter/core';
import { vi } from 'vitest';

/** An engine that only takes note of what it is asked, and at once holds what it is asked to hold. For tests. */
export function fakeEngine({ accuracy = 'balanced' }: { accuracy?: Accuracy } = {}) {
  const destroyed = vi.fn();
  const state = { accuracy: resolveAccuracy(accuracy), pages: {} };
  const cloud = { destroy: destroyed, pagesFor: () => state.pages } as unknown as SplatCloud;
  const addPacked = vi.fn<SplatEngine['addPacked']>(() => cloud);
  const requestPrecision = vi.fn(async (_cloud: SplatCloud, _precision: CloudPrecision) => {
    await Promise.resolve();
    state.pages = {};
  });
  const engine = {
    addPacked,
    requestPrecision,
    get accuracy(): AccuracySettings {
      return state.accuracy;
    },
    resolveAccuracy: (asked?: Accuracy) => ({ settings: asked ? resolveAccuracy(asked) : state.accuracy }),
  } as unknown as SplatEngine;
  const setAccuracy = (changed: Accuracy) => {
    state.accuracy = resolveAccuracy(changed);
  };
  return { engine, addPacked, requestPrecision, destroyed, setAccuracy };
}
