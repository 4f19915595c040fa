import fc from 'fast-check';
import { describe, expect, it } from 'vitest';
import { pathOf, viewOnPath } from '../navigate/view-path.ts';
import { cameraAxes, lookAt, type OrbitPose } from '../state/orbit-pose.ts';
import { FIRST_PATH, type SavedView } from '../state/saved-view.ts';
import { uprightnessOf } from '../state/up-axis.ts';
import { poseOnTrack } from './follow-settings.ts';
import { readSceneSettings } from './scene-settings.ts';
import { settingsOfView } from './settings-of-view.ts';
import { backgroundOf, poseOf, shorterFov } from './settings-pose.ts';
import { writeSceneSettings } from './settings-section.tsx';

// −0 is written as 0.
const number = fc.double({ min: -1e6, max: 1e6, noNaN: true }).map((value) => value + 0);
const vector = fc.tuple(number, number, number);
const fovDegrees = fc.double({ min: 1, max: 179, noNaN: true });
const pose = fc.record({ position: vector, target: vector, fovDegrees });
const channel = fc.double({ min: 0, max: 1, noNaN: true });

const POSES: readonly OrbitPose[] = [
  { target: [1, 2, 3], distance: 4, azimuth: 0.5, polar: 1.2, up: [0, 1, 0] },
  { target: [0, 2, 3], distance: 8, azimuth: 3.4, polar: 1.6, up: [0, 1, 0] },
  { target: [0, 1, 1], distance: 2, azimuth: 4, polar: 0.9, up: [0, 1, 0] },
];
const VIEWS: readonly SavedView[] = POSES.map((each) => ({
  ...{ pose: each, fovDegrees: 40, isOrthographic: false, name: '', thumbnail: '' },
  ...uprightnessOf('-y'),
}));
const PATH = pathOf({ savedViews: VIEWS, path: FIRST_PATH })!;
const SCENE = { isUpsideDown: true, aspect: 1.5, background: [0, 128 / 255, 1] } as const;

describe('settings for SuperSplat', () => {
  it('are read as they were written', () => {
    const frames = fc.uniqueArray(fc.nat(10_000), { minLength: 1, maxLength: 20 });
    const track = fc
      .record({
        frames: frames.map((each) => each.toSorted((a, b) => a - b)),
        durationS: fc.double({ min: 0.1, max: 600, noNaN: true }),
        loop: fc.constantFrom('none', 'repeat', 'pingpong' as const),
        isStepped: fc.boolean(),
        smoothness: channel,
        poses: fc.array(pose, { minLength: 20, maxLength: 20 }),
      })
      .map(({ frames, poses, ...rest }) => ({
        ...rest,
        keys: frames.map((frame, i) => ({ timeS: frame / 30, pose: poses[i] })),
      }));
    const settings = fc.record({
      camera: fc.option(pose),
      background: fc.tuple(channel, channel, channel),
      track: fc.option(track),
      annotations: fc.array(
        fc.record({ position: vector, title: fc.string(), text: fc.string(), camera: pose }),
        { maxLength: 3 },
      ),
    });
    fc.assert(
      fc.property(settings, (each) => {
        expect(readSceneSettings(writeSceneSettings(each))).toEqual(each);
      }),
    );
  });

  it('have what SuperSplat’s viewer asks for', () => {
    const written = JSON.parse(writeSceneSettings(settingsOfView(VIEWS[0], PATH, [], SCENE)));
    expect(Object.keys(written)).toEqual([
      ...['version', 'tonemapping', 'highPrecisionRendering', 'background', 'postEffectSettings'],
      ...['animTracks', 'cameras', 'annotations', 'startMode'],
    ]);
    const [{ duration, frameRate, keyframes }] = written.animTracks;
    const { times, values } = keyframes;
    expect([times[0], times.at(-1), duration * frameRate]).toEqual([0, 150, 150]);
    expect(times.every(Number.isInteger)).toBe(true);
    expect([values.position, values.target, values.fov].map(({ length }) => length / times.length)).toEqual([
      3, 3, 1,
    ]);
  });

  it('bring a view back: its place, its field of view and its background', () => {
    const { camera, background, track } = readSceneSettings(
      writeSceneSettings(settingsOfView(VIEWS[0], null, [], SCENE)),
    );
    expect(track).toBeNull();
    expect(backgroundOf(background!)).toBe('#0080ff');
    expect(shorterFov(camera!.fovDegrees, SCENE.aspect)).toBeCloseTo(40, 9);
    expectNear(poseOf(camera!), POSES[0], 1e-9);
  });

  it('move the camera along the path through the saved views', () => {
    const { track } = readSceneSettings(writeSceneSettings(settingsOfView(VIEWS[0], PATH, [], SCENE)));
    expect(track?.durationS).toBe(5);
    for (let timeS = 0; timeS <= 5; timeS += 0.06)
      expectNear(poseOf(poseOnTrack(track!, timeS)), viewOnPath(PATH, 1000 * timeS).pose, 4e-3);
  });

  it('repeat the path where it is a loop, in at most as many keys as SuperSplat takes', () => {
    const long = VIEWS.map((view) => ({ ...view, toNextMs: 60_000 }));
    const path = pathOf({ savedViews: long, path: { isLooped: true, turntable: null } })!;
    const { track } = readSceneSettings(writeSceneSettings(settingsOfView(VIEWS[0], path, [], SCENE)));
    expect(track).toMatchObject({ durationS: 180, loop: 'repeat' });
    expect(track!.keys.length).toBeLessThanOrEqual(1000);
    for (let timeS = 0; timeS < 360; timeS += 7.3)
      expectNear(poseOf(poseOnTrack(track!, timeS)), viewOnPath(path, 1000 * timeS).pose, 4e-3);
  });

  it('are about the file: turned the other way up, the camera stays where it is in it', () => {
    const { pose: shown } = VIEWS[0];
    const turned = { ...VIEWS[0], ...uprightnessOf('y') };
    const { camera } = settingsOfView(turned, null, [], SCENE);
    const { position } = lookAt(shown);
    // From the drawn scene to the file, which SuperSplat turns around z.
    for (const [i, value] of [-position[0], -position[1], position[2]].entries())
      expect(camera!.position[i]).toBeCloseTo(value, 9);
  });
});

function expectNear(actual: OrbitPose, expected: OrbitPose, part: number): void {
  const [a, b] = [lookAt(actual), lookAt(expected)];
  const offset = a.position.map((value, i) => value - b.position[i]);
  expect(Math.hypot(...offset) / expected.distance).toBeLessThan(part);
  const turn = cameraAxes(actual).back.map((value, i) => value - cameraAxes(expected).back[i]);
  expect(Math.hypot(...turn)).toBeLessThan(part);
}
