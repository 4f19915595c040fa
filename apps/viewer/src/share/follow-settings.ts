import { joinedAnnotations } from '../annotate/annotation-list.ts';
import { flippedPoint } from '../camera/flip.ts';
import type { Viewer } from '../engine/viewer.ts';
import type { Annotation } from '../state/annotating.ts';
import type { SceneSummary } from '../state/scene-summary.ts';
import type { ViewerStore } from '../state/store.ts';
import { isAtEnd, poseOnTrack } from './camera-track.ts';
import { textAt, textOf } from './read-text.ts';
import {
  type CameraTrack,
  checkDirections,
  hasDirection,
  readSceneSettings,
  type SceneSettings,
  type SettingsAnnotation,
  type SettingsPose,
} from './scene-settings.ts';
import { backgroundOf, poseOf, shorterFov, uprightPoint } from './settings-pose.ts';

/**
 * Shows the first scene as the `settings.json` at `address` says: its background, its annotations,
 * its camera and the movement that begins by itself, until a person moves the view. If that fails, the scene is
 * shown as it is, and the store has a failure.
 *
 * @param isCameraLinked whether the page's address has a camera of its own: then only the
 * background and the annotations are taken.
 */
export async function followSettings(
  address: string,
  isCameraLinked: boolean,
  store: ViewerStore,
  viewer: Viewer,
): Promise<void> {
  const advice = 'Write ?settings= and the address of a settings.json of SuperSplat.';
  const settings = await readOr(() => textAt(new URL(address, location.href)), advice, store);
  if (settings) show(settings, isCameraLinked, null, store, viewer);
}

/**
 * The same for a file that was dropped.
 *
 * @param replaced the former scene, for settings of the scene that takes its place; null for the
 * shown one.
 */
export async function followDroppedSettings(
  file: File,
  replaced: SceneSummary | null,
  store: ViewerStore,
  viewer: Viewer,
): Promise<void> {
  const advice = 'Drop a settings.json of SuperSplat.';
  const settings = await readOr(() => textOf(file), advice, store);
  if (settings) show(settings, false, replaced, store, viewer);
}

/** Null where they cannot be used, which the store then says. */
async function readOr(
  read: () => Promise<string>,
  advice: string,
  store: ViewerStore,
): Promise<SceneSettings | null> {
  try {
    const settings = readSceneSettings(await read());
    checkDirections(settings);
    return settings;
  } catch (error) {
    const message = error instanceof Error ? error.message : String(error);
    store.setState({ failure: { title: 'The settings cannot be used', message, advice, isFault: false } });
    return null;
  }
}

function show(
  { background, camera, track, annotations }: SceneSettings,
  isCameraLinked: boolean,
  replaced: SceneSummary | null,
  store: ViewerStore,
  viewer: Viewer,
): void {
  if (background) viewer.camera.setLook({ background: backgroundOf(background) });
  const first = isCameraLinked ? null : (camera ?? track?.keys[0].pose);
  if (!first && annotations.length === 0) return;
  whenSceneIsThere(store, replaced, (isWhole) => {
    if (isWhole) annotate(annotations, store);
    if (!first) return;
    showPose(first, store, viewer);
    if (isWhole && track && !matchMedia('(prefers-reduced-motion: reduce)').matches)
      play(track, store, viewer);
  });
}

/**
 * Calls `then` for each preview of the first scene that is not `replaced`, and for all of it; each
 * time after it was given its first view. Gives up where none comes in the place of that.
 */
function whenSceneIsThere(
  store: ViewerStore,
  replaced: SceneSummary | null,
  then: (isWhole: boolean) => void,
): void {
  const take = () => {
    const isWhole = store.getState().load === null;
    if (isWhole) unsubscribe();
    then(isWhole);
  };
  const unsubscribe = store.subscribe((state, before) => {
    const isLoaded = state.load === null && before.load !== null;
    if (state.scene === replaced && replaced !== null) {
      if (isLoaded) unsubscribe();
    } else if (state.scene && (state.scene !== before.scene || isLoaded)) queueMicrotask(take);
  });
  const { scene, load } = store.getState();
  if (scene && scene !== replaced) take();
  // It could not be opened, sooner than this was read.
  else if (replaced && !load) unsubscribe();
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

/** Adds them before those that are there. */
function annotate(annotations: readonly SettingsAnnotation[], store: ViewerStore): void {
  if (annotations.length === 0) return;
  const { scene, annotating } = store.getState();
  const isFlipped = scene?.isUpsideDown ?? false;
  const read = annotations.map(({ position, title, text, camera }): Annotation => {
    const point = uprightPoint(position);
    const view = { pose: poseOf(camera), fovDegrees: fovOf(camera, store) };
    return {
      ...{ point: isFlipped ? flippedPoint(point) : point, title, text },
      view: { ...view, isOrthographic: false, isFlipped, isZUp: false },
    };
  });
  store.setState({ annotating: { ...annotating, list: joinedAnnotations(read, annotating.list) } });
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
    // Between keys a camera may pass its target: it looks on as before until it is past that.
    if (!hasDirection(next)) return true;
    const fovDegrees = fovOf(next, store);
    if (fovDegrees !== store.getState().look.fovDegrees) camera.setLook({ fovDegrees });
    shown = poseOf(next);
    controls.moveTo(shown);
    return true;
  });
}
