import { describe, expect, it } from 'vitest';
import { FieldError } from '../state/json-fields.ts';
import { readSceneSettings } from './scene-settings.ts';

const TRACK = {
  name: 'round',
  duration: 2,
  frameRate: 30,
  loopMode: 'pingpong',
  interpolation: 'spline',
  smoothness: 1,
  keyframes: {
    times: [0, 30],
    values: { position: [0, 0, 1, 0, 0, 2], target: [0, 0, 0, 1, 1, 1], fov: [60, 70] },
  },
};
const SECOND = {
  version: 2,
  background: { color: [0, 0.5, 1] },
  cameras: [{ initial: { position: [1, 2, 3], target: [0, 0, 0], fov: 75 } }],
  animTracks: [TRACK],
  startMode: 'default',
};
const FIRST = {
  camera: { fov: 50, position: [1, 2, 3], target: [0, 0, 0], startAnim: 'none', animTrack: null },
  background: { color: [0, 0, 0] },
  animTracks: [],
};
const read = (settings: unknown) => readSceneSettings(JSON.stringify(settings));

describe('settings of SuperSplat', () => {
  it('have a camera and a background, in either version', () => {
    expect(read(SECOND)).toEqual({
      camera: { position: [1, 2, 3], target: [0, 0, 0], fovDegrees: 75 },
      background: [0, 0.5, 1],
      track: null,
      annotations: [],
    });
    expect(read(FIRST)).toEqual({
      camera: { position: [1, 2, 3], target: [0, 0, 0], fovDegrees: 50 },
      background: [0, 0, 0],
      track: null,
      annotations: [],
    });
  });

  it('need not have a camera', () => {
    const camera = { position: null, target: null };
    expect(read({ camera, background: {} })).toEqual({
      camera: null,
      background: null,
      track: null,
      annotations: [],
    });
    expect(read({ ...SECOND, cameras: [] }).camera).toBeNull();
  });

  it('have the movement that begins by itself, with times in seconds', () => {
    const { track } = read({ ...SECOND, startMode: 'animTrack' });
    expect(track).toEqual({
      durationS: 2,
      loop: 'pingpong',
      isStepped: false,
      smoothness: 1,
      keys: [
        { timeS: 0, pose: { position: [0, 0, 1], target: [0, 0, 0], fovDegrees: 60 } },
        { timeS: 1, pose: { position: [0, 0, 2], target: [1, 1, 1], fovDegrees: 70 } },
      ],
    });
    expect(read({ ...SECOND, startMode: 'animTrack', animTracks: [] }).track).toBeNull();
  });

  it('of the first version name the movement, whose field of view is the camera’s', () => {
    const camera = { ...FIRST.camera, startAnim: 'animTrack', animTrack: 'round' };
    const other = { ...TRACK, name: 'other', duration: 9 };
    const { track } = read({ ...FIRST, camera, animTracks: [other, TRACK] });
    expect(track?.durationS).toBe(2);
    expect(track?.keys.map(({ pose }) => pose.fovDegrees)).toEqual([50, 50]);
    const { frameRate: _, smoothness: __, ...early } = TRACK;
    const { track: first } = read({ ...FIRST, camera, animTracks: [early] });
    expect(first?.smoothness).toBe(0);
    expect(first?.keys.map(({ timeS }) => timeS)).toEqual([0, 30]);
  });

  const withTrack = (change: object) => ({
    ...SECOND,
    startMode: 'animTrack',
    animTracks: [{ ...TRACK, ...change }],
  });
  /**
   * @fault Arguments: a `settings.json` with any value or depth
   * @consequence the message names the field, and shows the beginning of the value
   */
  it.each<readonly [unknown, string]>([
    [{ ...SECOND, version: 3 }, 'version is 3, but must be 2, or absent'],
    [[], 'The file is [], but must be an object'],
    [{ ...SECOND, background: { color: 'red' } }, 'background.color is "red", but must be a list'],
    [
      { ...SECOND, background: { color: [0, 0] } },
      'background.color is [0, 0], but must be a list of 3 numbers',
    ],
    [
      { ...SECOND, annotations: [{ position: [0, -1e308, 0], title: '', text: '' }] },
      'annotations[0].position[1] is -1e+308, but must be a number of float32',
    ],
    [{ ...SECOND, background: { color: [0, 0, null] } }, 'background.color[2] is null, but must be a number'],
    [{ ...SECOND, cameras: undefined }, 'cameras is missing, but must be a list'],
    [
      { ...SECOND, cameras: [{ initial: { position: [0, 0, 0], target: [1, 0, 0], fov: 180 } }] },
      'cameras[0].initial.fov is 180, but must be degrees above 0 and below 180',
    ],
    [{ ...FIRST, camera: 1 }, 'camera is 1, but must be an object'],
    [{ ...SECOND, annotations: [{ position: [0, 0, 0], title: 1 }] }, 'title is 1, but must be a string'],
    [
      { ...SECOND, annotations: [{ position: [0, 0, 0], title: '', text: '' }] },
      'annotations[0].camera is missing, but must be an object',
    ],
    [withTrack({ loopMode: 'twice' }), 'loopMode is "twice", but must be one of none, repeat, pingpong'],
    [withTrack({ duration: 0 }), 'duration is 0, but must be above 0'],
    [withTrack({ keyframes: { ...TRACK.keyframes, times: [1, 1] } }), 'each is larger than the one before'],
    [
      withTrack({ keyframes: { times: [0], values: TRACK.keyframes.values } }),
      'keyframes.values.position is [0, 0, 1, 0, 0, 2], but must be a list of 3 numbers',
    ],
  ])('are refused where %j does not fit', (settings, message) => {
    expect(() => read(settings)).toThrow(FieldError);
    expect(() => read(settings)).toThrow(message);
  });

  it('are refused where they are no JSON, of which little is shown', () => {
    expect(() => readSceneSettings('<html>')).toThrow('The file is "<html>", but must be JSON.');
    expect(() => readSceneSettings(`<${'x'.repeat(1000)}`)).toThrow(/x…, but must be JSON/);
    const deep = '['.repeat(10_000) + ']'.repeat(10_000);
    expect(() => readSceneSettings(`{"version":${deep}}`)).toThrow(/^version is \[{80}…, but must be 2/);
  });
});
