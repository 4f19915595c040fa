import { type CanvasProps, createRoot, type RootState } from '@react-three/fiber';
import { WebGpuUnavailableError } from '@websplatter/core';
import {
  Activity,
  act,
  Component,
  createElement,
  type ReactNode,
  StrictMode,
  useInsertionEffect,
  useLayoutEffect,
  useRef,
  useState,
} from 'react';
import { PerspectiveCamera } from 'three';
import { afterEach, beforeEach, expect, it, vi } from 'vitest';
import { canvasStates } from './canvas-states.ts';
import { createSplatRenderer } from './create-splat-renderer.ts';
import { SplatCanvas } from './splat-canvas.tsx';
import {
  mountSplatDevice,
  NO_DEVICE,
  setSplatDevice,
  splatDevice,
  watchSplatDevice,
} from './splat-device.ts';

/** A Canvas that has asked for its renderer. */
interface FakeCanvas {
  readonly camera: unknown;
  /** Fate of the requested renderer: react-three-fiber frees a Canvas only after that settles. */
  outcome: 'pending' | 'created' | 'failed';
}

const test = vi.hoisted(() => ({
  canvases: [] as FakeCanvas[],
  loseDevice: [] as ((info: object) => void)[],
}));

vi.mock('./create-splat-renderer.ts', () => ({ createSplatRenderer: vi.fn() }));
vi.mock('@websplatter/three', () => ({
  SplatCloudObject: class {},
  onDeviceLost: (_renderer: object, listener: (info: object) => void) => test.loseDevice.push(listener),
}));
// The part of Canvas in question: it requests its renderer in a layout effect; throws without one.
vi.mock('@react-three/fiber', async (importOriginal) => {
  function Canvas({ gl, camera, onCreated }: CanvasProps) {
    const [error, setError] = useState<unknown>(null);
    if (error) throw error;
    const element = useRef<{ isConnected: boolean }>(null);
    useInsertionEffect(() => {
      element.current = { isConnected: true };
      return () => {
        element.current!.isConnected = false;
      };
    }, []);
    const isAsked = useRef(false);
    useLayoutEffect(() => {
      if (isAsked.current) return;
      isAsked.current = true;
      const fake: FakeCanvas = { camera, outcome: 'pending' };
      test.canvases.push(fake);
      (gl as (defaults: object) => Promise<object>)({ canvas: element.current! }).then(
        () => {
          fake.outcome = 'created';
          onCreated?.({ get: () => ({ camera }) } as unknown as RootState);
        },
        (failure) => {
          fake.outcome = 'failed';
          setError(failure);
        },
      );
    });
    return null;
  }
  return { ...(await importOriginal<typeof import('@react-three/fiber')>()), Canvas };
});

let root: ReturnType<typeof createRoot>;
let caught: unknown;
const create = vi.mocked(createSplatRenderer);
const NO_GPU = new WebGpuUnavailableError('WebGPU found no GPU that it may use.');

beforeEach(async () => {
  vi.useFakeTimers();
  vi.stubGlobal('IS_REACT_ACT_ENVIRONMENT', true);
  for (const level of ['error', 'warn'] as const) vi.spyOn(console, level).mockImplementation(() => {});
  test.canvases.length = 0;
  test.loseDevice.length = 0;
  caught = undefined;
  create.mockReset();
  create.mockImplementation(async () => ({}) as never);
  const canvas = { addEventListener() {}, removeEventListener() {} } as unknown as HTMLCanvasElement;
  root = createRoot(canvas);
  const renderer = { render() {}, setPixelRatio() {}, setSize() {}, dispose() {} };
  const size = { width: 96, height: 64, top: 0, left: 0 };
  await root.configure({ gl: renderer as never, frameloop: 'never', size, dpr: 1 });
});
afterEach(async () => {
  await act(async () => root.unmount());
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

const passMs = (durationMs: number) => act(() => vi.advanceTimersByTimeAsync(durationMs));

async function show(mode: 'visible' | 'hidden' = 'visible'): Promise<void> {
  const children = createElement(SplatCanvas, { camera: new PerspectiveCamera() });
  const boundary = createElement(Boundary, null, createElement(Activity, { mode, children }));
  await act(async () => void root.render(createElement(StrictMode, null, boundary)));
  await passMs(0);
}

const loseDevice = () => act(async () => test.loseDevice.at(-1)!({ reason: 'unknown', message: 'reset' }));
const outcomes = () => test.canvases.map(({ outcome }) => outcome);

it('tells, also outside of it, how it is doing for a device, and the console once of each loss', async () => {
  const told: string[] = [];
  const stop = watchSplatDevice(() => {
    const { status, retryInSeconds } = splatDevice();
    told.push(retryInSeconds === null ? status : `${status} in ${retryInSeconds} s`);
  });
  await show();
  expect(splatDevice().status).toBe('ready');
  told.length = 0;
  await loseDevice();
  const said = vi
    .mocked(console.warn)
    .mock.calls.map(String)
    .filter((text) => text.includes('was lost'));
  expect(said).toEqual([expect.stringContaining('was lost (unknown: reset)')]);
  await passMs(0);
  await loseDevice();
  create.mockRejectedValueOnce(NO_GPU);
  for (const waitMs of [0, 1000, 4000]) await passMs(waitMs);
  const seconds = [4, 3, 2, 1].map((left) => `retrying in ${left} s`);
  const second = ['lost', 'retrying in 1 s', 'lost', ...seconds, 'lost', 'ready'];
  expect(told).toEqual(['lost', 'ready', ...second]);
  create.mockRejectedValue(NO_GPU);
  await loseDevice();
  for (const waitMs of [0, 16_000]) await passMs(waitMs);
  expect(caught).toBe(NO_GPU);
  expect(splatDevice().status, 'after its error').toBe('gone');
  create.mockImplementation(async () => ({}) as never);
  await act(async () => root.unmount());
  expect(splatDevice().status).toBe('gone');
  const end = mountSplatDevice({});
  expect(splatDevice().status, 'with another one').toBe('none');
  end();
  stop();
});

it('is told of by that which fares worst, if there are several', () => {
  const [first, second] = [{}, {}];
  const ends = [first, second].map(mountSplatDevice);
  setSplatDevice(first, 'ready');
  setSplatDevice(second, 'retrying', 4);
  expect(splatDevice()).toEqual({ status: 'retrying', retryInSeconds: 4 });
  ends[1]();
  expect(splatDevice()).toEqual({ status: 'ready', retryInSeconds: null });
  ends[0]();
  expect(splatDevice()).toEqual(NO_DEVICE);
});

it('follows the pace of a recovery, with the camera that was there, and then tells the error boundary', async () => {
  await show();
  expect(outcomes()).toEqual(['created']);
  for (const waitMs of [0, 1000, 4000, 16_000]) {
    const created = create.mock.calls.length;
    await loseDevice();
    if (waitMs > 0) await passMs(waitMs - 1);
    expect(create).toHaveBeenCalledTimes(created);
    await passMs(1);
    expect(create).toHaveBeenCalledTimes(created + 1);
  }
  expect(new Set(test.canvases.map(({ camera }) => camera)).size).toBe(1);
  await loseDevice();
  expect(caught).toBeInstanceOf(WebGpuUnavailableError);
  expect((caught as Error).message).toContain('lost again and again');
});

it('begins anew where splats have been drawn for a minute', async () => {
  await show();
  await loseDevice();
  await passMs(0);
  await passMs(100_000);
  await loseDevice();
  await passMs(999);
  expect(create).toHaveBeenCalledTimes(2);
  await passMs(1);
  const renderer = await create.mock.results.at(-1)!.value;
  canvasStates.get(renderer)!.pace.recovered();
  await passMs(61_000);
  await loseDevice();
  await passMs(0);
  expect(create).toHaveBeenCalledTimes(4);
});

/**
 * @fault Devices and engines: the Canvas is hidden (`<Activity>`) while it waits for a device
 * @consequence the Canvas comes back when it is shown
 */
it('comes back where it is hidden while it waits, and shown again', async () => {
  await show();
  await loseDevice();
  await passMs(0);
  await loseDevice();
  await show('hidden');
  await passMs(500);
  await show();
  await passMs(1000);
  expect(outcomes()).toEqual(['created', 'created', 'created']);
});

/**
 * @fault Devices and engines: an attempt of the Canvas finds no GPU
 * @consequence the attempt leaves nothing
 */
it('leaves no attempt that has failed, so that react-three-fiber frees its Canvas', async () => {
  await show();
  create.mockRejectedValue(NO_GPU);
  await loseDevice();
  await passMs(0);
  expect(outcomes()).toEqual(['created', 'failed', 'pending']);
  expect(caught).toBeUndefined();
  for (const waitMs of [1000, 4000]) await passMs(waitMs);
  expect(outcomes()).toEqual(['created', 'failed', 'failed', 'failed', 'pending']);
  await passMs(16_000);
  expect(caught).toBe(NO_GPU);
  expect(outcomes()).not.toContain('pending');
});

/**
 * @fault Devices and engines: the Canvas is unmounted while it waits for a device
 * @consequence it asks for no further device
 */
it('asks for no GPU any more once it is unmounted', async () => {
  await show();
  await loseDevice();
  let fail = (_error: Error) => {};
  create.mockImplementation(
    () =>
      new Promise((_, reject) => {
        fail = reject;
      }),
  );
  await passMs(0);
  await act(async () => void root.render(null));
  fail(NO_GPU);
  await passMs(20_000);
  expect(create).toHaveBeenCalledTimes(2);
  expect(outcomes()).toEqual(['created', 'failed']);
  expect(vi.getTimerCount()).toBe(0);

  create.mockImplementation(async () => ({}) as never);
  await show();
  await loseDevice();
  await passMs(0);
  await loseDevice();
  await act(async () => void root.render(null));
  await passMs(20_000);
  expect(create).toHaveBeenCalledTimes(4);
  expect(outcomes().slice(2)).toEqual(['created', 'created', 'failed']);
});
