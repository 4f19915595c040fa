import {
  type LoadProgress,
  resolveAccuracy,
  type SetAccuracyOptions,
  type SplatCloud,
} from '@websplatter/core';
import { beforeEach, describe, expect, it } from 'vitest';
import { createViewerStore, type ViewerStore } from '../../state/store.ts';
import { Precisions } from './precisions.ts';
import type { SessionOwner } from './session-owner.ts';

const FINER = resolveAccuracy({ shPrecision: 'f32' });
const READING: LoadProgress = {
  phase: 'read',
  loadedBytes: 4000,
  totalBytes: undefined,
  splats: 800,
  bytesPerSecond: 0,
};

/** A request that the engine, or a cloud that is compared, has been made. */
interface Request {
  readonly asked: unknown;
  readonly options: SetAccuracyOptions;
  readonly meet: () => void;
}

let store: ViewerStore;
let precisions: Precisions;
let requests: Request[];
beforeEach(() => {
  store = createViewerStore();
  requests = [];
  const request = (asked: unknown, options: SetAccuracyOptions) =>
    new Promise<void>((resolve) => {
      options.signal?.addEventListener('abort', () => resolve());
      requests.push({ asked, options, meet: resolve });
    });
  const engine = {
    notices: [],
    setAccuracy: async (asked: unknown, options: SetAccuracyOptions) => {
      await request(asked, options);
      return [];
    },
  };
  const cloud = {
    pagesFor: () => ({ geometryPrecision: 'packed', shPrecision: 'u8' }),
    hold: (asked: unknown, options: SetAccuracyOptions) => ({
      met: request(asked, options),
      release: () => {},
    }),
  } as unknown as SplatCloud;
  const sessions = { current: { engine } } as unknown as SessionOwner;
  precisions = new Precisions({ store, sessions, clouds: () => [cloud], onHeld: () => {} });
});

const tell = (request: Request) => request.options.onProgress?.(READING, {} as SplatCloud);
const settled = () => precisions.whenHeld();

describe('Precisions', () => {
  it('tells how far clouds have come to hold what is asked for, until they do', async () => {
    store.setState({ accuracy: FINER, scene: { title: 'Garden' } as never });
    precisions.request();
    expect(store.getState().preparing).toBeNull();
    tell(requests[0]);
    expect(store.getState().preparing).toEqual({ title: 'Garden', ...READING });
    requests[0].meet();
    await settled();
    expect(store.getState().preparing).toBeNull();
    expect(store.getState().accuracy).toBe(FINER);
  });

  it('goes back to what is drawn where it is cancelled', async () => {
    store.setState({ accuracy: FINER });
    precisions.request();
    tell(requests[0]);
    precisions.cancel();
    expect(requests[0].options.signal?.aborted).toBe(true);
    expect(store.getState().accuracy).toEqual(resolveAccuracy());
    requests[1].meet();
    await settled();
    expect(requests[1].asked).toEqual(resolveAccuracy());
    expect(store.getState().preparing).toBeNull();
  });

  it('ends a comparison whose side is cancelled, and no other setting', async () => {
    const comparison = { kind: 'split', left: 'current', right: FINER } as const;
    store.setState({ comparison });
    precisions.request();
    requests[0].meet();
    await expect.poll(() => requests.length).toBe(2);
    tell(requests[1]);
    expect(requests[1].asked).toBe(FINER);
    precisions.cancel();
    expect(store.getState()).toMatchObject({ comparison: null, accuracy: resolveAccuracy() });
    requests[2].meet();
    await settled();
    expect(store.getState().preparing).toBeNull();
  });

  it('says nothing more of what a later request has replaced', async () => {
    store.setState({ accuracy: FINER });
    precisions.request();
    store.setState({ accuracy: resolveAccuracy('high') });
    precisions.request();
    tell(requests[0]);
    expect(store.getState().preparing).toBeNull();
    requests[0].meet();
    requests[1].meet();
    await settled();
  });

  it('has nothing to cancel where nothing is done', () => {
    precisions.cancel();
    expect(requests).toEqual([]);
  });
});
