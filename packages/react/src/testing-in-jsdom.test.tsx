// @vitest-environment jsdom
// A user's tests of a whole page in jsdom.
import { Canvas } from '@react-three/fiber';
import { encodePly } from '@websplatter/core';
import { splatsFromArrays } from '@websplatter/core/own-data';
import { createRef, Suspense } from 'react';
import { createRoot, type Root } from 'react-dom/client';
import { afterEach, beforeEach, expect, it, vi } from 'vitest';
import { SplatAnnotation, SplatBounds, SplatStats } from './components.ts';
import { SplatCanvas, type SplatCloudObject, Splats, SplatsErrorBoundary, useSplats } from './index.ts';
import { installNullRenderer } from './testing.ts';

const file = encodePly(
  splatsFromArrays({ positions: [1, 2, 3], scales: [0.1, 0.1, 0.1], colors: [1, 0, 0] }),
);

let uninstall = () => {};
let root: Root;
let container: HTMLElement;

/** jsdom lays nothing out: every element has this size. */
class FixedSizes {
  readonly #report: () => void;
  constructor(report: () => void) {
    this.#report = report;
  }
  observe() {
    queueMicrotask(this.#report);
  }
  unobserve() {}
  disconnect() {}
}

beforeEach(() => {
  vi.stubGlobal('ResizeObserver', FixedSizes);
  vi.spyOn(Element.prototype, 'getBoundingClientRect').mockReturnValue(new DOMRect(0, 0, 300, 200));
  vi.stubGlobal('fetch', async () => new Response(file as Uint8Array<ArrayBuffer>));
  // three logs that it is imported twice.
  vi.spyOn(console, 'warn').mockImplementation(() => {});
  uninstall = installNullRenderer();
  container = document.createElement('div');
  document.body.append(container);
  root = createRoot(container);
});
afterEach(() => {
  root.unmount();
  container.remove();
  useSplats.clear();
  uninstall();
  vi.unstubAllGlobals();
  vi.restoreAllMocks();
});

it('shows the page around a <SplatCanvas>, with its cloud and labels, and changes it', async () => {
  const ref = createRef<SplatCloudObject>();
  const [onFirstFrame, onChange] = [vi.fn(), vi.fn()];
  function Page({ accuracy = 'balanced' }: { accuracy?: 'balanced' | 'high' }) {
    return (
      <SplatsErrorBoundary fallback="no WebGPU">
        <h1>Garden</h1>
        <SplatCanvas accuracy={accuracy} poster="garden.jpg" posterAlt="A garden">
          <Suspense>
            <SplatBounds onChange={onChange}>
              <Splats ref={ref} src="/garden.ply" position={[1, 0, 0]} onFirstFrame={onFirstFrame} />
            </SplatBounds>
          </Suspense>
          <SplatAnnotation position={[0, 1, 0]}>A tree</SplatAnnotation>
          <SplatStats />
        </SplatCanvas>
      </SplatsErrorBoundary>
    );
  }
  root.render(<Page />);
  await expect.poll(() => onFirstFrame).toHaveBeenCalled();
  expect(ref.current).toMatchObject({ type: 'SplatCloudObject', isSplatCloudObject: true });
  expect(ref.current!.data!.count).toBe(1);
  expect(onChange.mock.calls[0][0].box().max.toArray()).toEqual([2, 2, 3]);
  expect(container.textContent).toContain('A tree');
  expect(container.textContent).not.toContain('no WebGPU');
  await expect.poll(() => container.querySelector('img')).toBeNull();
  expect(container.querySelector('canvas')).not.toBeNull();
  expect(console.warn, 'without a framing').not.toHaveBeenCalledWith(expect.any(Error));
  root.render(<Page accuracy="high" />);
  expect(container.textContent).toContain('Garden');
});

it('shows splats in any Canvas', async () => {
  const ref = createRef<SplatCloudObject>();
  const [onLoad, render] = [vi.fn(), vi.fn()];
  const gl = { render, setSize() {}, setPixelRatio() {} };
  root.render(
    <Canvas gl={() => gl as never}>
      <Splats ref={ref} src="/garden.ply" onLoad={onLoad} />
    </Canvas>,
  );
  await expect.poll(() => onLoad).toHaveBeenCalled();
  expect(ref.current!.data!.count).toBe(1);
});

it('shows the fallback in place of a Canvas whose file does not exist', async () => {
  vi.stubGlobal('fetch', async () => new Response('', { status: 404, statusText: 'Not Found' }));
  vi.spyOn(console, 'error').mockImplementation(() => {});
  root.render(
    <>
      <h1>Garden</h1>
      <SplatsErrorBoundary fallback={({ message }) => message}>
        <SplatCanvas>
          <Splats src="/nowhere.ply" />
        </SplatCanvas>
      </SplatsErrorBoundary>
    </>,
  );
  await expect.poll(() => container.textContent).toMatch(/^Garden.*nowhere\.ply.*404 Not Found/);
});

it('shows the fallback without the null renderer, as browsers without WebGPU do', async () => {
  uninstall();
  vi.spyOn(console, 'error').mockImplementation(() => {});
  root.render(
    <SplatsErrorBoundary fallback="no WebGPU">
      <SplatCanvas>
        <Splats src="/garden.ply" />
      </SplatCanvas>
    </SplatsErrorBoundary>,
  );
  await expect.poll(() => container.textContent).toBe('no WebGPU');
});
