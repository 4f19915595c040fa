import type { ViewerStore } from '../state/store.ts';
import type { Viewer } from '../viewer/viewer.ts';
import { isAtEnd, poseOnTrack } from './camera-track.ts';
import {
  type CameraTrack,
  readSceneSettings,
  type SceneSettings,
  type SettingsPose,
} from './scene-settings.ts';
import { backgroundOf, poseOf, shorterFov } from './settings-pose.ts';

/** A `settings.json` with more bytes than this is something else. */
const MOST_BYTES = 16 * 2 ** 20;

/**
 * Shows the first scene as the `settings.json` at `address` says: its background, its camera and the movement that begins by
 * itself, until somebody takes hold of the image. Where that cannot be, the store has a failure, and the scene is shown as it is.
 *
 * @param isCameraLinked whether the page's address has a camera of its own: then only the background is taken.
 */
export async function followSettings(
  address: string,
  isCameraLinked: boolean,
  store: ViewerStore,
  viewer: Viewer,
): Promise<void> {
  let settings: SceneSettings;
  try {
    settings = readSceneSettings(await textAt(new URL(address, location.href)));
  } catch (error) {
    const message = error instanceof Error ? error.message : String(error);
    const advice = 'Write ?settings= and the address of a settings.json of SuperSplat.';
    store.setState({ failure: { title: 'The settings cannot be used', message, advice, isFault: false } });
    return;
  }
  const { background, camera, track } = settings;
  if (background) viewer.camera.setLook({ background: backgroundOf(background) });
  if (isCameraLinked || !(camera ?? track)) return;
  whenSceneIsThere(store, (isWhole) => {
    showPose(camera ?? (track as CameraTrack).keys[0].pose, store, viewer);
    if (isWhole && track && !matchMedia('(prefers-reduced-motion: reduce)').matches)
      play(track, store, viewer);
  });
}

async function textAt(url: URL): Promise<string> {
  const response = await fetch(url).catch(() => null);
  if (!response?.ok) {
    const status = response ? ` (${response.status})` : '';
    throw new Error(
      `${url.href} cannot be read${status}: check the address; the server must allow reading from this page.`,
    );
  }
  const { size, text } = await response.blob().then((blob) => ({ size: blob.size, text: () => blob.text() }));
  if (size > MOST_BYTES) throw new Error(`${url.href} has ${size} bytes: that is no settings.json.`);
  return text();
}

/** Calls `then` for each preview of the first scene, and for all of it; each time after it was given its first view. */
function whenSceneIsThere(store: ViewerStore, then: (isWhole: boolean) => void): void {
  const take = () => {
    const isWhole = store.getState().load === null;
    if (isWhole) unsubscribe();
    then(isWhole);
  };
  const unsubscribe = store.subscribe((state, before) => {
    const isLoaded = state.load === null && before.load !== null;
    if (state.scene && (state.scene !== before.scene || isLoaded)) queueMicrotask(take);
  });
  if (store.getState().scene) take();
}

function showPose(shown: SettingsPose, store: ViewerStore, viewer: Viewer): void {
  const pose = poseOf(shown);
  const { scene } = store.getState();
  viewer.camera.restore({
    pose,
    home: pose,
    fovDegrees: fovOf(shown, store),
    isOrthographic: false,
    cameraIndex: 0,
    isFlipped: scene?.isUpsideDown ?? false,
    isZUp: false,
  });
}

function fovOf({ fovDegrees }: SettingsPose, store: ViewerStore): number {
  const { widthPx, heightPx } = store.getState();
  return shorterFov(fovDegrees, widthPx > 0 ? widthPx / heightPx : 1);
}

/** Moves the camera along `track`, until it ends or is moved otherwise. */
function play(track: CameraTrack, store: ViewerStore, { camera }: Viewer): void {
  const { controls } = camera;
  let elapsedS = 0;
  let shown = controls.pose;
  store.setState({ isPathPlaying: true });
  camera.setMotion((elapsedMs) => {
    const isTaken = controls.pose !== shown || !store.getState().isPathPlaying;
    if (isTaken || isAtEnd(track, elapsedS)) {
      store.setState({ isPathPlaying: false });
      camera.setMotion(null);
      return false;
    }
    elapsedS += elapsedMs / 1000;
    const next = poseOnTrack(track, elapsedS);
    const fovDegrees = fovOf(next, store);
    if (fovDegrees !== store.getState().look.fovDegrees) camera.setLook({ fovDegrees });
    shown = poseOf(next);
    controls.moveTo(shown);
    return true;
  });
}
