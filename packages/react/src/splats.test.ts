import { createRoot, extend } from '@react-three/fiber';
import { GpuLimitError, InvalidArgumentError, RecoveryPace, type SplatEngine } from '@websplatter/core';
import {
  findSplatEngine,
  SplatData,
  SplatsPrecisionError,
  SplatsStreamError,
  SplatsUnsupportedRendererError,
} from '@websplatter/three';
import { act, Component, createElement, type ReactNode, StrictMode, Suspense } from 'react';
import { Group, type Object3D } from 'three';
import { afterEach, beforeEach, expect, it, vi } from 'vitest';
import { canvasStates, FirstPicture } from './canvas-states.ts';
import { GRACE_MS } from './splat-cache.ts';
import { Splats, type SplatsProps } from './splats.tsx';
import { useSplats } from './use-splats.ts';

interface Load {
  readonly source: unknown;
  readonly budgetBytes: unknown;
  readonly accuracy: unknown;
  /** For which the file is loaded. */
  readonly renderer: unknown;
  readonly isAborted: () => boolean;
  readonly onProgress: (progress: ProgressEvent) => void;
  readonly onPreview: (preview: SplatData) => void;
  readonly resolve: (data: SplatData) => void;
  readonly reject: (error: Error) => void;
}

const test = vi.hoisted(() => ({
  loads: [] as Load[],
  loseDevice: (_info: object) => {},
}));

// The renderer and the object in the scene are tested with three; here they only have to exist.
vi.mock('@websplatter/three', async () => {
  const three = await import('three');
  class SplatData {
    isCached = false;
    dispose() {}
  }
  class SplatsPrecisionError extends Error {}
  class SplatsStreamError extends Error {}
  class SplatsUnsupportedRendererError extends Error {}
  class SplatCloudObject extends three.Object3D {
    data: SplatData | null = null;
    opacity = 1;
    accuracy: unknown = null;
    fog = true;
    effects: readonly unknown[] = [];
    reveal: unknown = null;
    onError: ((error: unknown) => void) | null = null;
    override dispose() {}
    ownEffects() {
      return this.effects;
    }
    clamped(_property: string, value: number) {
      return value;
    }
  }
  class SplatLoader {
    #accuracy: unknown;
    #renderer: unknown;
    #isAborted = false;
    onPreview = (_preview: SplatData) => {};
    budgetBytes?: number;
    detectSupport(renderer: unknown) {
      this.#renderer = renderer;
      return this;
    }
    setAccuracy(accuracy: unknown) {
      this.#accuracy = accuracy;
      return this;
    }
    abort() {
      this.#isAborted = true;
    }
    loadAsync(source: unknown, onProgress: (progress: ProgressEvent) => void) {
      return new Promise<SplatData>((resolve, reject) => {
        const isAborted = () => this.#isAborted;
        const [accuracy, renderer] = [this.#accuracy, this.#renderer];
        const { onPreview, budgetBytes } = this;
        const asked = { source, accuracy, renderer, budgetBytes };
        test.loads.push({ ...asked, isAborted, onProgress, onPreview, resolve, reject });
      });
    }
  }
  const onDeviceLost = (_renderer: object, listener: (info: object) => void) => {
    test.loseDevice = listener;
    return () => {
      test.loseDevice = () => {};
    };
  };
  const findSplatEngine = vi.fn();
  const { checkedReveal, encodedColor, volumeOf, LoopPace } =
    await vi.importActual<typeof import('@websplatter/three')>('@websplatter/three');
  return {
    checkedReveal,
    volumeOf,
    encodedColor,
    LoopPace,
    onDeviceLost,
    SplatCloudObject,
    SplatData,
    findSplatEngine,
    SplatLoader,
    SplatsPrecisionError,
    SplatsStreamError,
    SplatsUnsupportedRendererError,
  };
});

extend({ Group });

const accuracy = { geometryPrecision: 'packed', shPrecision: 'u8' };
const renderer = { render() {}, setPixelRatio() {}, setSize() {}, dispose() {} };

let root: ReturnType<typeof createRoot>;
let scene: Object3D;
let caught: unknown;
/** Each number has its own error boundary, which has not failed yet. */
let attempt: number;

beforeEach(async () => {
  vi.useFakeTimers();
  vi.stubGlobal('IS_REACT_ACT_ENVIRONMENT', true);
  vi.stubGlobal('document', { baseURI: 'https://example.org/' });
  vi.mocked(findSplatEngine).mockReturnValue({ accuracy } as unknown as SplatEngine);
  test.loads.length = 0;
  caught = undefined;
  attempt = 0;
  // React and three log much about errors that a test causes, and about each other.
  for (const level of ['error', 'warn'] as const) vi.spyOn(console, level).mockImplementation(() => {});
  const canvas = { addEventListener() {}, removeEventListener() {} } as unknown as HTMLCanvasElement;
  root = createRoot(canvas);
  const size = { width: 96, height: 64, top: 0, left: 0 };
  await root.configure({ gl: renderer as never, frameloop: 'never', size, dpr: 1 });
});

afterEach(async () => {
  await act(async () => root.unmount());
  canvasStates.delete(renderer);
  await vi.advanceTimersByTimeAsync(2 * GRACE_MS);
  useSplats.clear();
  expect(vi.getTimerCount(), 'timers left').toBe(0);
  vi.unstubAllGlobals();
  vi.restoreAllMocks();
  vi.useRealTimers();
});

class Boundary extends Component<{ children?: ReactNode }> {
  override state = { hasFailed: false };
  static getDerivedStateFromError(error: unknown) {
    caught = error;
    return { hasFailed: true };
  }
  override render() {
    return this.state.hasFailed ? null : this.props.children;
  }
}

/**
 * Renders under StrictMode, an error boundary and a Suspense boundary whose fallback is a group
 * named "fallback".
 */
async function show(...children: ReactNode[]): Promise<void> {
  const fallback = createElement('group', { name: 'fallback' });
  const suspense = createElement(Suspense, { fallback }, ...children);
  await act(async () => {
    const store = root.render(
      createElement(StrictMode, null, createElement(Boundary, { key: attempt }, suspense)),
    );
    scene = store.getState().scene;
  });
}

/** Of a `<SplatCanvas>`. */
const canvasState = () => ({
  pace: new RecoveryPace(),
  picture: new FirstPicture(() => {}),
  accuracyKey: '',
  view: { isFitted: false, left: null },
  isViewKept: false,
});
const splats = (props: SplatsProps) => createElement(Splats, props);
/** The object of the first `<Splats>`. */
const object = () => scene.children.find((child) => 'data' in child) as Object3D & Record<string, unknown>;
const isFallbackShown = () => scene.getObjectByName('fallback') !== undefined;
const splatData = (name: string, isPreview = false) =>
  Object.assign(Object.create(SplatData.prototype), {
    name,
    isPreview,
    prepareRays: async () => {},
  }) as SplatData;

it('suspends until the first file has been loaded for its renderer, and reports progress', async () => {
  const onLoad = vi.fn();
  const onProgress = vi.fn();
  await show(splats({ src: 'a.ply', onLoad, onProgress, position: [1, 2, 3], opacity: 0.5 }));
  expect(isFallbackShown()).toBe(true);
  expect(object().visible).toBe(false);
  // A load without an accuracy of its own has that of its renderer.
  const asked = test.loads.map((load) => [load.source, load.accuracy, load.renderer]);
  expect(asked).toEqual([['a.ply', undefined, renderer]]);
  const progress = { loaded: 1, total: 2 } as ProgressEvent;
  test.loads[0].onProgress(progress);
  expect(onProgress).toHaveBeenCalledExactlyOnceWith(progress);
  const a = splatData('a');
  await act(async () => test.loads[0].resolve(a));
  expect(isFallbackShown()).toBe(false);
  expect(object()).toMatchObject({ data: a, visible: true, opacity: 0.5 });
  expect(object().position.toArray()).toEqual([1, 2, 3]);
  expect(onLoad).toHaveBeenCalledExactlyOnceWith(a);
});

it('keeps the splats on screen while a new file is read, and their object', async () => {
  await show(splats({ src: 'a.ply' }));
  const a = splatData('a');
  await act(async () => test.loads[0].resolve(a));
  const before = object();
  const onLoad = vi.fn();
  await show(splats({ src: 'b.ply', onLoad }));
  await act(() => vi.advanceTimersByTimeAsync(2 * GRACE_MS));
  expect(isFallbackShown()).toBe(false);
  expect(object()).toMatchObject({ data: a, visible: true });
  expect(onLoad).not.toHaveBeenCalled();
  // Back to the file on screen: it is still in memory, and the other load is aborted.
  await show(splats({ src: 'a.ply' }));
  await act(() => vi.advanceTimersByTimeAsync(2 * GRACE_MS));
  expect(test.loads).toHaveLength(2);
  expect(test.loads[1].isAborted()).toBe(true);
  await show(splats({ src: 'c.ply', onLoad }));
  const c = splatData('c');
  await act(async () => test.loads[2].resolve(c));
  expect(object()).toBe(before);
  expect(object().data).toBe(c);
  expect(onLoad).toHaveBeenCalledExactlyOnceWith(c);
});

it('shows the part of the first file that has arrived, and loads it afterwards', async () => {
  const onLoad = vi.fn();
  await show(splats({ src: 'a.ply', onLoad }));
  for (const name of ['part', 'larger part']) {
    const part = splatData(name, true);
    await act(async () => test.loads[0].onPreview(part));
    expect(isFallbackShown()).toBe(false);
    expect(object()).toMatchObject({ data: part, visible: true });
  }
  expect(onLoad).not.toHaveBeenCalled();
  const before = object();
  const a = splatData('a');
  await act(async () => test.loads[0].resolve(a));
  expect(object()).toBe(before);
  expect(before.data).toBe(a);
  expect(onLoad).toHaveBeenCalledExactlyOnceWith(a);
  // From now on whole files replace each other.
  await show(splats({ src: 'b.ply', onLoad }));
  await act(async () => test.loads[1].onPreview(splatData('part of b', true)));
  expect(before.data).toBe(a);
});

it('takes a part of a file away when another is to be shown, and aborts its load', async () => {
  await show(splats({ src: 'a.ply' }));
  await act(async () => test.loads[0].onPreview(splatData('part of a', true)));
  await show(splats({ src: 'b.ply' }));
  expect(isFallbackShown()).toBe(true);
  expect(object().data).toBeNull();
  const part = splatData('part of b', true);
  await act(async () => test.loads[1].onPreview(part));
  expect(isFallbackShown()).toBe(false);
  expect(object()).toMatchObject({ data: part, visible: true });
  await act(() => vi.advanceTimersByTimeAsync(GRACE_MS));
  expect(test.loads.map((load) => load.isAborted())).toEqual([true, false]);
});

it('shows no part of a file that another renderer loads, and none to useSplats', async () => {
  function Count() {
    return createElement('group', { name: useSplats('b.ply').name });
  }
  // Loaded for no renderer.
  useSplats.preload('a.ply');
  await show(splats({ src: 'a.ply' }));
  await act(async () => test.loads[0].onPreview(splatData('part', true)));
  expect(isFallbackShown()).toBe(true);
  await show(createElement(Count));
  await act(async () => test.loads[1].onPreview(splatData('part', true)));
  expect(isFallbackShown()).toBe(true);
  await act(async () => test.loads[1].resolve(splatData('b')));
  expect(scene.getObjectByName('b')).toBeDefined();
});

it('resets props that become undefined, like props that are left out', async () => {
  const src = splatData('a');
  const onClick = () => {};
  for (const unset of [{}, { opacity: undefined, fog: undefined, position: undefined, onClick: undefined }]) {
    await show(splats({ src, opacity: 0.5, fog: false, position: [1, 2, 3], onClick }));
    expect(object()).toMatchObject({
      opacity: 0.5,
      fog: false,
      position: { x: 1 },
      __r3f: { eventCount: 1 },
    });
    await show(splats({ src, ...unset }));
    expect(object()).toMatchObject({ opacity: 1, fog: true, position: { x: 0 }, __r3f: { eventCount: 0 } });
  }
});

it('sets what any object of three has, and lets pointers pass where `raycast` does', async () => {
  const src = splatData('a');
  const prepareRays = vi.fn(async () => {});
  src.prepareRays = prepareRays;
  const onClick = () => {};
  const raycast = () => null;
  const given = { renderOrder: 2, frustumCulled: false, matrixWorldAutoUpdate: false };
  await show(splats({ src, onClick, raycast, layers: 3, ...given }));
  const cloud = object();
  expect(cloud).toMatchObject({ raycast, layers: { mask: 1 << 3 }, ...given });
  expect(prepareRays).not.toHaveBeenCalled();
  await show(splats({ src, onClick }));
  const unset = { renderOrder: 0, frustumCulled: true, matrixWorldAutoUpdate: true };
  expect(cloud).toMatchObject({ layers: { mask: 1 }, ...unset });
  expect(cloud.raycast).toBe(Object.getPrototypeOf(cloud).raycast);
  expect(prepareRays).toHaveBeenCalled();
});

const BOTH_REVEALS = { from: 'camera', radius: 1, durationMs: 9 } as never;
const BOTH_TARGETS = { minPsnrDb: 45, maxFrameMs: 8 } as never;

/**
 * @fault Arguments: a `src` of React is no source
 * @consequence `InvalidArgumentError`, to the error boundary
 */
it.each<[string, Partial<SplatsProps>]>([
  ['brightness', { brightness: Number.NaN }],
  ['opacity', { opacity: Number.NaN }],
  ['radius', { reveal: { from: 'camera', radius: Number.NaN } }],
  ['durationMs', { reveal: { from: 'camera', durationMs: 0 } }],
  ['reveal', { reveal: BOTH_REVEALS }],
  ['accuracy', { accuracy: BOTH_TARGETS }],
  ['accuracy', { accuracy: 'best' as never }],
])('passes the error of an invalid %s to the error boundary: %o', async (argument, props) => {
  const src = splatData('a');
  await show(splats({ src, ...props }));
  expect(caught).toMatchObject({ argument });
  attempt++;
  caught = undefined;
  await show(splats({ src }));
  expect(object()).toMatchObject({ data: src });
  await show(splats({ src, ...props }));
  expect(caught).toBeInstanceOf(InvalidArgumentError);
});

it.each([undefined, null, ''])('without a source, draws, fetches and awaits nothing: %j', async (src) => {
  const onLoad = vi.fn();
  await show(splats({ src, onLoad }));
  expect(isFallbackShown()).toBe(false);
  expect(object()).toMatchObject({ data: null, visible: true });
  const a = splatData('a');
  await show(splats({ src: 'a.ply', onLoad }));
  expect(isFallbackShown()).toBe(true);
  await act(async () => test.loads[0].resolve(a));
  expect(object().data).toBe(a);
  const before = object();
  await show(splats({ src, onLoad }));
  expect(isFallbackShown()).toBe(false);
  expect(object()).toBe(before);
  expect(before.data).toBeNull();
  expect(test.loads).toHaveLength(1);
  expect(onLoad).toHaveBeenCalledExactlyOnceWith(a);
  expect(caught).toBeUndefined();
});

it.each([5, true, Symbol('s')])('passes on what is wrong with a src that is none: %s', async (src) => {
  await show(splats({ src: src as never }));
  expect(caught).toBeInstanceOf(InvalidArgumentError);
  expect(caught).toMatchObject({ argument: 'source' });
});

it('frees its splats when it is unmounted, also below a dispose of null, but not when its object moves', async () => {
  const src = splatData('a');
  await show(createElement('group', { dispose: null }, splats({ src, dispose: null })));
  const [group] = scene.children;
  const cloud = group.children[0];
  const dispose = vi.spyOn(cloud, 'dispose' as never);
  scene.attach(cloud);
  group.attach(cloud);
  await act(async () => {});
  expect(dispose).not.toHaveBeenCalled();
  await show();
  expect(dispose).toHaveBeenCalled();
});

it('passes a failure to the error boundary, and tries again when mounted again', async () => {
  await show(splats({ src: 'a.ply' }));
  const error = new Error('no such file');
  await act(async () => test.loads[0].reject(error));
  expect(caught).toBe(error);
  expect(scene.children).toEqual([]);
  attempt++;
  await show(splats({ src: 'a.ply' }));
  await act(async () => test.loads[1].resolve(splatData('a')));
  expect(object()).toMatchObject({ data: { name: 'a' }, visible: true });
});

it('passes a failure to onError if there is one, and keeps the splats on screen', async () => {
  const onError = vi.fn();
  await show(splats({ src: 'a.ply', onError }));
  const a = splatData('a');
  await act(async () => test.loads[0].resolve(a));
  await show(splats({ src: 'b.ply', onError }));
  const error = new Error('no such file');
  await act(async () => test.loads[1].reject(error));
  expect(onError).toHaveBeenCalledExactlyOnceWith(error);
  expect(object().data).toBe(a);
  expect(caught).toBeUndefined();
});

it('passes errors of drawing to onError, or logs them unless nothing can be drawn', async () => {
  const onError = vi.fn();
  const a = splatData('a');
  await show(splats({ src: a, onError }));
  const error = new Error('cannot draw');
  const report = () => (object().onError as (error: unknown) => void)(error);
  await act(async () => report());
  expect(onError).toHaveBeenCalledExactlyOnceWith(error);
  await show(splats({ src: a }));
  expect(caught).toBeUndefined();
  await act(async () => report());
  expect(caught).toBeUndefined();
  expect(console.error).toHaveBeenCalledWith(error);
  const lack = new GpuLimitError('memory', 2, 1, 'No memory.');
  await act(async () => (object().onError as (error: unknown) => void)(lack));
  expect(caught).toBe(lack);
});

it('keeps splats that cannot be drawn as exactly as requested, and logs a warning', async () => {
  await show(splats({ src: splatData('a'), accuracy: 'reference' }));
  const error = new SplatsPrecisionError(new Error('gone'));
  await act(async () => (object().onError as (error: unknown) => void)(error));
  expect(caught).toBeUndefined();
  expect(console.warn).toHaveBeenCalledWith(error);
});

it('keeps what is there of a scene whose parts cannot be fetched, and says so', async () => {
  const a = splatData('a');
  const error = new SplatsStreamError(new Error('gone'), () => {});
  const report = () => act(async () => (object().onError as (error: unknown) => void)(error));
  await show(splats({ src: a }));
  await report();
  expect(console.warn).toHaveBeenCalledWith(error);
  const onError = vi.fn();
  await show(splats({ src: a, onError }));
  await report();
  expect(onError).toHaveBeenCalledExactlyOnceWith(error);
  expect(caught).toBeUndefined();
  expect(object().data).toBe(a);
});

it('passes on the budget of the first request for a scene, and tells each time that it is complete', async () => {
  const onComplete = vi.fn();
  await show(
    splats({ key: 1, src: 'city.bricks', budgetBytes: 1e8, onComplete }),
    splats({ key: 2, src: 'city.bricks', budgetBytes: 2e8 }),
  );
  expect(test.loads.map(({ budgetBytes }) => budgetBytes)).toEqual([1e8]);
  await act(async () => test.loads[0].resolve(splatData('city')));
  expect(isFallbackShown()).toBe(false);
  expect(onComplete).not.toHaveBeenCalled();
  for (let i = 0; i < 2; i++) object().dispatchEvent({ type: 'complete' } as never);
  expect(onComplete).toHaveBeenCalledTimes(2);
});

it('changes accuracy without reading or suspending, and reports the choice for a target', async () => {
  const onAccuracyChosen = vi.fn();
  await show(splats({ src: 'a.ply', accuracy: 'high' }));
  expect(test.loads.map((load) => load.accuracy)).toEqual(['high']);
  await act(async () => test.loads[0].resolve(splatData('a')));
  const before = object();
  expect(before.accuracy).toBe('high');
  await show(splats({ src: 'a.ply', accuracy: { minPsnrDb: 45 }, onAccuracyChosen }));
  expect(isFallbackShown()).toBe(false);
  expect(object()).toBe(before);
  expect(before).toMatchObject({ accuracy: { minPsnrDb: 45 }, data: { name: 'a' }, visible: true });
  expect(test.loads).toHaveLength(1);
  const choice = { why: 'It is the fastest.' };
  before.dispatchEvent({ type: 'accuracychosen', choice } as never);
  expect(onAccuracyChosen).toHaveBeenCalledExactlyOnceWith(choice);
  await show(splats({ src: 'a.ply' }));
  expect(before.accuracy).toBeNull();
});

it('passes on detail, and equal detail only once', async () => {
  const a = splatData('a');
  await show(splats({ src: a, detail: { maxErrorPx: 0.5 } }));
  const { detail } = object();
  expect(detail).toEqual({ maxErrorPx: 0.5 });
  await show(splats({ src: a, detail: { maxErrorPx: 0.5 } }));
  expect(object().detail).toBe(detail);
  await show(splats({ src: a, detail: 'full' }));
  expect(object().detail).toBe('full');
  await show(splats({ src: a }));
  expect(object().detail).toBeNull();
});

it('shows splats in memory without suspending, and reports the first frame', async () => {
  const [onLoad, onFirstFrame] = [vi.fn(), vi.fn()];
  const a = splatData('a');
  await show(splats({ src: a, onLoad, onFirstFrame }));
  expect(object()).toMatchObject({ data: a, visible: true });
  expect(onLoad).toHaveBeenCalledExactlyOnceWith(a);
  const pace = { recovered: vi.fn() };
  canvasStates.set(renderer, { ...canvasState(), pace: pace as unknown as RecoveryPace });
  object().dispatchEvent({ type: 'firstframe' } as never);
  expect(onFirstFrame).toHaveBeenCalledOnce();
  // The device of a SplatCanvas has been put to use.
  expect(pace.recovered).toHaveBeenCalledOnce();
});

it('tells the Canvas of the first frame without splats that are still read', async () => {
  const onShown = vi.fn();
  canvasStates.set(renderer, { ...canvasState(), picture: new FirstPicture(onShown) });
  const readBeside = createElement(Suspense, null, splats({ src: 'b.ply' }));
  await show(splats({ src: splatData('a') }), readBeside, splats({ src: '' }));
  object().dispatchEvent({ type: 'complete' } as never);
  expect(onShown, 'beside what is read').not.toHaveBeenCalled();
  await act(async () => test.loads[0].onPreview(splatData('a part', true)));
  expect(onShown, 'beside a part').not.toHaveBeenCalled();
  await act(async () => test.loads[0].resolve(splatData('b')));
  expect(onShown).toHaveBeenCalledOnce();
});

it('tells the Canvas so, too, where others cannot be read', async () => {
  const onShown = vi.fn();
  canvasStates.set(renderer, { ...canvasState(), picture: new FirstPicture(onShown) });
  const failing = createElement(Suspense, null, splats({ src: 'b.ply', onError: () => {} }));
  await show(splats({ src: splatData('a') }), failing);
  object().dispatchEvent({ type: 'complete' } as never);
  await act(async () => test.loads[0].reject(new Error('no file')));
  expect(onShown).toHaveBeenCalledOnce();
});

it('prepares rays where pointers are listened for, and nowhere else', async () => {
  const a = splatData('a');
  const prepareRays = vi.fn(async () => {});
  a.prepareRays = prepareRays;
  await show(splats({ src: a }));
  object().dispatchEvent({ type: 'firstframe' } as never);
  expect(prepareRays).not.toHaveBeenCalled();
  await show(splats({ src: a, onPointerMove: () => {} }));
  expect(prepareRays).toHaveBeenCalledOnce();
});

it('forwards its ref to the object', async () => {
  const ref = { current: null as unknown };
  await show(splats({ src: splatData('a'), ref: ref as never }));
  expect(ref.current).toBe(object());
  await show();
  expect(ref.current).toBeNull();
});

it('says what to do if the renderer cannot draw splats, or shows its fallback', async () => {
  const error = new SplatsUnsupportedRendererError('use gl={createSplatRenderer}');
  vi.mocked(findSplatEngine).mockImplementation(() => {
    throw error;
  });
  await show(splats({ src: 'a.ply', fallback: createElement('group', { name: 'instead' }) }));
  expect(scene.getObjectByName('instead')).toBeDefined();
  expect(caught).toBeUndefined();
  await show(splats({ src: 'a.ply' }));
  expect(caught).toBe(error);
  expect(test.loads).toHaveLength(0);
});

it('throws whatever else keeps the renderer from drawing, also with a fallback', async () => {
  const error = new Error('offline');
  vi.mocked(findSplatEngine).mockImplementation(() => {
    throw error;
  });
  await show(splats({ src: 'a.ply', fallback: null }));
  expect(caught).toBe(error);
});
