import { perspectiveCamera } from '@websplatter/core';
import { beforeEach, expect, it, vi } from 'vitest';
import type { PanelProps } from '../engine/viewer.ts';
import { createViewerStore, type ViewerStore } from '../state/store.ts';
import type { Vec3 } from '../state/vec3.ts';
import { followMarkers } from './annotation-markers.tsx';

/** Ten units in front of the origin. */
const camera = perspectiveCamera({
  ...{ position: [0, 0, 10], target: [0, 0, 0], up: [0, 1, 0] },
  ...{ fovYDegrees: 90, aspect: 2, near: 0.1, far: 100 },
});

let store: ViewerStore;
const coverageOf = vi.fn();

class Marker {
  readonly style = { translate: '' };
  readonly names = new Set<string>();
  toggleAttribute(name: string, isOn = !this.names.has(name)): boolean {
    if (isOn) this.names.add(name);
    else this.names.delete(name);
    return isOn;
  }
}

/** As the viewer asks the view of the frame on the screen. */
const askShown = (ask: (view: object) => unknown) => ask({ coverage: coverageOf });

/** Follows these places in a picture of 400 × 200 px. */
function follow(...points: readonly Vec3[]) {
  const markers = points.map(() => new Marker());
  const viewer = { shownFrame: { frame: { camera }, isFlipped: false }, askShown };
  const panel = { store, viewer } as unknown as PanelProps;
  return {
    viewer,
    markers,
    stop: followMarkers(panel, markers, points, () => ({ width: 400, height: 200 })),
  };
}

beforeEach(() => {
  vi.clearAllMocks();
  coverageOf.mockResolvedValue(null);
  store = createViewerStore();
});

it('markers are where their places are seen, and hidden outside of the picture', () => {
  const { viewer, markers } = follow([5, 0, 0], [0, 0, 20], [30, 0, 0]);
  expect(markers[0].style.translate).toBe('250.0px 100.0px');
  expect(markers.map(({ names }) => names.has('hidden'))).toEqual([false, true, true]);
  // The frame on the screen counts, not what is asked for.
  store.setState({ isFlipped: true, lastRender: { elapsedMs: 1 } });
  expect(markers[1].names.has('hidden')).toBe(true);
  viewer.shownFrame.isFlipped = true;
  store.setState({ shownFrames: 1 });
  expect(markers[1].names.has('hidden')).toBe(false);
});

it('at rest, those behind splats are marked, but not those on the splats themselves', async () => {
  store.setState({ isIdle: false });
  const { markers, stop } = follow([0, 0, 0], [5, 0, 0], [-5, 0, 0]);
  expect(coverageOf).not.toHaveBeenCalled();
  coverageOf.mockImplementation(async (asked) =>
    asked.map(({ point }: { point: Vec3 }) => ({ isInImage: true, opacity: point[0] > 0 ? 0.9 : 0.2 })),
  );
  store.setState({ restedFrames: 1, isIdle: true });
  await expect.poll(() => coverageOf).toHaveBeenCalledTimes(1);
  // All of them at once, each with some tolerance in front of its surface.
  expect(coverageOf.mock.calls[0][0]).toEqual(
    [0, 5, -5].map((x) => ({ point: [x, 0, 0], tolerance: expect.closeTo(0.3) })),
  );
  await expect.poll(() => markers.map(({ names }) => names.has('data-behind'))).toEqual([false, true, false]);
  stop();
  store.setState({ restedFrames: 2 });
  expect(coverageOf).toHaveBeenCalledTimes(1);
});
