import fc from 'fast-check';
import { describe, expect, it } from 'vitest';
import { expectClose, FRONT } from '../camera/orbit-pose.fixture.ts';
import { cameraAxes, lookAt, type OrbitPose } from '../state/orbit-pose.ts';
import { FIRST_PATH, type SavedView } from '../state/saved-view.ts';
import { normalize } from '../state/vec3.ts';
import { type CameraPath, keyAt, pathOf, pathThrough, viewOnPath } from './view-path.ts';

const coordinate = fc.double({ min: -100, max: 100, noNaN: true });
const poseWith = (up: fc.Arbitrary<OrbitPose['up']>): fc.Arbitrary<OrbitPose> =>
  fc.record({
    target: fc.tuple(coordinate, coordinate, coordinate),
    distance: fc.double({ min: 0.1, max: 100, noNaN: true }),
    azimuth: fc.double({ min: -20, max: 20, noNaN: true }),
    polar: fc.double({ min: 0.02, max: 3.12, noNaN: true }),
    up,
  });
const UPRIGHT = poseWith(fc.constant([0, 1, 0]));
const ROLLED = poseWith(fc.constantFrom([0, 1, 0], [0, 0, 1], normalize([1, 2, 3])));

const view = (pose: OrbitPose, change: Partial<SavedView> = {}): SavedView => ({
  ...{ pose, fovDegrees: 50, isOrthographic: false, isFlipped: false, isZUp: false },
  ...{ name: '', thumbnail: null, ...change },
});
const path = (views: readonly SavedView[], isLooped = false) =>
  pathOf({ savedViews: views, path: { ...FIRST_PATH, isLooped } })!;

/** Any path, with any times and ways to pass views. */
const paths = (pose: fc.Arbitrary<OrbitPose>): fc.Arbitrary<CameraPath> =>
  fc
    .tuple(
      fc.array(
        fc.record({
          pose,
          toNextMs: fc.integer({ min: 100, max: 9000 }),
          passing: fc.constantFrom('through', 'stop', 'cut' as const),
        }),
        { minLength: 2, maxLength: 6 },
      ),
      fc.boolean(),
    )
    .map(([views, isLooped]) =>
      path(
        views.map((each) => view(each.pose, each)),
        isLooped,
      ),
    );

describe('a path through views', () => {
  it('is none of fewer than two', () => {
    for (const savedViews of [[], [view(FRONT)]]) expect(pathOf({ savedViews, path: FIRST_PATH })).toBeNull();
  });

  it.each([
    ['around their targets', UPRIGHT],
    ['of other ways up', ROLLED],
  ])('passes every view at its time, %s', (_, pose) => {
    fc.assert(
      fc.property(paths(pose), (each) => {
        for (const { view: key, atMs } of each.keys) {
          const { pose: seen } = viewOnPath(each, atMs);
          expectClose(lookAt(seen).position, lookAt(key.pose).position, 1e-6);
          for (const axis of ['right', 'above', 'back'] as const)
            expectClose(cameraAxes(seen)[axis], cameraAxes(key.pose)[axis], 1e-6);
        }
      }),
    );
  });

  it.each([
    ['around their targets', UPRIGHT],
    ['of other ways up', ROLLED],
  ])('jumps at cuts only, %s', (_, pose) => {
    fc.assert(
      fc.property(paths(pose), fc.double({ min: 0, max: 1, noNaN: true }), (each, part) => {
        const timeMs = part * each.durationMs;
        const isHeld = each.keys[keyAt(each, timeMs)].passing === 'cut';
        const [here, next] = [0, 1e-5].map((ms) => viewOnPath(each, timeMs + ms).pose);
        if (isHeld && keyAt(each, timeMs) !== keyAt(each, timeMs + 1e-5)) return;
        expect(here.distance).toBeGreaterThan(0);
        expectClose(lookAt(next).position, lookAt(here).position, 0.02);
        expectClose(cameraAxes(next).back, cameraAxes(here).back, 0.02);
      }),
    );
  });

  it('sets out slowly, goes on at an even pace, and comes to rest slowly', () => {
    const even = path([0, 1, 2, 3].map((azimuth) => view({ ...FRONT, azimuth })));
    expect(even.durationMs).toBe(7500);
    const at = (timeMs: number) => viewOnPath(even, timeMs).pose.azimuth;
    expect(at(10)).toBeLessThan(1e-4);
    expect(3 - at(7490)).toBeLessThan(1e-4);
    expect(at(2500 + 625)).toBeCloseTo(1.25, 9);
    expect([at(-1), at(1e6)]).toEqual([0, 3]);
    for (let ms = 0; ms < 7500; ms += 50) expect(at(ms + 50)).toBeGreaterThanOrEqual(at(ms));
  });

  it('stops at a view, or holds it until it jumps', () => {
    const poses = [0, 1, 2].map((azimuth) => ({ ...FRONT, azimuth }));
    const speedAtSecond = (passing: SavedView['passing']) => {
      const each = path(poses.map((pose, i) => view(pose, i === 1 ? { passing } : {})));
      return viewOnPath(each, 2510).pose.azimuth - viewOnPath(each, 2490).pose.azimuth;
    };
    expect(speedAtSecond('through')).toBeCloseTo(20 / 2500, 4);
    expect(speedAtSecond('stop')).toBeLessThan(1e-4);
    const cut = path(poses.map((pose, i) => view(pose, i === 1 ? { passing: 'cut' } : {})));
    expect([4999, 5000].map((ms) => viewOnPath(cut, ms).pose.azimuth)).toEqual([1, 2]);
  });

  it('takes the times that its views have', () => {
    const each = path([
      view(FRONT, { toNextMs: 1000 }),
      view({ ...FRONT, azimuth: 1 }, { toNextMs: 4000 }),
      view({ ...FRONT, azimuth: 3 }),
    ]);
    expect(each.keys.map(({ atMs }) => atMs)).toEqual([0, 1000, 5000]);
    expect([1, 999, 1001, 4999].map((ms) => keyAt(each, ms))).toEqual([0, 0, 1, 1]);
    // The pace before and after a view is the same, whatever the times.
    const [before, at, after] = [999, 1000, 1001].map((ms) => viewOnPath(each, ms).pose.azimuth);
    expect(after - at).toBeCloseTo(at - before, 5);
  });

  it('goes on from the last view to the first where it is looped, without a halt', () => {
    const each = path(
      [0, 1, 2, 3].map((i) => view({ ...FRONT, azimuth: (i * Math.PI) / 2 })),
      true,
    );
    expect(each.durationMs).toBe(10_000);
    const azimuths = [9999, 10_000, 10_001].map((ms) => viewOnPath(each, ms).pose.azimuth);
    const turn = 2 * Math.PI;
    const wrapped = (radians: number) => ((radians % turn) + turn) % turn;
    expect(wrapped(azimuths[2] - azimuths[0])).toBeCloseTo((turn * 2) / 10_000, 9);
    expect(viewOnPath(each, 12_500).pose).toEqual(viewOnPath(each, 2500).pose);
  });

  it('turns by the shorter way round', () => {
    const each = path([view(FRONT), view({ ...FRONT, azimuth: 2 * Math.PI - 0.2 })]);
    expect(viewOnPath(each, 1250).pose.azimuth).toBeCloseTo(-0.1);
  });

  it('rolls over to views of the scene turned upside down: they show the same', () => {
    const each = path([view(FRONT), view({ ...FRONT, azimuth: 0.5 }, { isFlipped: true })]);
    const last = viewOnPath(each, each.durationMs);
    expect(last.isFlipped).toBe(false);
    // Seen in the scene as the first view has it: half a turn around x.
    const [x, y, z] = lookAt({ ...FRONT, azimuth: 0.5 }).position;
    expectClose(lookAt(last.pose).position, [x, -y, -z]);
    expectClose(cameraAxes(last.pose).above, [0, -1, 0]);
  });

  it('zooms between views of other fields of view', () => {
    const each = path([view(FRONT, { fovDegrees: 20 }), view(FRONT, { fovDegrees: 60 })]);
    expect([0, 1250, 2500].map((ms) => viewOnPath(each, ms).fovDegrees)).toEqual([20, 40, 60]);
  });
});

describe('a turntable', () => {
  const turntable = { view: view({ ...FRONT, azimuth: 0.3, polar: 1.2 }), durationMs: 10_000 };
  const each = pathOf({ savedViews: [], path: { isLooped: false, turntable } })!;

  it('goes once around at an even pace and height, without a saved view', () => {
    expect(each.durationMs).toBe(10_000);
    for (let ms = 0; ms < 10_000; ms += 370) {
      const { pose } = viewOnPath(each, ms);
      const turn = ((pose.azimuth - 0.3) / (2 * Math.PI)) % 1;
      expect((turn + 1) % 1).toBeCloseTo(ms / 10_000, 9);
      expect([pose.polar, pose.distance]).toEqual([expect.closeTo(1.2, 9), expect.closeTo(10, 9)]);
    }
  });

  it('is in the place of the path through saved views', () => {
    const savedViews = [view(FRONT), view({ ...FRONT, distance: 3 })];
    expect(pathOf({ savedViews, path: { isLooped: false, turntable } })).toEqual(each);
    expect(pathThrough(each.keys, true)).toEqual(each);
  });
});
