import { chooseCases } from '@websplatter/conformance';
import {
  type Bounds,
  type Camera,
  type CloudInstance,
  InvalidArgumentError,
  type LoadOptions,
  perspectiveCamera,
  type SplatCloud,
  type SplatEngine,
  type Vec3,
} from '@websplatter/core';
import { verticalFov } from '@websplatter/kit/vertical-fov';
import { builtinScenes, type SceneCamera } from '@websplatter/scenes';
import { VIEWER } from '../page.tsx';

/** A scene on the GPU. */
export interface MeasuredScene {
  readonly title: string;
  readonly clouds: readonly CloudInstance[];
  /** Where it is seen from, as the viewer shows it first. */
  readonly camera: (aspect: number) => Camera;
}

/** Names that addresses of files have in an address: the viewer reads the same. */
const FILE_NAMES = ['src', 'url', 'file'];
const HARD_CASE = 'hard:';

/** The addresses of files that the address of the page names. */
export function filesIn(query: URLSearchParams): readonly string[] {
  return FILE_NAMES.flatMap((name) => query.getAll(name)).filter((address) => address !== '');
}

/**
 * Loads the scene of the address: `?src=ADDRESS`, once or several times, relative to the viewer's
 * page, `?scene=NAME` or `?scene=hard:NAME`; by default the larger still life, on slow devices too.
 *
 * @throws InvalidArgumentError for names that do not exist; errors of loading.
 */
export async function loadScene(
  engine: SplatEngine,
  query: URLSearchParams,
  options: LoadOptions,
): Promise<MeasuredScene> {
  const files = filesIn(query);
  const name = query.get('scene');
  if (files.length > 0) return loadFiles(engine, files, options);
  return name?.startsWith(HARD_CASE)
    ? loadHardCase(engine, name.slice(HARD_CASE.length), options)
    : loadBuiltin(engine, name ?? builtinScenes[0].name, options);
}

async function loadFiles(engine: SplatEngine, addresses: readonly string[], options: LoadOptions) {
  const clouds: SplatCloud[] = [];
  for (const address of addresses) {
    const base = new URL(VIEWER, location.href);
    if (!URL.canParse(address, base))
      throw new InvalidArgumentError('src', `src is “${address}”, which is no address.`);
    clouds.push(await engine.load(new URL(address, base), { ...options, fit: 'auto' }));
  }
  return {
    title: clouds.map(({ name }) => name).join(', '),
    clouds: clouds.map((cloud) => ({ cloud })),
    camera: (aspect: number) => cameraAround(clouds[0], aspect),
  };
}

async function loadHardCase(engine: SplatEngine, name: string, options: LoadOptions) {
  const [hardCase] = chooseCases([name]);
  if (hardCase.kind !== 'scene')
    throw new InvalidArgumentError('scene', `The hard case “${name}” has no image to measure.`);
  const clouds: CloudInstance[] = [];
  for (const splats of hardCase.clouds())
    clouds.push({
      cloud: 'file' in splats ? await engine.load(splats.file, options) : engine.add(splats.set, { name }),
      modelMatrix: splats.modelMatrix,
    });
  return { title: name, clouds, camera: (aspect: number) => Object.values(hardCase.cameras(aspect))[0] };
}

async function loadBuiltin(engine: SplatEngine, name: string, options: LoadOptions) {
  const scene = builtinScenes.find((each) => each.name === name);
  if (!scene) {
    const names = builtinScenes.map((each) => each.name).join(', ');
    throw new InvalidArgumentError('scene', `There is no built-in scene “${name}”; there are ${names}.`);
  }
  const cloud = await engine.load(scene.url, { ...options, fit: 'auto' });
  const [first] = scene.cameras;
  const camera = (aspect: number) =>
    perspectiveCamera({ ...first, fovYDegrees: verticalFov(first.fovYDegrees, aspect), aspect });
  return { title: scene.title, clouds: [{ cloud }], camera };
}

/** Over the shorter side of the image. */
const FOV_DEGREES = 50;
/** A little from the side and from above, with y up. */
const DIRECTION: Vec3 = [0.325, 0.315, 0.891];
/** As a part of the scene's radius. */
const NEAR = 0.005;
/** A camera that sees all of a cloud that came without any. */
export function cameraAround(
  { bounds, robustBounds, facts }: Pick<SplatCloud, 'bounds' | 'robustBounds' | 'facts'>,
  aspect: number,
): Camera {
  const { min, max } = robustBounds;
  const sizes = min.map((low, axis) => max[axis] - low);
  const target = min.map((low, axis) => low + sizes[axis] / 2);
  const radius = Math.hypot(...sizes) / 2;
  const isGltf = facts.fileFacts?.format === 'gltf';
  // Captures mostly have y pointing down, and surveys of ground z up.
  const isZUp = !isGltf && isProbablyZUp(robustBounds);
  const [x, y, z] = DIRECTION;
  const direction = isZUp ? [z, x, y] : isGltf ? DIRECTION : [-x, -y, z];
  const up: Vec3 = isZUp ? [0, 0, 1] : [0, isGltf ? 1 : -1, 0];
  const fovYDegrees = verticalFov(FOV_DEGREES, aspect);
  const distance = radius / Math.sin((FOV_DEGREES * Math.PI) / 360);
  const position = target.map((value, axis) => value + distance * direction[axis]);
  const farthest = bounds.min.map((low, axis) =>
    Math.max(Math.abs(position[axis] - low), Math.abs(position[axis] - bounds.max[axis])),
  );
  const place: Pick<SceneCamera, 'position' | 'target'> = { position: vec3(position), target: vec3(target) };
  return perspectiveCamera({
    ...place,
    up,
    fovYDegrees,
    aspect,
    near: NEAR * radius,
    far: Math.hypot(...farthest),
  });
}

function vec3([x, y, z]: readonly number[]): Vec3 {
  return [x, y, z];
}

/** A scene with a height below this part of both its width and its length is ground. */
const GROUND_FLATNESS = 0.25;
/** Ground is at most this many times as long as wide; a longer scene may be a wall. */
const GROUND_LENGTH = 3;

/**
 * Whether a scene of this box is probably a survey of ground, by its shape alone: flat along z and
 * about as wide as long. Such are mostly in maps' coordinates, in which z points up.
 */
function isProbablyZUp({ min, max }: Bounds): boolean {
  const [x, y, z] = [0, 1, 2].map((axis) => max[axis] - min[axis]);
  const narrower = Math.min(x, y);
  return z > 0 && z < GROUND_FLATNESS * narrower && Math.max(x, y) < GROUND_LENGTH * narrower;
}
