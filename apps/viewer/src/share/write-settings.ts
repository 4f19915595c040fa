import type { CameraTrack, SceneSettings, SettingsPose } from './scene-settings.ts';

/** Of a track's times: SuperSplat counts frames. */
const FRAMES_PER_S = 30;

/** Effects that SuperSplat's viewer wants to have told: all are off. */
const NO_EFFECTS = {
  sharpness: { enabled: false, amount: 0 },
  bloom: { enabled: false, intensity: 0.1, blurLevel: 2 },
  grading: { enabled: false, brightness: 1, contrast: 1, saturation: 1, tint: [1, 1, 1] },
  vignette: { enabled: false, intensity: 0.5, inner: 0.3, outer: 0.75, curvature: 1 },
  fringing: { enabled: false, intensity: 0.5 },
};

/**
 * Writes SuperSplat's `settings.json`, version 2: what `readSceneSettings` reads again, with the
 * times of keys at whole frames, 30 a second. A movement begins by itself.
 */
export function writeSceneSettings({ camera, background, track, annotations }: SceneSettings): string {
  return JSON.stringify({
    version: 2,
    // Colours are shown as they are.
    tonemapping: 'none',
    highPrecisionRendering: false,
    background: { color: background ?? [0, 0, 0] },
    postEffectSettings: NO_EFFECTS,
    animTracks: track ? [trackJson(track)] : [],
    cameras: camera ? [cameraJson(camera)] : [],
    annotations: annotations.map((each) => ({ ...each, extras: {}, camera: cameraJson(each.camera) })),
    startMode: track ? 'animTrack' : 'default',
  });
}

function cameraJson({ position, target, fovDegrees }: SettingsPose) {
  return { initial: { position, target, fov: fovDegrees } };
}

function trackJson({ durationS, loop, isStepped, smoothness, keys }: CameraTrack) {
  return {
    name: 'path',
    duration: durationS,
    frameRate: FRAMES_PER_S,
    loopMode: loop,
    interpolation: isStepped ? 'step' : 'spline',
    smoothness,
    keyframes: {
      times: keys.map(({ timeS }) => Math.round(timeS * FRAMES_PER_S)),
      values: {
        position: keys.flatMap(({ pose }) => pose.position),
        target: keys.flatMap(({ pose }) => pose.target),
        fov: keys.map(({ pose }) => pose.fovDegrees),
      },
    },
  };
}
