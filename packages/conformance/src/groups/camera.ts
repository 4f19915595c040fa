import { type Camera, cameraFromMatrices, orthographicCamera, perspectiveCamera } from '@websplatter/core';
import type { HardCase } from '../hard-case.ts';
import { amongOrdinary, front, frontAndOblique, frontOnly, scenesOf } from '../make-cases.ts';
import { LARGE, moved, ordinarySplats, splatsOf, withRandomSh } from '../make-splats.ts';

const scene = scenesOf('camera');

const frontWith = (
  change: Partial<Parameters<typeof perspectiveCamera>[0]>,
): ((aspect: number) => Readonly<Record<string, Camera>>) => {
  return (aspect) => ({
    front: perspectiveCamera({
      position: [0, 0, 5],
      target: [0, 0, 0],
      fovYDegrees: 60,
      aspect,
      ...change,
    }),
  });
};

/** `front` with some elements of its projection matrix replaced, by index. */
const frontWithProjection = (elements: Readonly<Record<number, (value: number) => number>>) => {
  return (aspect: number) => {
    const { viewMatrix, projectionMatrix, near, far } = front(aspect);
    const changed = Array.from(projectionMatrix, (value, i) => elements[i]?.(value) ?? value);
    return { front: cameraFromMatrices(viewMatrix, changed, { near, far }) };
  };
};

/** A model matrix from the columns of its linear part and its translation. */
const model = (x: readonly number[], y: readonly number[], z: readonly number[], t = [0, 0, 0]) => [
  ...[...x, 0],
  ...[...y, 0],
  ...[...z, 0],
  ...[...t, 1],
];

/** Splats whose colours depend on the direction, so that a wrong direction shows. */
const colourful = (seed: number) => withRandomSh([...ordinarySplats(seed), LARGE], 3, 0.25);

/** A cloud under `modelMatrix`, in front of another without a matrix. */
const modelled = (modelMatrix: readonly number[]) => () => [
  { set: splatsOf(moved(ordinarySplats(2), [0, 0, -3])) },
  { set: splatsOf(colourful(3), { shDegree: 3 }), modelMatrix },
];

export const CAMERA_CASES: readonly HardCase[] = [
  scene({
    name: 'camera-inside-a-splat',
    breaks: 'A splat around the camera is dropped for its size, or its quad overflows.',
    clouds: amongOrdinary([{ ...LARGE, position: [0.1, 0.05, 4.6], logScales: [0.7, 0.7, 0.7] }]),
    cameras: frontOnly,
  }),
  scene({
    name: 'camera-at-a-splats-centre',
    breaks: 'The centre is at depth 0 and is divided by; the direction to it is 0/0.',
    clouds: () => [
      {
        set: splatsOf(withRandomSh([...ordinarySplats(), { ...LARGE, position: [0, 0, 5] }], 3, 0.2), {
          shDegree: 3,
        }),
      },
    ],
    cameras: frontOnly,
  }),
  scene({
    name: 'camera-just-behind-a-splats-centre',
    breaks:
      'At the near plane the projected size is so large that squares overflow and the splat turns into NaN.',
    clouds: amongOrdinary([{ ...LARGE, position: [0.002, 0.001, 4.98], logScales: [1, 0, -4] }]),
    cameras: frontOnly,
  }),
  scene({
    name: 'camera-along-a-needle',
    breaks: 'Seen end on, a needle is a circle with no major axis, and normalising that axis gives NaN.',
    clouds: amongOrdinary([
      { ...LARGE, position: [0, 0, 0], rotation: [1, 0, 0, 0], logScales: [-5, -5, 1] },
      {
        ...LARGE,
        position: [0.8, 0.5, 0],
        rotation: [1, 0, 0, 0],
        logScales: [-5, -5, 1],
        color: [0.1, 1, 0.3],
      },
    ]),
  }),
  ...[37, 90, 180].map((rollDegrees) =>
    scene({
      name: `camera-roll-${rollDegrees}`,
      breaks: 'Up is taken for the y axis somewhere, and ellipses lean the wrong way.',
      clouds: amongOrdinary([{ ...LARGE, logScales: [0, -2, -3] }]),
      cameras: frontWith({
        up: [Math.sin((rollDegrees * Math.PI) / 180), Math.cos((rollDegrees * Math.PI) / 180), 0],
      }),
    }),
  ),
  scene({
    name: 'camera-fov-1',
    breaks:
      'A focal length of thousands of pixels loses the sub-pixel part of centres that are kept in float16.',
    clouds: amongOrdinary([LARGE]),
    cameras: frontWith({ fovYDegrees: 1, position: [60, 40, 300], near: 1 }),
  }),
  scene({
    name: 'camera-fov-60',
    breaks: 'Nothing is hard here: the other fields of view are compared with this one.',
    clouds: amongOrdinary([LARGE]),
  }),
  scene({
    name: 'camera-fov-120',
    breaks:
      'Far off the axis the Jacobian stretches splats over the image where it is not clamped as in training.',
    clouds: amongOrdinary([LARGE]),
    cameras: frontWith({ fovYDegrees: 120, position: [0.2, 0.1, 2.5] }),
  }),
  scene({
    name: 'camera-fov-170',
    breaks: 'Culling by angles or by the centre alone loses what reaches in from outside a very wide view.',
    clouds: amongOrdinary([LARGE]),
    cameras: frontWith({ fovYDegrees: 170, position: [0.1, 0.2, 2.2], near: 0.1 }),
  }),
  scene({
    name: 'camera-orthographic',
    breaks: 'Sizes and directions are divided by a depth that means nothing in this projection.',
    clouds: () => [{ set: splatsOf(colourful(4), { shDegree: 3 }) }],
    cameras: (aspect) => ({
      front: orthographicCamera({ position: [0, 0, 5], target: [0, 0, 0], aspect, height: 6 }),
      oblique: orthographicCamera({ position: [3, 2, 4], target: [0.1, 0, 0], aspect, height: 5 }),
    }),
  }),
  scene({
    name: 'camera-orthographic-negative-near',
    breaks:
      'Splats at negative depths, which this camera sees, are dropped as behind it, or sorted in reverse.',
    clouds: () => [{ set: splatsOf(colourful(5), { shDegree: 3 }) }],
    cameras: (aspect) => ({
      within: orthographicCamera({
        position: [0.1, 0.2, 0],
        target: [0, 0, -1],
        aspect,
        height: 6,
        near: -20,
        far: 20,
      }),
    }),
  }),
  scene({
    name: 'camera-off-centre',
    breaks:
      'The principal point is assumed in the middle of the image, by the projection or by the clamp of the Jacobian.',
    clouds: amongOrdinary([LARGE]),
    cameras: frontWithProjection({ 8: () => 0.45, 9: () => -0.3 }),
  }),
  scene({
    name: 'camera-off-centre-axis-outside',
    breaks:
      'A tile of a larger image does not contain the line of sight, and symmetric culling drops what it shows.',
    clouds: amongOrdinary([{ ...LARGE, position: [-2, 1.5, 0] }]),
    cameras: frontWithProjection({ 0: (f) => 3 * f, 5: (f) => 3 * f, 8: () => -2, 9: () => 1.5 }),
  }),
  scene({
    name: 'camera-mirrored-projection',
    breaks:
      'A negative focal length, as y-down projections have, swaps the image’s edges in the culling test.',
    clouds: amongOrdinary([LARGE]),
    cameras: frontWithProjection({ 5: (f) => -f, 9: () => 0.2 }),
  }),
  ...(
    [
      [
        'model-mirrored-1-minus-1-1',
        'A mirrored model is not a rotation: turning it into a quaternion loses the mirroring.',
        model([1, 0, 0], [0, -1, 0], [0, 0, 1]),
      ],
      [
        'model-mirrored-minus-1-2-half',
        'Non-uniform scale is applied to centres but not to shapes, or directions use the transpose for the inverse.',
        model([-1, 0, 0], [0, 2, 0], [0, 0, 0.5]),
      ],
      [
        'model-sheared',
        'A sheared model has no rotation and scale to be split into.',
        model([1, 0, 0], [0.7, 1, 0.2], [-0.4, 0.3, 1], [0.2, 0.1, 0]),
      ],
      [
        'model-rotated-and-scaled',
        'The order of scale and rotation is swapped, which only a scale along one turned axis shows.',
        model([0, 1.5, 0], [-0.6, 0, 0], [0, 0, 0.8], [0, 0, 0.5]),
      ],
      [
        'model-uniform-1e-3',
        'Scales are taken from the model as if its length were one.',
        model([1e-3, 0, 0], [0, 1e-3, 0], [0, 0, 1e-3], [0.1, 0.1, 4.99]),
      ],
    ] as const
  ).map(([name, breaks, modelMatrix]) =>
    scene({
      name,
      breaks,
      clouds: modelled(modelMatrix),
      cameras: name === 'model-uniform-1e-3' ? frontOnly : frontAndOblique,
    }),
  ),
  scene({
    name: 'model-singular-flat-in-depth',
    breaks:
      'Inverting the matrix for the viewing direction gives Inf; all depths are equal, seen from the front.',
    clouds: modelled(model([1, 0, 0], [0, 1, 0], [0, 0, 0])),
    cameras: frontOnly,
    identicalFrames: 100,
  }),
  scene({
    name: 'model-singular-flat-seen-obliquely',
    breaks: 'A flattened cloud has depths of its own again, but still no inverse for its directions.',
    clouds: modelled(model([1, 0, 0], [0, 1, 0], [0, 0, 0])),
  }),
  scene({
    name: 'model-singular-seen-edge-on',
    breaks: 'A cloud that is flattened edge on has covariances of rank one and no inverse for directions.',
    clouds: modelled(model([0, 0, 0], [0, 1, 0], [0, 0, 1])),
  }),
  scene({
    name: 'model-singular-all-zero',
    breaks: 'Every splat lies at one point with no size but the dilation, and no direction can be inverted.',
    clouds: modelled(model([0, 0, 0], [0, 0, 0], [0, 0, 0], [0.25, 0.5, 1])),
    cameras: frontOnly,
    identicalFrames: 100,
  }),
  scene({
    name: 'camera-near-beyond-the-hard-splat',
    breaks:
      'A near plane farther than the scene’s middle clamps depths to it instead of dropping what is nearer.',
    clouds: amongOrdinary([LARGE]),
    cameras: frontWith({ near: 7 }),
  }),
  scene({
    name: 'camera-near-beyond-everything',
    breaks: 'With nothing left to draw, a dispatch or a draw of size 0 is refused, or the last image stays.',
    clouds: amongOrdinary([LARGE]),
    cameras: frontWith({ near: 50 }),
  }),
  ...[
    { widthPx: 0, heightPx: 0 },
    { widthPx: 0, heightPx: 64 },
  ].map((size) =>
    scene({
      name: `viewport-${size.widthPx}x${size.heightPx}`,
      breaks:
        'A window that is folded away asks for a texture of size 0, which is an error, or divides by its height.',
      clouds: amongOrdinary([LARGE]),
      size,
    }),
  ),
  scene({
    name: 'viewport-1x1',
    breaks: 'An image of one pixel makes grids of tiles of size 0 or divides by width − 1.',
    clouds: amongOrdinary([LARGE]),
    size: { widthPx: 1, heightPx: 1 },
  }),
  scene({
    name: 'viewport-8192-wide',
    breaks: 'Centres in float16 step by 4 pixels at 8192, and tile numbers overflow 8 or 16 bits.',
    clouds: amongOrdinary([LARGE]),
    size: { widthPx: 8192, heightPx: 8 },
    // 60 degrees from side to side at any height.
    cameras: (aspect) =>
      frontWith({ fovYDegrees: (360 / Math.PI) * Math.atan(Math.tan(Math.PI / 6) / aspect) })(aspect),
  }),
  scene({
    name: 'viewport-8192-tall',
    breaks: 'As 8192 wide, in the other direction.',
    clouds: amongOrdinary([LARGE]),
    size: { widthPx: 8, heightPx: 8192 },
    cameras: frontOnly,
  }),
];
