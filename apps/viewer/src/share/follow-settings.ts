import { printable } from '@websplatter/core';
import { formatBytes } from '@websplatter/kit/format';
import { joinedAnnotations } from '../annotate/annotation-list.ts';
import { flippedPoint } from '../camera/flip.ts';
import { editPicture } from '../engine/edit-picture.ts';
import type { LinkedStart } from '../engine/link/linked-start.ts';
import type { Viewer } from '../engine/viewer.ts';
import type { Annotation } from '../state/annotating.ts';
import { hermite } from '../state/hermite.ts';
import { makeEdit, replacement } from '../state/make-edit.ts';
import type { KeptView } from '../state/saved-view.ts';
import type { SceneSummary } from '../state/scene.ts';
import type { ViewerStore } from '../state/store.ts';
import { tellFailure } from '../state/tell-failure.ts';
import { clamp, type Vec3 } from '../state/vec3.ts';
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

/** A `settings.json` with more bytes than this is something else. */
const MOST_BYTES = 16 * 2 ** 20;
/** Longest time for a server to send all of it, ms. */
const MOST_MS = 30_000;

/** Fetches text. Rejects with advice if it cannot be read, is too large or takes over `MOST_MS`. */
async function textAt(url: URL): Promise<string> {
  const name = printable(url.href);
  const stop = new AbortController();
  const timer = setTimeout(() => stop.abort(), MOST_MS);
  try {
    const response = await fetch(url, { signal: stop.signal });
    if (!response.ok) throw new Error(notRead(name, ` (${response.status})`));
    return await textOfStream(response.body ?? new Blob().stream(), name);
  } catch (error) {
    if (stop.signal.aborted) throw new Error(notRead(name, ` within ${MOST_MS / 1000} s`));
    throw error instanceof TypeError ? new Error(notRead(name, '')) : error;
  } finally {
    // Cancels the rest of the download after an error.
    stop.abort();
    clearTimeout(timer);
  }
}

/** The text of a file. Rejects where it is too large. */
function textOf(file: File): Promise<string> {
  return textOfStream(file.stream(), file.name);
}

async function textOfStream(stream: ReadableStream<Uint8Array<ArrayBuffer>>, name: string): Promise<string> {
  const pieces: Uint8Array<ArrayBuffer>[] = [];
  let bytes = 0;
  const reader = stream.getReader();
  for (let read = await reader.read(); !read.done; read = await reader.read()) {
    pieces.push(read.value);
    bytes += read.value.length;
    if (bytes <= MOST_BYTES) continue;
    // The error thrown next says why reading ends.
    reader.cancel().catch(() => {});
    throw new Error(`${name} has more than ${formatBytes(MOST_BYTES)}: that is no settings.json.`);
  }
  return new Blob(pieces).text();
}

function notRead(name: string, why: string): string {
  return `${name} cannot be read${why}: check the address; the server must allow reading from this page.`;
}

/** The settings that an address may have, too. */
type LinkedSettings = Partial<Pick<LinkedStart, 'camera' | 'background'>>;

/**
 * Shows the first scene as the `settings.json` at `address` says: its background, its annotations,
 * its camera and the movement that begins by itself, until a person moves the view. If that fails, the scene is
 * shown as it is, and the store has a failure.
 *
 * @param linked camera and background of the page's URL, which take precedence.
 */
export async function followSettings(
  address: string,
  linked: LinkedSettings,
  store: ViewerStore,
  viewer: Viewer,
): Promise<void> {
  const advice = 'Write ?settings= and the address of a settings.json of SuperSplat.';
  const settings = await readOr(() => textAt(new URL(address, location.href)), advice, store);
  if (settings) show(settings, linked, null, store, viewer);
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
  if (!settings) return;
  const [before, isAlone] = [store.getState().annotating.list, replaced === null];
  editPicture({ store, viewer }, 'settings', () => show(settings, {}, replaced, store, viewer));
  const { annotating } = store.getState();
  if (isAlone && annotating.list !== before) recordAnnotations(before, store);
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
    tellFailure(store, error, { title: 'The settings cannot be used', advice });
    return null;
  }
}

function show(
  { background, camera, track, annotations }: SceneSettings,
  linked: LinkedSettings,
  replaced: SceneSummary | null,
  store: ViewerStore,
  viewer: Viewer,
): void {
  if (background && !linked.background) viewer.camera.setLook({ background: backgroundOf(background) });
  const first = linked.camera ? null : (camera ?? track?.keys[0].pose);
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
  const view: KeptView = {
    pose,
    fovDegrees: fovOf(shown, store),
    isOrthographic: false,
    isFlipped: scene?.isUpsideDown ?? false,
    isZUp: false,
  };
  viewer.camera.restore({ ...view, home: view, cameraIndex: 0 });
}

/** Adds annotations before the scene's own. */
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

/** Has undo bring back the annotations before those of settings that were dropped alone. */
function recordAnnotations(before: readonly Annotation[], store: ViewerStore): void {
  const now = () => store.getState().annotating.list;
  const put = (list: readonly Annotation[]) =>
    store.setState(({ annotating }) => ({ annotating: { ...annotating, list, openIndex: null } }));
  const added = now();
  put(before);
  makeEdit(store, replacement('annotations of settings', added, now, put));
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

/** The camera of a track `elapsedS` after its beginning. It passes the keys exactly. */
export function poseOnTrack(track: CameraTrack, elapsedS: number): SettingsPose {
  const { keys, isStepped, smoothness } = closed(track);
  const timeS = timeOnTrack(track, elapsedS);
  const at = Math.max(
    0,
    keys.findLastIndex((key) => key.timeS <= timeS),
  );
  const from = keys[at];
  const to = keys[at + 1];
  if (!to || isStepped) return from.pose;
  const spanS = to.timeS - from.timeS;
  const part = clamp((timeS - from.timeS) / spanS, 0, 1);
  const slope = (index: number, of: (pose: SettingsPose) => number) => {
    const [before, after] = [keys[index - 1] ?? keys[index], keys[index + 1] ?? keys[index]];
    return (smoothness * spanS * (of(after.pose) - of(before.pose))) / (after.timeS - before.timeS);
  };
  const value = (of: (pose: SettingsPose) => number) =>
    hermite(of(from.pose), slope(at, of), of(to.pose), slope(at + 1, of), part);
  const vector = (name: 'position' | 'target'): Vec3 => [
    value((pose) => pose[name][0]),
    value((pose) => pose[name][1]),
    value((pose) => pose[name][2]),
  ];
  const fovDegrees = value((pose) => pose.fovDegrees);
  return {
    position: vector('position'),
    target: vector('target'),
    // Slopes of a huge smoothness cancel out to no number.
    fovDegrees: Number.isNaN(fovDegrees) ? from.pose.fovDegrees : clamp(fovDegrees, 1, 179),
  };
}

/** Whether a track that is played once has come to its end. */
export function isAtEnd({ loop, durationS }: CameraTrack, elapsedS: number): boolean {
  return loop === 'none' && elapsedS >= durationS;
}

/** A track that repeats goes from its last key on to the first. */
function closed(track: CameraTrack): CameraTrack {
  const { keys, loop, durationS } = track;
  const [first] = keys;
  if (loop !== 'repeat' || durationS <= keys[keys.length - 1].timeS) return track;
  return { ...track, keys: [...keys, { timeS: first.timeS + durationS, pose: first.pose }] };
}

function timeOnTrack({ loop, durationS }: CameraTrack, elapsedS: number): number {
  if (loop === 'none') return Math.min(elapsedS, durationS);
  if (loop === 'repeat') return elapsedS % durationS;
  const there = elapsedS % (2 * durationS);
  return there <= durationS ? there : 2 * durationS - there;
}
