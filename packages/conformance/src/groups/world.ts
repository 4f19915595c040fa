import { type Camera, encodePly, perspectiveCamera, type SplatSet } from '@websplatter/core';
import type { HardCase } from '../hard-case.ts';
import { scenesOf } from '../make-cases.ts';
import { logitOf, ordinarySplats, resized, type SplatValues, splatsOf } from '../make-splats.ts';

const scene = scenesOf('world');

type Place = readonly [number, number, number];

/** A place on the Earth's surface, in metres from its centre. */
const ON_EARTH: Place = [6.4e6, -3.1e6, 4.5e6];
const ORIGIN: Place = [0, 0, 0];

const HARD: SplatValues = {
  position: [0.3, -0.2, 1.5],
  logScales: [-0.2, -1, -2],
  rotation: [0.8, 0.3, -0.2, 0.4],
  opacityLogit: logitOf(0.8),
  color: [1, 0.25, 0.1],
};

/** The scene of all cases in this group, `size` times as large. */
const sized = (size: number, origin: Place = ORIGIN): SplatSet =>
  splatsOf(resized([...ordinarySplats(), HARD], size), { origin });

/** Cameras about `place` that see the scene of that size. */
const camerasAt =
  (place: Place, size: number) =>
  (aspect: number): Readonly<Record<string, Camera>> => {
    const at = (x: number, y: number, z: number): Place => [
      place[0] + size * x,
      place[1] + size * y,
      place[2] + size * z,
    ];
    const range = { near: 0.01 * size, far: 1000 * size, aspect };
    return {
      front: perspectiveCamera({ position: at(0, 0, 5), target: at(0, 0, 0), fovYDegrees: 60, ...range }),
      oblique: perspectiveCamera({
        position: at(2.1, 1.3, 4.2),
        target: at(0, 0, 0),
        fovYDegrees: 50,
        ...range,
      }),
    };
  };

const translation = (place: Place) => [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, ...place, 1];

/** A camera far away whose narrow view the scene fills all the same. */
const farCamera = (distance: number) => (aspect: number) => ({
  far: perspectiveCamera({
    position: [0, 0, distance],
    target: [0, 0, 0],
    fovYDegrees: (360 / Math.PI) * Math.atan(2.9 / distance),
    aspect,
    near: 0.5 * distance,
    far: 2 * distance,
  }),
});

export const WORLD_CASES: readonly HardCase[] = [
  scene({
    name: 'world-at-the-origin',
    breaks: 'Nothing is hard here: the other places and sizes are compared with this one.',
    clouds: () => [{ set: sized(1) }],
    cameras: camerasAt(ORIGIN, 1),
  }),
  scene({
    name: 'world-millimetres-at-the-origin',
    breaks: 'Nothing is hard here: the millimetres 6.4e6 m away are compared with these.',
    clouds: () => [{ set: sized(1e-3) }],
    cameras: camerasAt(ORIGIN, 1e-3),
  }),
  scene({
    name: 'world-offset-6-4e6-by-model-matrix',
    breaks: 'Model and view are multiplied, or uploaded, in float32, which steps by half a metre there.',
    clouds: () => [{ set: sized(1e-3), modelMatrix: translation(ON_EARTH) }],
    cameras: camerasAt(ON_EARTH, 1e-3),
  }),
  scene({
    name: 'world-offset-6-4e6-by-double-properties',
    breaks: 'Doubles in the file are rounded to float32 on reading, and the scene becomes a single point.',
    clouds: () => [{ file: encodePly(sized(1e-3, ON_EARTH)) }],
    cameras: camerasAt(ON_EARTH, 1e-3),
  }),
  scene({
    name: 'world-offset-6-4e6-two-origins',
    breaks:
      'Clouds that share a place have origins of their own, and one origin for all loses the others’ millimetres.',
    clouds: () => [
      { set: sized(1e-3, ON_EARTH) },
      {
        set: splatsOf(resized(ordinarySplats(7).slice(64), 1e-3), {
          origin: [ON_EARTH[0] - 4096, ON_EARTH[1], ON_EARTH[2]],
        }),
        modelMatrix: translation([4096, 0, 0]),
      },
    ],
    cameras: camerasAt(ON_EARTH, 1e-3),
  }),
  scene({
    name: 'world-size-1e-6',
    breaks: 'Fixed epsilons and squares of micrometres make everything vanish.',
    clouds: () => [{ set: sized(1e-6) }],
    cameras: camerasAt(ORIGIN, 1e-6),
  }),
  scene({
    name: 'world-size-1e6',
    breaks: 'Fixed far planes and fourth powers of a thousand kilometres make everything vanish.',
    clouds: () => [{ set: sized(1e6) }],
    cameras: camerasAt(ORIGIN, 1e6),
  }),
  scene({
    name: 'world-camera-1e7-away',
    breaks: 'Centres are computed from float32 world coordinates about the camera, where a unit is one ulp.',
    clouds: () => {
      // 4 apart in depth, which float32 still resolves at 1e7.
      const splats = [...ordinarySplats(), HARD].map((splat, i, all) => ({
        ...splat,
        position: [splat.position![0], splat.position![1], 4 * ((i * 37) % all.length) - 160],
      }));
      return [{ set: splatsOf(splats) }];
    },
    cameras: farCamera(1e7),
  }),
];
