// A user's tests under `@react-three/test-renderer`, in Node without a document.
import { advance } from '@react-three/fiber';
import { create, waitFor } from '@react-three/test-renderer';
import { encodePly, InvalidArgumentError } from '@websplatter/core';
import { splatsFromArrays } from '@websplatter/core/own-data';
import { act, createRef, type ReactNode, Suspense } from 'react';
import { afterEach, beforeEach, expect, it, vi } from 'vitest';
import { SplatBounds } from './components.ts';
import { useSplatsLoad } from './hooks.ts';
import { type SplatCloudObject, Splats, SplatsUnsupportedRendererError, useSplats } from './index.ts';
import { installNullRenderer } from './testing.ts';

const file = encodePly(
  splatsFromArrays({
    positions: [0, 0, 0, 1, 2, 3],
    scales: [0.1, 0.1, 0.1, 0.1, 0.1, 0.1],
    colors: [1, 0, 0, 0, 0, 1],
  }),
);

const PROPS = { opacity: 0.5, tint: [1, 0.5, 0] } as const;

let uninstall = () => {};
let tested: Awaited<ReturnType<typeof create>> | undefined;

beforeEach(() => {
  vi.stubGlobal('IS_REACT_ACT_ENVIRONMENT', true);
  // three logs that it is imported twice.
  vi.spyOn(console, 'warn').mockImplementation(() => {});
  vi.stubGlobal('fetch', async () => new Response(file as Uint8Array<ArrayBuffer>));
  // Addresses are relative to the page's.
  vi.stubGlobal('location', new URL('https://example.org/'));
  uninstall = installNullRenderer();
});
afterEach(async () => {
  await tested?.unmount();
  tested = undefined;
  useSplats.clear();
  uninstall();
  vi.unstubAllGlobals();
  vi.restoreAllMocks();
});

async function show(children: ReactNode) {
  tested = await create(<Suspense>{children}</Suspense>);
  return tested;
}
/** The test's own limit is longer than that of `waitFor`. */
const until = (isThere: () => boolean) => waitFor(isThere, { timeout: 0 });
const frame = () => act(async () => advance(0));

it('has the object of <Splats> in its tree, which loads and reports', async () => {
  const ref = createRef<SplatCloudObject>();
  const [onLoad, onFirstFrame, onComplete] = [vi.fn(), vi.fn(), vi.fn()];
  const { scene, update, fireEvent } = await show(
    <Splats
      ref={ref}
      src="garden.ply"
      name="garden"
      position={[1, 2, 3]}
      {...PROPS}
      onLoad={onLoad}
      onFirstFrame={onFirstFrame}
      onComplete={onComplete}
    />,
  );
  await until(() => onLoad.mock.calls.length > 0);
  const cloud = scene.findByProps({ name: 'garden' });
  expect(cloud.type).toBe('SplatCloudObject');
  expect(cloud.instance).toBe(ref.current);
  expect(cloud.instance.position.toArray()).toEqual([1, 2, 3]);
  const { opacity, tint, visible, data } = ref.current!;
  expect({ opacity, tint, visible, count: data!.count }).toEqual({ ...PROPS, visible: true, count: 2 });
  expect(onLoad).toHaveBeenCalledExactlyOnceWith(data);

  expect(onFirstFrame).not.toHaveBeenCalled();
  await frame();
  await frame();
  expect(onFirstFrame).toHaveBeenCalledOnce();
  expect(onComplete).toHaveBeenCalledOnce();
  expect(await ref.current!.pickAt({ clientX: 10, clientY: 10 })).toBeNull();

  const onClick = vi.fn();
  await update(<Splats ref={ref} src="garden.ply" name="garden" onClick={onClick} />);
  await fireEvent(scene.findByProps({ name: 'garden' }), 'click');
  expect(onClick).toHaveBeenCalledOnce();

  const object = ref.current!;
  await update(null);
  expect(scene.children).toEqual([]);
  expect(object.parent).toBeNull();
});

it('reads files by hooks, and shows clouds in bounds', async () => {
  const statuses = new Set<string>();
  function Garden() {
    const { status } = useSplatsLoad('garden.ply');
    statuses.add(status);
    const splats = useSplats('garden.ply');
    return <Splats src={splats} userData={{ count: splats.count }} />;
  }
  const { scene } = await show(
    <SplatBounds>
      <Garden />
    </SplatBounds>,
  );
  await until(() => scene.findAllByType('SplatCloudObject').length > 0);
  expect(scene.findByType('SplatCloudObject').props.userData).toEqual({ count: 2 });
  expect([...statuses]).toEqual(['pending', 'loaded']);
  await frame();
});

it('tells of files that cannot be read, and of props that are refused', async () => {
  vi.stubGlobal('fetch', async () => new Response('', { status: 404, statusText: 'Not Found' }));
  const onError = vi.fn();
  await show(<Splats src="missing.ply" onError={onError} />);
  await until(() => onError.mock.calls.length > 0);
  expect(onError.mock.calls[0][0]).toMatchObject({ name: 'SplatSourceError' });
  vi.spyOn(console, 'error').mockImplementation(() => {});
  await expect(show(<Splats opacity={Number.NaN} />)).rejects.toThrow(InvalidArgumentError);
});

it('refuses its WebGLRenderer in tests that do not install the null renderer', async () => {
  uninstall();
  vi.spyOn(console, 'error').mockImplementation(() => {});
  const refused = show(<Splats src="garden.ply" />);
  await expect(refused).rejects.toThrow(SplatsUnsupportedRendererError);
  const { scene } = await show(<Splats src="garden.ply" fallback={<group name="fallback" />} />);
  expect(scene.findByProps({ name: 'fallback' })).toBeDefined();
});
