import { flippedPoint } from '../camera/flip.ts';
import { axesOf, type CameraAxes } from '../camera/rotation.ts';
import { isFiniteF32 } from '../state/float32.ts';
import { scale, type Vec3 } from '../state/vec3.ts';
import { type FileKey, type FilePath, PathFileError, type PathScene, poseInScene } from './path-file.ts';

/** Pictures have no times: each is shown so long, ms. */
const PICTURE_MS = 500;
/** Parameters of COLMAP's camera models whose first one or two are focal lengths. */
const ONE_FOCAL_LENGTH = [
  'SIMPLE_PINHOLE',
  'SIMPLE_RADIAL',
  'RADIAL',
  'SIMPLE_RADIAL_FISHEYE',
  'RADIAL_FISHEYE',
];

/**
 * Reads `images.txt` of COLMAP: the cameras of pictures, in the order of their names, in the scene
 * as its file has it. Camera axes there are x right, y down and z ahead.
 *
 * @param camerasText `cameras.txt`, which has the focal lengths; null without it.
 * @throws PathFileError naming the line that cannot be read.
 */
export function readColmapPath(
  fileName: string,
  text: string,
  camerasText: string | null,
  scene: PathScene,
): FilePath {
  const fovs = camerasText === null ? null : readFovs(camerasText);
  const pictures = linesOf(text)
    // Each picture's line is followed by its points, which may be an empty line.
    .filter((_, i) => i % 2 === 0)
    .map(({ line, number }) => readPicture(fileName, line, number, scene));
  if (pictures.length === 0) throw new PathFileError(fileName, 'it has no pictures.');
  const ordered = pictures.toSorted((a, b) => BY_NAME.compare(a.name, b.name));
  const keys = ordered.map(
    ({ cameraId, name, ...rest }, i): FileKey => ({
      ...rest,
      name: name.replace(/^.*[\\/]/, '').replace(/\.\w+$/, ''),
      atMs: i * PICTURE_MS,
      fovDegrees: fovs?.get(cameraId) ?? scene.fovDegrees,
    }),
  );
  const notes = fovs
    ? []
    : ['The field of view stays: choose cameras.txt together with images.txt for theirs.'];
  return { keys, durationMs: keys.length * PICTURE_MS, isLooped: false, notes };
}

const BY_NAME = new Intl.Collator('en', { numeric: true });

interface Picture extends Pick<FileKey, 'pose'> {
  readonly cameraId: string;
  readonly name: string;
}

function readPicture(fileName: string, line: string, number: number, scene: PathScene): Picture {
  const [, w, x, y, z, ...rest] = line.split(/\s+/);
  const [tx, ty, tz, cameraId, ...names] = rest;
  const [qw, qx, qy, qz, ...offset] = [w, x, y, z, tx, ty, tz].map(Number);
  if (names.length === 0 || ![qw, qx, qy, qz, ...offset].every(Number.isFinite))
    throw new PathFileError(
      fileName,
      `line ${number} is not “IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME” as COLMAP writes it.`,
    );
  if (Math.hypot(qw, qx, qy, qz) === 0)
    throw new PathFileError(fileName, `the rotation in line ${number} is 0, 0, 0, 0.`);
  // The rows of the rotation from the world to the camera, which are the camera's axes in the world.
  const { right, above: down, back: ahead } = axesOf([-qx, -qy, -qz, qw]);
  const [offsetX, offsetY, offsetZ] = offset;
  const at = (axis: 0 | 1 | 2) => -(right[axis] * offsetX + down[axis] * offsetY + ahead[axis] * offsetZ);
  const position: Vec3 = [at(0), at(1), at(2)];
  if (!position.every(isFiniteF32))
    throw new PathFileError(fileName, `the camera in line ${number} is farther away than float32 can say.`);
  const axes: CameraAxes = { right, above: scale(down, -1), back: scale(ahead, -1) };
  const drawn = scene.isFlipped ? flippedPoint : (point: Vec3) => point;
  return {
    pose: poseInScene(
      drawn(position),
      { right: drawn(axes.right), above: drawn(axes.above), back: drawn(axes.back) },
      scene,
    ),
    cameraId,
    name: names.join(' '),
  };
}

/** Fields of view over the shorter side by camera, degrees. */
function readFovs(text: string): ReadonlyMap<string, number> {
  const fovs = new Map<string, number>();
  for (const { line } of linesOf(text)) {
    const [id, model, ...numbers] = line.split(/\s+/);
    const [widthPx, heightPx, focalX, second] = numbers.map(Number);
    const focalY = ONE_FOCAL_LENGTH.includes(model) ? focalX : second;
    const fov =
      (2 * Math.atan(widthPx < heightPx ? widthPx / (2 * focalX) : heightPx / (2 * focalY)) * 180) / Math.PI;
    if (fov > 0 && fov < 180) fovs.set(id, fov);
  }
  return fovs;
}

/** Lines that are no comments, without blank ends; `number` counts all lines from 1. */
function linesOf(text: string): readonly { readonly line: string; readonly number: number }[] {
  const lines = text
    .replace(/^\uFEFF/, '')
    .split(/\r?\n/)
    .map((line, i) => ({ line: line.trim(), number: i + 1 }))
    .filter(({ line }) => !line.startsWith('#'));
  const isFilled = ({ line }: { readonly line: string }) => line !== '';
  const first = lines.findIndex(isFilled);
  return first < 0 ? [] : lines.slice(first, lines.findLastIndex(isFilled) + 1);
}

/** Whether a text looks like COLMAP's list of pictures: a line of ten parts or more, or its heading. */
export function isColmapImages(text: string): boolean {
  return /^#.*\bIMAGE_ID, QW\b/m.test(text) || /^[ \t]*\d+([ \t]+[-+.\deE]+){7}[ \t]+\d+[ \t]+\S/m.test(text);
}

/** Whether a text looks like COLMAP's list of cameras. */
export function isColmapCameras(text: string): boolean {
  // No space may stand for a line's end: each line would be read to the end of the text.
  return /^[ \t]*\d+[ \t]+[A-Z_]+[ \t]+\d+[ \t]+\d+[ \t]/m.test(text);
}
