import { shown } from '@websplatter/core';
import {
  arrayAt,
  FieldError,
  type Json,
  numberAt,
  numbersAt,
  objectAt,
  pointAt,
  textAt,
  vectorAt,
} from '../state/json-fields.ts';
import { subtract, type Vec3 } from '../state/vec3.ts';

/** A camera as SuperSplat has it: metres of its world, y up. */
export interface SettingsPose {
  readonly position: Vec3;
  readonly target: Vec3;
  /** Over the image's longer side. */
  readonly fovDegrees: number;
}

/** A movement of the camera. */
export interface CameraTrack {
  readonly durationS: number;
  readonly loop: (typeof LOOPS)[number];
  /** Jumps from key to key, and does not glide. */
  readonly isStepped: boolean;
  /** How much of its way a key is passed with: 0 stands still at each, 1 does not slow down. */
  readonly smoothness: number;
  /** At least one, by time. */
  readonly keys: readonly { readonly timeS: number; readonly pose: SettingsPose }[];
}

/** Words about a place. */
export interface SettingsAnnotation {
  readonly position: Vec3;
  readonly title: string;
  readonly text: string;
  /** Camera to move to when the annotation is opened. */
  readonly camera: SettingsPose;
}

/** The parts of a `settings.json` that the viewer follows. */
export interface SceneSettings {
  readonly camera: SettingsPose | null;
  /** sRGB, 0…1. */
  readonly background: Vec3 | null;
  /** The movement that begins by itself. */
  readonly track: CameraTrack | null;
  /** The first version has none. */
  readonly annotations: readonly SettingsAnnotation[];
}

const LOOPS = ['none', 'repeat', 'pingpong'] as const;
/** Of the first version's cameras that have none. */
const FIRST_VERSION_FOV_DEGREES = { camera: 75, track: 60 } as const;

/**
 * Reads SuperSplat's `settings.json` of either version.
 *
 * @throws FieldError for text that is no JSON, another version, or a value that does not fit.
 */
export function readSceneSettings(text: string): SceneSettings {
  const settings = settingsIn(text);
  return settings.version === undefined ? firstVersion(settings) : secondVersion(settings);
}

/**
 * Reads the movement of the camera alone, whether it begins by itself or not; null if there is none.
 *
 * @throws FieldError as `readSceneSettings` does.
 */
export function readCameraTrack(text: string): CameraTrack | null {
  const settings = settingsIn(text);
  return settings.version === undefined ? firstTrack(settings) : secondTrack(settings);
}

function settingsIn(text: string): Json {
  let json: unknown;
  try {
    json = JSON.parse(text);
  } catch {
    throw new FieldError('', text, 'JSON');
  }
  const settings = objectAt('', json);
  const { version } = settings;
  if (version !== undefined && version !== 2) throw new FieldError('version', version, '2, or absent');
  return settings;
}

/** Largest coordinate of a scene. Squares of much larger ones would overflow float32. */
const FARTHEST = 1e15;
/** Least part of its own coordinates that a camera is away from its target. */
const LEAST_APART = 1e-12;

/** Whether a camera looks anywhere: it is away from its target, and both are places of a scene. */
export function hasDirection({ position, target }: Pick<SettingsPose, 'position' | 'target'>): boolean {
  const largest = Math.max(...[...position, ...target].map(Math.abs));
  return largest <= FARTHEST && Math.hypot(...subtract(position, target)) > LEAST_APART * largest;
}

/**
 * Checks that each camera of the settings looks somewhere.
 *
 * @throws FieldError naming the one that does not.
 */
export function checkDirections({ camera, track, annotations }: SceneSettings): void {
  const check = (place: string, pose: SettingsPose | undefined) => {
    if (!pose || hasDirection(pose)) return;
    const needed = `a place other than its position, ${shown(pose.position)}, and both within ±${FARTHEST}`;
    throw new FieldError(`The target of ${place}`, pose.target, needed);
  };
  check('the camera', camera ?? undefined);
  for (const [i, { pose }] of (track?.keys ?? []).entries()) check(`key ${i} of the track`, pose);
  for (const [i, each] of annotations.entries()) check(`annotations[${i}].camera`, each.camera);
}

function firstVersion(settings: Json): SceneSettings {
  const { fov, position, target, startAnim } = objectAt('camera', settings.camera);
  const isPlaced = !isAbsent(position) && !isAbsent(target);
  const { color } = objectAt('background', settings.background);
  return {
    camera: isPlaced
      ? {
          position: vectorAt('camera.position', position),
          target: vectorAt('camera.target', target),
          fovDegrees: isAbsent(fov) ? FIRST_VERSION_FOV_DEGREES.camera : fovAt('camera.fov', fov),
        }
      : null,
    background: isAbsent(color) ? null : vectorAt('background.color', color),
    track: startAnim === 'animTrack' ? firstTrack(settings) : null,
    annotations: [],
  };
}

/** The movement of the first version's name. */
function firstTrack({ camera, animTracks }: Json): CameraTrack | null {
  const { fov, animTrack } = objectAt('camera', camera);
  const tracks = isAbsent(animTracks) ? [] : arrayAt('animTracks', animTracks);
  const named = tracks.findIndex((each, i) => objectAt(`animTracks[${i}]`, each).name === animTrack);
  const fovDegrees = isAbsent(fov) ? FIRST_VERSION_FOV_DEGREES.track : fovAt('camera.fov', fov);
  return trackAt(tracks, Math.max(0, named), fovDegrees);
}

function secondVersion(settings: Json): SceneSettings {
  const { cameras, background, annotations, startMode } = settings;
  const [first] = arrayAt('cameras', cameras);
  return {
    camera: first === undefined ? null : cameraAt('cameras[0]', first),
    background: vectorAt('background.color', objectAt('background', background).color),
    track: startMode === 'animTrack' ? secondTrack(settings) : null,
    annotations: isAbsent(annotations) ? [] : arrayAt('annotations', annotations).map(annotationAt),
  };
}

function secondTrack({ animTracks }: Json): CameraTrack | null {
  return trackAt(arrayAt('animTracks', animTracks), 0, null);
}

function annotationAt(value: unknown, index: number): SettingsAnnotation {
  const path = `annotations[${index}]`;
  const { position, title, text, camera } = objectAt(path, value);
  return {
    position: pointAt(`${path}.position`, position),
    title: textAt(`${path}.title`, title),
    text: textAt(`${path}.text`, text),
    camera: cameraAt(`${path}.camera`, camera),
  };
}

function cameraAt(cameraPath: string, camera: unknown): SettingsPose {
  const path = `${cameraPath}.initial`;
  const { position, target, fov } = objectAt(path, objectAt(cameraPath, camera).initial);
  return {
    position: vectorAt(`${path}.position`, position),
    target: vectorAt(`${path}.target`, target),
    fovDegrees: fovAt(`${path}.fov`, fov),
  };
}

/** @param fovDegrees of a track whose keys have none; null where each has one. */
function trackAt(tracks: readonly unknown[], index: number, fovDegrees: number | null): CameraTrack | null {
  if (index >= tracks.length) return null;
  const path = `animTracks[${index}]`;
  const { duration, frameRate, loopMode, interpolation, smoothness, keyframes } = objectAt(
    path,
    tracks[index],
  );
  const { times, values } = objectAt(`${path}.keyframes`, keyframes);
  const columns = objectAt(`${path}.keyframes.values`, values);
  // Early files have no rate, and times in seconds.
  const framesPerS = typeof frameRate === 'number' && frameRate > 0 ? frameRate : 1;
  const frames = numbersAt(`${path}.keyframes.times`, times);
  if (frames.length === 0) return null;
  const vectors = (name: 'position' | 'target') =>
    numbersAt(`${path}.keyframes.values.${name}`, columns[name], 3 * frames.length);
  const [positions, targets] = [vectors('position'), vectors('target')];
  const fovPath = `${path}.keyframes.values.fov`;
  const fovs = fovDegrees === null ? numbersAt(fovPath, columns.fov, frames.length) : null;
  const keys = frames.map((frame, i) => ({
    timeS: numberAt(`${path}.keyframes.times[${i}] by frameRate`, frame / framesPerS),
    pose: {
      position: [positions[3 * i], positions[3 * i + 1], positions[3 * i + 2]] as const,
      target: [targets[3 * i], targets[3 * i + 1], targets[3 * i + 2]] as const,
      fovDegrees: fovs ? fovAt(`${fovPath}[${i}]`, fovs[i]) : (fovDegrees ?? 0),
    },
  }));
  if (keys.some(({ timeS }, i) => i > 0 && timeS <= keys[i - 1].timeS))
    throw new FieldError(
      `${path}.keyframes.times`,
      times,
      'numbers of which each is larger than the one before',
    );
  const loop = LOOPS.find((each) => each === loopMode);
  if (!loop) throw new FieldError(`${path}.loopMode`, loopMode, `one of ${LOOPS.join(', ')}`);
  const durationS = numberAt(`${path}.duration`, duration);
  if (durationS <= 0) throw new FieldError(`${path}.duration`, duration, 'above 0');
  return {
    durationS,
    loop,
    isStepped: interpolation === 'step',
    smoothness: isAbsent(smoothness) ? 0 : numberAt(`${path}.smoothness`, smoothness),
    keys,
  };
}

/** Early exports write null for missing values. */
function isAbsent(value: unknown): boolean {
  return value === undefined || value === null;
}

function fovAt(path: string, value: unknown): number {
  const fov = numberAt(path, value);
  if (fov <= 0 || fov >= 180) throw new FieldError(path, value, 'degrees above 0 and below 180');
  return fov;
}
