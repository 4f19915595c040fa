import { createRoot } from '@react-three/fiber';
import type { SplatInstances as Instances } from '@websplatter/three';
import { act, createElement } from 'react';
import { Color, Matrix4 } from 'three';
import { afterEach, beforeEach, expect, it, vi } from 'vitest';
import { SplatInstances, type SplatInstancesProps } from './splat-instances.tsx';

const shown = vi.hoisted(() => ({
  props: {} as { readonly instances?: unknown; readonly opacity?: number },
}));

// `<Splats>` is tested by itself: here it only notes its props.
vi.mock('./splats.tsx', () => ({
  Splats: (props: object) => {
    shown.props = props;
    return null;
  },
}));

let root: ReturnType<typeof createRoot>;

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

async function instancesOf(props: SplatInstancesProps): Promise<Instances> {
  await act(async () => root.render(createElement(SplatInstances, props)));
  return shown.props.instances as Instances;
}

const matrices = [1, 2].flatMap((x) => new Matrix4().makeTranslation(x, 0, 0).elements);

it('are as the lists say, and follow them', async () => {
  const instances = await instancesOf({
    matrices,
    tints: ['#336699', [2, 1, 0]],
    opacities: [0.5, 1],
    opacity: 0.7,
  });
  expect(shown.props.opacity).toBe(0.7);
  expect(instances.count).toBe(2);
  expect(Array.from(instances.matrices)).toEqual(matrices);
  expect(instances.getColorAt(0, new Color()).getHexString()).toBe('336699');
  expect(Array.from(instances.drawn().tints!).slice(3)).toEqual(
    [2, 1, 0].map((value) => expect.closeTo(value, 4)),
  );
  expect([0, 1].map((i) => instances.getOpacityAt(i))).toEqual([0.5, 1]);
  const { version } = instances;

  expect(await instancesOf({ matrices: matrices.toReversed(), tints: ['red', 'white'] })).toBe(instances);
  expect(Array.from(instances.matrices)).toEqual(matrices.toReversed());
  expect(instances.version).toBeGreaterThan(version);
  expect(instances.getColorAt(0, new Color()).getHexString()).toBe('ff0000');
  expect(instances.opacities).toBeNull();
  await instancesOf({ matrices });
  expect(instances.colors).toBeNull();
});

it('keep what is set on them while their number stays', async () => {
  const instances = await instancesOf({ count: 3 });
  instances.setMatrixAt(2, new Matrix4().makeTranslation(5, 0, 0));
  instances.setOpacityAt(2, 0.25);
  expect(await instancesOf({ count: 3, opacity: 0.5 })).toBe(instances);
  expect([instances.matrices[44], instances.getOpacityAt(2)]).toEqual([5, 0.25]);
  const others = await instancesOf({ count: 4 });
  expect(others).not.toBe(instances);
  expect(others.count).toBe(4);
});
