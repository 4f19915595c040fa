import { createRoot } from '@react-three/fiber';
import { InvalidArgumentError } from '@websplatter/core';
import type { SplatVolumeObject } from '@websplatter/three';
import { act, createElement, createRef } from 'react';
import { Color } from 'three';
import { afterEach, beforeEach, expect, it, vi } from 'vitest';
import { SplatVolume, type SplatVolumeProps } from './splat-volume.tsx';

let root: ReturnType<typeof createRoot>;
const ref = createRef<SplatVolumeObject>();

beforeEach(async () => {
  vi.stubGlobal('IS_REACT_ACT_ENVIRONMENT', true);
  // three warns of what react-three-fiber still uses of it.
  vi.spyOn(console, 'warn').mockImplementation(() => {});
  const canvas = { addEventListener() {}, removeEventListener() {} } as unknown as HTMLCanvasElement;
  root = createRoot(canvas);
  const gl = {
    render() {},
    setSize() {},
    setPixelRatio() {},
    shadowMap: {},
    xr: { addEventListener() {}, removeEventListener() {} },
  };
  const size = { width: 96, height: 64, top: 0, left: 0 };
  await root.configure({ gl: gl as never, frameloop: 'never', size, dpr: 1 });
});

afterEach(async () => {
  await act(async () => root.unmount());
  vi.unstubAllGlobals();
  vi.restoreAllMocks();
});

async function volumeOf(props: SplatVolumeProps): Promise<SplatVolumeObject> {
  await act(async () => root.render(createElement(SplatVolume, { ...props, ref })));
  return ref.current!;
}

it('is an object of the scene with these properties, which follow the props', async () => {
  const volume = await volumeOf({
    ...{ shape: 'capsule', mode: 'tint', tint: 'red', height: 2, softEdge: 0.2, invert: true },
    ...{ position: [1, 2, 3], scale: 0.5 },
  });
  expect(volume.isSplatVolumeObject).toBe(true);
  expect(volume).toMatchObject({ shape: 'capsule', mode: 'tint', tint: [1, 0, 0], height: 2, softEdge: 0.2 });
  expect(volume.position.toArray()).toEqual([1, 2, 3]);
  expect(volume.scale.toArray()).toEqual([0.5, 0.5, 0.5]);
  const blue = new Color('blue');
  expect(await volumeOf({ shape: 'box', mode: 'tint', tint: blue, size: [1, 2, 3] })).toBe(volume);
  expect(volume).toMatchObject({ shape: 'box', tint: [0, 0, 1], size: [1, 2, 3], height: 1, invert: false });
  await volumeOf({ tint: 'lime', offset: [0, 1, 0], mode: 'displace' });
  expect(volume).toMatchObject({ tint: [0, 1, 0], offset: [0, 1, 0], size: [1, 1, 1], softEdge: 0 });
  expect(blue.getHexString()).toBe('0000ff');
});

it('has a parent and children like any object', async () => {
  const parent = createRef<SplatVolumeObject>();
  const child = createElement(SplatVolume, { ref, name: 'child' });
  await act(async () => root.render(createElement(SplatVolume, { ref: parent }, child)));
  expect(parent.current!.children).toEqual([ref.current]);
  await act(async () => root.render(createElement(SplatVolume, { ref: parent })));
  expect(parent.current!.children).toEqual([]);
});

it('clamps what springs overshoot, and refuses what is no volume', () => {
  const render = (props: object) => SplatVolume(props as SplatVolumeProps);
  expect(() => render({ radius: -0.1, softEdge: -0.1, mode: 'fade', opacity: 1.1 })).not.toThrow();
  for (const [props, message] of [
    [{ shape: 'cone' }, 'shape is cone'],
    [{ mode: 'erase' }, 'mode is erase'],
    [{ shape: 'sphere', radius: Number.NaN }, 'radius is NaN'],
    [{ mode: 'displace', offset: [1, 2] }, 'offset is [1, 2]'],
    [{ softEdge: Number.POSITIVE_INFINITY }, 'softEdge is Infinity'],
  ] as const) {
    expect(() => render(props)).toThrow(InvalidArgumentError);
    expect(() => render(props)).toThrow(message);
  }
});
