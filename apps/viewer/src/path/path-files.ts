import { formatBytes } from '@websplatter/kit/format';
import { saveFile } from '@websplatter/kit/take-away';
import { flippedPoint } from '../camera/flip.ts';
import type { PanelProps } from '../engine/viewer.ts';
import type { SavedViews } from '../navigate/saved-views.ts';
import { MAX_SAVED_VIEWS } from '../navigate/view-list.ts';
import { type CameraPath, pathOf, viewOnPath } from '../navigate/view-path.ts';
import { sceneFileName } from '../share/file-work.ts';
import { type CameraTrack, hasDirection, readCameraTrack } from '../share/scene-settings.ts';
import { poseOf, shorterFov } from '../share/settings-pose.ts';
import { saveSettings } from '../share/settings-section.tsx';
import { FieldError } from '../state/json-fields.ts';
import { cameraAxes, lookAt, poseFromLookAt } from '../state/orbit-pose.ts';
import { LEAST_STEP_MS } from '../state/saved-view.ts';
import { tellFailure } from '../state/tell-failure.ts';
import { upVector } from '../state/up-axis.ts';
import { isColmapCameras, isColmapImages, readColmapPath } from './colmap-path.ts';
import { readGltfPath, type SampledCamera, writeGltfPath } from './gltf-path.ts';
import { type FilePath, PathFileError, type PathScene, viewsOfPath } from './path-file.ts';

/** A file with more bytes is no camera path: a million pictures take a tenth of it. */
const MOST_BYTES = 2 ** 30;

/**
 * Reads a camera path of COLMAP, SuperSplat or glTF. Its views replace the saved ones, which can be
 * undone. If that fails, the store has a failure, and the views stay.
 */
export async function importPath(
  files: readonly File[],
  views: SavedViews,
  { store, viewer }: PanelProps,
): Promise<void> {
  const scene = sceneOf({ store, viewer });
  const { contentKey } = store.getState().scene ?? {};
  try {
    const { path, fileName } = await readPath(files, scene);
    // Another scene may have come meanwhile.
    if (store.getState().scene?.contentKey !== contentKey) return;
    const read = viewsOfPath(path, scene, { most: MAX_SAVED_VIEWS, leastStepMs: LEAST_STEP_MS });
    const replaced = store.getState().savedViews.length;
    views.replaceAll(read, path.isLooped && read.length > 1);
    const notes = [
      `${fileName}: the path has ${read.length === 1 ? 'one view' : `${read.length} views`} of ${path.keys.length} cameras.`,
      ...path.notes,
      ...(replaced > 0 ? ['It replaces the saved views.'] : []),
    ];
    store.setState({ notice: { text: notes.join(' '), offers: [{ label: 'Undo', command: 'undo' }] } });
  } catch (error) {
    tellFailure(store, error, {
      title: 'The path cannot be read',
      advice:
        'Choose images.txt of COLMAP, settings.json of SuperSplat, or a glTF file with a camera, as Blender saves it.',
      isFault: !(error instanceof PathFileError),
    });
  }
}

/**
 * Reads the path among the files: several may be one, as `images.txt` with `cameras.txt`.
 *
 * @throws PathFileError naming the file that cannot be read.
 */
export async function readPath(
  files: readonly File[],
  scene: PathScene,
): Promise<{ readonly path: FilePath; readonly fileName: string }> {
  const large = files.find(({ size }) => size > MOST_BYTES);
  if (large) throw new PathFileError(large.name, `it has more than ${formatBytes(MOST_BYTES)}.`);
  const gltf = files.find(({ name }) => /\.(gltf|glb)$/i.test(name));
  if (gltf) return { path: await readGltfPath(gltf, scene), fileName: gltf.name };
  const texts = await Promise.all(files.map(async (file) => ({ file, text: await file.text() })));
  const images = texts.find(({ text }) => isColmapImages(text));
  if (images) {
    const cameras = texts.find(({ text }) => !isColmapImages(text) && isColmapCameras(text))?.text ?? null;
    const { name } = images.file;
    return { path: readColmapPath(name, images.text, cameras, scene), fileName: name };
  }
  const json = texts.find(({ text }) => text.trimStart().startsWith('{'));
  if (json) return { path: readSettingsPath(json.file.name, json.text, scene), fileName: json.file.name };
  const names = files.map(({ name }) => name).join(', ');
  throw new PathFileError(names, 'it is neither images.txt of COLMAP, nor JSON, nor glTF.');
}

/** Saves the path as a file. Does nothing without one. */
export function exportPath(kind: 'glb' | 'gltf' | 'json', panel: PanelProps): void {
  const { store, viewer } = panel;
  const path = pathOf(store.getState());
  if (!path) return;
  if (kind === 'json') {
    saveSettings(panel);
    return;
  }
  const { view } = path.keys[0];
  const scene = { ...sceneOf(panel), isZUp: view.isZUp };
  const file = writeGltfPath(sampledPath(path), view.fovDegrees, scene, kind === 'glb');
  const fileName = sceneFileName(viewer, { extension: `-path.${kind}` });
  saveFile(file, fileName);
  const hasFovs = path.keys.some((key) => Math.abs(key.view.fovDegrees - view.fovDegrees) > 1e-6);
  const note = hasFovs ? ' Note: glTF cannot animate the field of view; it has that of the first view.' : '';
  store.setState({ notice: `Saved ${fileName} (${formatBytes(file.size)}).${note}` });
}

/** Cameras a second: players join them by straight lines. */
const SAMPLES_PER_S = 30;
/** Between the camera that is held and the one that it is cut to, ms. */
const CUT_MS = 1;

/** The path's cameras at even times, at its views, and before each cut. */
export function sampledPath(path: CameraPath): readonly SampledCamera[] {
  const { keys, durationMs } = path;
  const count = Math.ceil((durationMs * SAMPLES_PER_S) / 1000);
  const timesMs = new Set(Array.from({ length: count }, (_, i) => (i * 1000) / SAMPLES_PER_S));
  timesMs.add(durationMs);
  for (const [i, { atMs, passing }] of keys.entries()) {
    timesMs.add(atMs);
    if (passing === 'cut') timesMs.add((keys[i + 1]?.atMs ?? durationMs) - CUT_MS);
  }
  return [...timesMs]
    .sort((a, b) => a - b)
    .map((timeMs) => {
      const { pose } = viewOnPath(path, timeMs);
      return { timeS: timeMs / 1000, position: lookAt(pose).position, axes: cameraAxes(pose) };
    });
}

function sceneOf({ store, viewer }: PanelProps): PathScene {
  const { isFlipped, isZUp, scene, widthPx, heightPx, look } = store.getState();
  const { subjectSphere, subjectRadius } = viewer.camera;
  return {
    ...{ isFlipped, isZUp, isUpsideDown: scene?.isUpsideDown ?? false },
    aspect: widthPx > 0 ? widthPx / heightPx : 1,
    center: subjectSphere?.center ?? [0, 0, 0],
    radius: subjectRadius,
    fovDegrees: look.fovDegrees,
  };
}

/** SuperSplat's smoothness below which its camera all but stops at each key. */
const STOPS_BELOW = 0.5;

/**
 * Reads the first movement of the camera in SuperSplat's `settings.json`, whether it begins by
 * itself or not.
 *
 * @throws PathFileError for another file, and for one without a movement.
 */
function readSettingsPath(fileName: string, text: string, scene: PathScene): FilePath {
  const track = trackIn(fileName, text);
  if (!track) throw new PathFileError(fileName, 'its animTracks are empty.');
  const { keys, loop, isStepped, smoothness } = track;
  if (keys.some(({ pose }) => !hasDirection(pose)))
    throw new PathFileError(fileName, 'the target of a camera is where the camera is.');
  const passing = isStepped ? 'cut' : smoothness < STOPS_BELOW ? 'stop' : 'through';
  return {
    keys: keys.map(({ timeS, pose }) => ({
      atMs: 1000 * (timeS - keys[0].timeS),
      pose: drawn(poseOf(pose), scene),
      fovDegrees: shorterFov(pose.fovDegrees, scene.aspect),
      passing,
    })),
    durationMs: 1000 * (track.durationS - keys[0].timeS),
    isLooped: loop === 'repeat',
    notes: loop === 'pingpong' ? ['It is played to its end only, not back again.'] : [],
  };
}

/** The pose in the drawn scene, of one in the scene as it comes with y up. */
function drawn(
  pose: ReturnType<typeof poseOf>,
  { isFlipped, isZUp, isUpsideDown }: PathScene,
): ReturnType<typeof poseOf> {
  if (isFlipped === isUpsideDown && !isZUp) return pose;
  const { position, target } = lookAt(pose);
  const place = isFlipped === isUpsideDown ? (point: typeof target) => point : flippedPoint;
  return poseFromLookAt({ position: place(position), target: place(target), up: upVector({ isZUp }) });
}

function trackIn(fileName: string, text: string): CameraTrack | null {
  try {
    return readCameraTrack(text);
  } catch (error) {
    if (error instanceof FieldError) throw new PathFileError(fileName, error.message);
    throw error;
  }
}
