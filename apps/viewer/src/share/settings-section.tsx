import { TextButton } from '@websplatter/kit/controls';
import { formatBytes } from '@websplatter/kit/format';
import { saveFile } from '@websplatter/kit/take-away';
import { useStore } from 'zustand';
import type { PanelProps } from '../engine/viewer.ts';
import { pathOf } from '../navigate/view-path.ts';
import { upAxisOf } from '../state/up-axis.ts';
import type { CameraTrack, SceneSettings, SettingsPose } from './scene-settings.ts';
import { SETTINGS_FRAMES_PER_S, settingsOfView } from './settings-of-view.ts';

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
    frameRate: SETTINGS_FRAMES_PER_S,
    loopMode: loop,
    interpolation: isStepped ? 'step' : 'spline',
    smoothness,
    keyframes: {
      times: keys.map(({ timeS }) => Math.round(timeS * SETTINGS_FRAMES_PER_S)),
      values: {
        position: keys.flatMap(({ pose }) => pose.position),
        target: keys.flatMap(({ pose }) => pose.target),
        fov: keys.map(({ pose }) => pose.fovDegrees),
      },
    },
  };
}

const FILE_NAME = 'settings.json';
const LIST = new Intl.ListFormat('en');

/** Saves how the scene is shown for SuperSplat's viewer. */
export function SettingsSection({ store, viewer }: PanelProps) {
  const hasPicture = useStore(store, (state) => state.imageId > 0);
  const isAnnotated = useStore(store, (state) => state.annotating.list.length > 0);
  const hasPath = useStore(store, (state) => pathOf(state) !== null);
  const axis = useStore(store, upAxisOf);
  const isUpsideDown = useStore(store, (state) => state.scene?.isUpsideDown ?? false);
  const parts = [
    'This view',
    'the background',
    ...(hasPath ? ['the path'] : []),
    ...(isAnnotated ? ['the annotations'] : []),
  ];
  const fileUp = isUpsideDown ? '-y' : 'y';
  return (
    <section>
      <h3>Settings for SuperSplat’s viewer</h3>
      <p data-testid="settings-about">
        {LIST.format(parts)}, as a settings.json beside the scene. This viewer opens it, too.
        {axis !== fileUp && ` SuperSplat’s viewer shows ${fileUp.replace('-', '−')} upwards.`}
      </p>
      <TextButton
        disabled={!hasPicture}
        testId="save-settings"
        onClick={() => saveSettings({ store, viewer })}
      >
        Save {FILE_NAME}
      </TextButton>
    </section>
  );
}

/** Saves the view, the path and the annotations. */
export function saveSettings({ store, viewer }: PanelProps): void {
  const background = viewer.shownFrame?.frame.background;
  if (!background) return;
  const state = store.getState();
  const { annotating, scene, widthPx, heightPx } = state;
  const isUpsideDown = scene?.isUpsideDown ?? false;
  const [red, green, blue] = background;
  const text = writeSceneSettings(
    settingsOfView(viewer.camera.snapshot(), pathOf(state), annotating.list, {
      isUpsideDown,
      aspect: widthPx / heightPx,
      background: [red, green, blue],
    }),
  );
  const file = new Blob([text], { type: 'application/json' });
  saveFile(file, FILE_NAME);
  store.setState({ notice: `Saved ${FILE_NAME} (${formatBytes(file.size)}).` });
}
