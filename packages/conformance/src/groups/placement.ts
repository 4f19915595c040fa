import { type Camera, encodePly, orthographicCamera, perspectiveCamera } from '@websplatter/core';
import type { HardCase, HardCloud } from '../hard-case.ts';
import { front, scenesOf } from '../make-cases.ts';
import { glbOf } from '../make-glb.ts';
import { LARGE, ordinarySplats, splatsOf, withRandomSh } from '../make-splats.ts';

const scene = scenesOf('placement');

type Place = readonly [number, number, number];

/** Coordinates in metres of a map projection, where float32 steps by half a metre. */
const ON_MAP: Place = [500_000.25, 5_300_000.5, 700];

/** Splats whose colours depend on the direction. */
const colourful = () => splatsOf(withRandomSh([...ordinarySplats(5), LARGE], 3, 0.25), { shDegree: 3 });
const plain = (origin?: Place) => splatsOf([...ordinarySplats(5), LARGE], { origin });

/** A matrix from the columns of its linear part and its translation, column-major. */
const matrixOf = (x: Place, y: Place, z: Place, t: Place = [0, 0, 0]) => [
  ...[...x, 0],
  ...[...y, 0],
  ...[...z, 0],
  ...[...t, 1],
];
const translation = (to: Place) => matrixOf([1, 0, 0], [0, 1, 0], [0, 0, 1], to);

/** A third of a turn about the oblique axis 1, 1, 1, then lengths of 1.3, 0.6 and 0.9. */
const UNEVEN = matrixOf([0, 0.6, 0], [0, 0, 0.9], [1.3, 0, 0], [0.2, -0.1, 0.3]);
/** Stretched along axes that it turns neither to one another nor back. */
const SHEARED = matrixOf([1, 0.3, 0], [0.5, 1, -0.2], [0, 0.4, 0.8], [0, 0, 0.1]);
const MIRRORED = matrixOf([-1.2, 0, 0], [0, 0.7, 0], [0, 0, 1], [0.1, 0, 0]);
/** An eighth of a turn about z, and an uneven scale before it: together they shear. */
const TURN = matrixOf([Math.SQRT1_2, Math.SQRT1_2, 0], [-Math.SQRT1_2, Math.SQRT1_2, 0], [0, 0, 1]);
const STRETCH = matrixOf([1.4, 0, 0], [0, 0.6, 0], [0, 0, 1]);
/** STRETCH · TURN. */
const STRETCHED_TURN = matrixOf(
  [1.4 * Math.SQRT1_2, 0.6 * Math.SQRT1_2, 0],
  [-1.4 * Math.SQRT1_2, 0.6 * Math.SQRT1_2, 0],
  [0, 0, 1],
);

/** `front` and an oblique camera about a place. */
const camerasAt =
  ([x, y, z]: Place) =>
  (aspect: number): Readonly<Record<string, Camera>> => ({
    front: perspectiveCamera({ position: [x, y, z + 5], target: [x, y, z], fovYDegrees: 60, aspect }),
    oblique: perspectiveCamera({
      position: [x + 2.1, y + 1.3, z + 4.2],
      target: [x, y, z],
      fovYDegrees: 50,
      aspect,
    }),
  });

const frontAndOrthographic = (aspect: number): Readonly<Record<string, Camera>> => ({
  front: front(aspect),
  orthographic: orthographicCamera({ position: [3, 2, 5], target: [0, 0, 0], height: 6, aspect }),
});

/** A file, of doubles, of the splats of `plain` about ON_MAP, and of some that lie elsewhere. */
const withStrays = (strays: readonly Place[]) => (): readonly HardCloud[] => {
  const apart = strays.map((place) => ({
    ...LARGE,
    position: place.map((value, axis) => value - ON_MAP[axis]),
  }));
  return [{ file: encodePly(splatsOf([...ordinarySplats(5), LARGE, ...apart], { origin: ON_MAP })) }];
};

export const PLACEMENT_CASES: readonly HardCase[] = [
  scene({
    name: 'placement-node-far',
    breaks: 'The translation of a glTF’s node is added in float32, which steps by half a metre there.',
    clouds: () => [{ file: glbOf(plain(), [{ matrix: translation(ON_MAP) }]) }],
    truth: () => [{ set: plain(), modelMatrix: translation(ON_MAP) }],
    cameras: camerasAt(ON_MAP),
  }),
  scene({
    name: 'placement-nodes-there-and-back',
    breaks: 'Positions are rounded between two nodes that lie 5,000 km away from each other.',
    clouds: () => [
      {
        file: glbOf(plain(), [
          { matrix: translation([-ON_MAP[0], -ON_MAP[1], -ON_MAP[2]]) },
          { matrix: translation(ON_MAP) },
        ]),
      },
    ],
    truth: () => [{ set: plain() }],
  }),
  scene({
    name: 'placement-doubles-one-stray-at-0',
    breaks:
      'One failed point at 0 makes the bounds so large that far positions are kept about 0, in float32.',
    clouds: withStrays([[0, 0, 0]]),
    truth: () => [{ set: plain(ON_MAP) }],
    cameras: camerasAt(ON_MAP),
  }),
  scene({
    name: 'placement-doubles-ten-strays-at-1e7',
    breaks: 'Strays far beyond the scene move the middle of the bounds away from it.',
    clouds: withStrays(Array.from({ length: 10 }, (_, i): Place => [1e7, i % 2 ? -1e7 : 1e7, 1e7 + i])),
    truth: () => [{ set: plain(ON_MAP) }],
    cameras: camerasAt(ON_MAP),
  }),
  scene({
    name: 'placement-uneven-colours',
    breaks:
      'Under a matrix that scales unevenly, harmonics are evaluated along the inverse of all of it, and not along the line of sight in the world.',
    clouds: () => [{ set: colourful(), modelMatrix: UNEVEN }],
    cameras: frontAndOrthographic,
  }),
  scene({
    name: 'placement-sheared-colours',
    breaks: 'A matrix that shears has no rotation to read off, and colours are turned by none.',
    clouds: () => [{ set: colourful(), modelMatrix: SHEARED }],
    cameras: frontAndOrthographic,
  }),
  scene({
    name: 'placement-mirrored-uneven-colours',
    breaks: 'A mirror that also scales unevenly is taken for a rotation, or its scale for a turn.',
    clouds: () => [{ set: colourful(), modelMatrix: MIRRORED }],
    cameras: frontAndOrthographic,
  }),
  scene({
    name: 'placement-node-uneven-colours',
    breaks: 'The same matrix gives other colours by a glTF’s node than by the cloud’s matrix.',
    clouds: () => [{ file: glbOf(colourful(), [{ matrix: UNEVEN }]) }],
    truth: () => [{ set: colourful(), modelMatrix: UNEVEN }],
  }),
  scene({
    name: 'placement-nodes-shear-colours',
    breaks: 'Nested nodes that shear are refused, or the columns of their product are taken for a rotation.',
    clouds: () => [{ file: glbOf(colourful(), [{ matrix: STRETCH }, { matrix: TURN }]) }],
    truth: () => [{ set: colourful(), modelMatrix: STRETCHED_TURN }],
  }),
];
