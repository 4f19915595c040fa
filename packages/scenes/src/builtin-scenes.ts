/** A camera in the form that the command line and the viewer accept; metres, y up. */
export interface SceneCamera {
  readonly name: string;
  readonly position: readonly [number, number, number];
  readonly target: readonly [number, number, number];
  readonly up: readonly [number, number, number];
  readonly fovYDegrees: number;
  readonly near: number;
  readonly far: number;
}

/** A scene that comes with this package, as a file. */
export interface BuiltinScene {
  /** Identifier for command lines and URLs. */
  readonly name: string;
  /** Human-readable title. */
  readonly title: string;
  /** Number of splats. */
  readonly splats: number;
  /** URL of the file, for `engine.load`; a `file:` URL in Node. */
  readonly url: URL;
  /** Good views, the initial view first. */
  readonly cameras: readonly SceneCamera[];
}

const UP = [0, 1, 0] as const;
/** Far plane beyond the sky, 110 m from the table, for cameras anywhere on the terrace. */
const FAR_M = 400;
const NEAR_M = 0.02;

function camera(
  name: string,
  position: SceneCamera['position'],
  target: SceneCamera['target'],
  fovYDegrees: number,
): SceneCamera {
  return { name, position, target, up: UP, fovYDegrees, near: NEAR_M, far: FAR_M };
}

/** Good views of the still life, the initial view first. */
export const stillLifeCameras: readonly SceneCamera[] = [
  camera('front', [0.12, 0.45, 1.44], [0.0, 0.245, 0], 40),
  camera('left', [-1.45, 0.5, 0.62], [0, 0.235, 0], 42),
  camera('right', [1.35, 0.44, 0.66], [0, 0.25, 0], 42),
  camera('back', [0.25, 0.55, -1.65], [0, 0.255, 0], 42),
  camera('above', [0.02, 1.65, 0.5], [0.02, 0, 0.04], 42),
  camera('bowl', [0.36, 0.27, 0.5], [0.19, 0.07, 0.02], 40),
  camera('ball', [-0.16, 0.17, 0.56], [0, 0.06, 0.16], 38),
  camera('plumes', [-0.55, 0.62, 0.45], [-0.22, 0.52, -0.13], 40),
  camera('terrace', [2.6, 0.85, 3.4], [0, -0.02, 0], 34),
];

/**
 * A table laid outdoors on a late afternoon: a glazed vase of pampas plumes, a jade bowl of fruit,
 * a glass bottle, a steel ball, a loaf and a linen runner, with hills and sky around. Metres, y up,
 * the table's top at y = 0, about 1.2 m across; the sky is 110 m away. Light is baked into
 * spherical harmonics of degree 3. `still-life-small` is for software adapters, which need seconds
 * for a frame of the full scene.
 */
export const builtinScenes: readonly BuiltinScene[] = [
  {
    name: 'still-life',
    title: 'Still life',
    splats: 150_000,
    // Not a helper function: bundlers recognise this exact expression.
    url: new URL('../files/still-life.sog', import.meta.url),
    cameras: stillLifeCameras,
  },
  {
    name: 'still-life-small',
    title: 'Still life, small',
    splats: 10_000,
    url: new URL('../files/still-life-small.spz', import.meta.url),
    cameras: stillLifeCameras,
  },
];
