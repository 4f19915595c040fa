import type { SceneKind, Vec3 } from '@websplatter/core';
import type { CameraProperty, FirstCamera, FramingCase, HardCase } from '../hard-case.ts';
import { logitOf, moved, resized, type SplatValues, seededRandom, splatsOf, turned } from '../make-splats.ts';

// Cameras are compared bit for bit, so splats are made of operations that all engines round alike.
// Logarithms are not, but float32, to which they are rounded, has none of the digits that differ.

const dot = (a: Vec3, b: Vec3) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const minus = (a: Vec3, b: Vec3): Vec3 => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const length = (v: Vec3) => Math.sqrt(dot(v, v));
const cross = (a: Vec3, b: Vec3): Vec3 => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];
const degreesBetween = (a: Vec3, b: Vec3) =>
  (Math.acos(Math.min(1, dot(a, b) / length(a) / length(b))) * 180) / Math.PI;
const placeOf = ({ position = [0, 0, 0] }: SplatValues): Vec3 => [position[0], position[1], position[2]];

/** Makes splats, y up, in metres: the same ones of the same seed. */
function makers(seed: number) {
  const random = seededRandom(seed);
  const between = (min: Vec3, max: Vec3) => min.map((low, axis) => low + random() * (max[axis] - low));
  /** A splat ten times as wide as thick, across a unit vector. */
  const flat = (position: readonly number[], [x, y, z]: Vec3, sizeM: number): SplatValues => ({
    position,
    logScales: [Math.log(sizeM / 10), Math.log(sizeM), Math.log(sizeM)],
    // The shortest turn from the axis x, which for −x, as flat as x, is none.
    rotation: [1 + x, 0, -z, y],
    opacityLogit: logitOf(0.95),
  });

  /** A rectangle, given as a box without thickness along the axis across it. */
  const sheet = (min: Vec3, max: Vec3, count: number, sizeM = 0.05): SplatValues[] => {
    const normal = min.map((low, axis) => (low === max[axis] ? 1 : 0)) as unknown as Vec3;
    return Array.from({ length: count }, () => flat(between(min, max), normal, sizeM));
  };
  const box = (min: Vec3, max: Vec3, countOfSide: number, sizeM = 0.05): SplatValues[] =>
    [0, 1, 2].flatMap((across) =>
      [min[across], max[across]].flatMap((at) => {
        const on = (corner: Vec3) => corner.map((value, axis) => (axis === across ? at : value));
        return sheet(on(min) as unknown as Vec3, on(max) as unknown as Vec3, countOfSide, sizeM);
      }),
    );
  /** A sphere, or the part of it above a height. */
  const sphere = (
    center: Vec3,
    radiusM: number,
    count: number,
    sizeM: number,
    lowest = Number.NEGATIVE_INFINITY,
  ) => {
    const splats: SplatValues[] = [];
    while (splats.length < count) {
      // Marsaglia's method, which needs no sine.
      const [u, v] = between([-1, -1, 0], [1, 1, 0]);
      const s = u * u + v * v;
      if (s >= 1) continue;
      const normal: Vec3 = [2 * u * Math.sqrt(1 - s), 2 * v * Math.sqrt(1 - s), 1 - 2 * s];
      const position = center.map((value, axis) => value + radiusM * normal[axis]);
      if (position[1] >= lowest) splats.push(flat(position, normal, sizeM));
    }
    return splats;
  };
  /** Round splats all over a box. */
  const cloud = (min: Vec3, max: Vec3, count: number, sizeM: number, opacity = 0.9): SplatValues[] =>
    Array.from({ length: count }, () => ({
      position: between(min, max),
      logScales: [Math.log(sizeM), Math.log(sizeM), Math.log(sizeM)],
      opacityLogit: logitOf(opacity),
    }));
  return { sheet, box, sphere, cloud };
}

/** A figure of 2 m on a plinth. */
function figure(): SplatValues[] {
  const { box, sphere } = makers(1);
  return [
    ...box([-0.3, 0, -0.3], [0.3, 0.9, 0.3], 80),
    ...box([-0.2, 0.9, -0.12], [0.2, 1.6, 0.12], 80, 0.04),
    ...sphere([0, 1.8, 0], 0.2, 240, 0.03),
  ];
}

/** The figure on a small square of ground. */
const statue = () => [...figure(), ...makers(2).sheet([-1.5, 0, -1.5], [1.5, 0, 1.5], 600, 0.06)];

/** The statue in a park: grass, bushes, and a dome of sky. */
function park(): SplatValues[] {
  const { sheet, cloud, sphere } = makers(3);
  return [
    ...statue(),
    ...sheet([-20, -0.02, -20], [20, -0.02, 20], 900, 0.6),
    ...cloud([6, 0, -9], [9, 2, 9], 250, 0.2),
    ...cloud([-9, 0, -9], [-7, 1.5, 9], 250, 0.2),
    ...sphere([0, 0, 0], 80, 300, 8, -1),
  ];
}

/** A room of 5 × 2.6 × 7 m with a table, a cupboard, a picture and a bowl. */
function room(): SplatValues[] {
  const { sheet, box, sphere } = makers(4);
  return [
    ...box([-2.5, 0, -3.5], [2.5, 2.6, 3.5], 550, 0.1),
    ...sheet([-0.8, 0.75, 0.4], [0.8, 0.75, 1.3], 200, 0.04),
    ...box([-2.4, 0, -3.4], [-1.6, 1.9, -2.2], 20),
    ...sheet([2.45, 1, -2], [2.45, 1.9, -0.5], 200, 0.03),
    ...sphere([0, 0.95, 0.8], 0.15, 150, 0.02),
  ];
}

/** A wall, with nothing around it. */
const wall = () => makers(5).sheet([-1, -1, 0], [1, 1, 0], 2000);

/** One of two clusters. */
const block = () => makers(6).box([-1, -1, -1], [1, 1, 1], 300);

/** A board whose +z side has stripes of the other sides' mean colour. */
const board = () =>
  makers(7)
    .box([-1, 0, -0.1], [1, 1.4, 0.1], 500)
    .map((splat) => {
      const [x, , z] = placeOf(splat);
      const stripe = Math.floor(20 * x) % 2 === 0 ? [1, 1, 1] : [0, 0, 0];
      return z > 0.09 ? { ...splat, color: stripe } : splat;
    });

/** Spoils three of seven splats: two are not finite, and one, like another, lies 50 m off, unseen. */
const spoilt = (splats: readonly SplatValues[]) =>
  splats.map((splat, i): SplatValues => {
    const [x, y, z] = placeOf(splat);
    if (i % 7 === 0) return { ...splat, position: [Number.NaN, y, z] };
    if (i % 7 === 2) return { ...splat, position: [x, y + 50, z], logScales: [Number.NaN, 0, 0] };
    if (i % 7 === 4) return { ...splat, position: [x + 50, y, z], opacityLogit: Number.NEGATIVE_INFINITY };
    return splat;
  });

/** y up becomes y down, as in most captures. */
const yDown = (splats: readonly SplatValues[]) => turned(splats, [0, 1, 0, 0]);
const UP_OF_Y_DOWN: Vec3 = [0, -1, 0];
/** y up becomes z up. */
const zUp = (splats: readonly SplatValues[]) => turned(splats, [1, 1, 0, 0]);
const UP_OF_Z_UP: Vec3 = [0, 0, 1];
/** y up becomes y down, and leans by 25.4°, whose sine and cosine are fractions. */
const tilted = (splats: readonly SplatValues[]) => turned(splats, [9, 40, 0, 0]);
const UP_OF_TILTED: Vec3 = [0, -1519 / 1681, 720 / 1681];

const FAR: Vec3 = [5e6, -3e6, 1e7];
/** Makes y down to z up, ten times as large, and moves it. */
const INSTANCE = [10, 0, 0, 0, 0, 0, -10, 0, 0, 10, 0, 0, 100, 200, 300, 1];

/** Tangents of half of the picture, which is 50° high and 1.6 times as wide by default. */
const TANGENT_Y = Math.tan((50 * Math.PI) / 360);
const TANGENT_X = 1.6 * TANGENT_Y;

/** The part of some places in the world that is in the picture, 0…1. */
function partInPicture({ position, target, up }: FirstCamera, places: readonly Vec3[]): number {
  const forward = minus(target, position);
  const right = cross(forward, up);
  const above = cross(right, forward);
  const inside = places.filter((place) => {
    const offset = minus(place, position);
    const depth = dot(offset, forward) / length(forward);
    return (
      Math.abs(dot(offset, right)) < TANGENT_X * depth * length(right) &&
      Math.abs(dot(offset, above)) < TANGENT_Y * depth * length(above)
    );
  });
  return inside.length / places.length;
}

const isOfKind = (kind: SceneKind): CameraProperty => ({
  what: `the kind is ${kind}`,
  holds: (camera) => camera.kind === kind,
});

const hasUp = (up: Vec3): CameraProperty => ({
  what: `up is within 3° of ${up.map((value) => Number(value.toFixed(2))).join(', ')}`,
  holds: (camera) => degreesBetween(camera.up, up) < 3,
});

/** @param subject as it lies in the world. */
const shows = (what: string, subject: () => readonly SplatValues[]): CameraProperty => ({
  what: `95 % of ${what} is in the picture`,
  holds: (camera) => partInPicture(camera, subject().map(placeOf)) >= 0.95,
});

const isAway = (from: Vec3, least: number, most: number): CameraProperty => ({
  what: `the camera is ${least} to ${most} away from ${from.join(', ')}`,
  holds: ({ position }) => {
    const distance = length(minus(position, from));
    return distance > least && distance < most;
  },
});

const isInside = (what: string, min: Vec3, max: Vec3): CameraProperty => ({
  what: `the camera is inside ${what}`,
  holds: ({ position }) => position.every((value, axis) => value > min[axis] && value < max[axis]),
});

/** The ground goes through the origin. */
const isAboveGround: CameraProperty = {
  what: 'the camera is 0.1 to 10 above the ground',
  holds: ({ position, up }) => dot(position, up) > 0.1 && dot(position, up) < 10,
};

/** @param isThere takes the angle between an axis and the way from target to camera, in degrees. */
const looksFrom = (what: string, axis: Vec3, isThere: (degrees: number) => boolean): CameraProperty => ({
  what: `the camera looks from ${what}`,
  holds: ({ position, target }) => isThere(degreesBetween(minus(position, target), axis)),
});

const showsFigure = shows('the figure', () => yDown(figure()));
const isStatue = [isOfKind('object'), hasUp(UP_OF_Y_DOWN), showsFigure];

const framing = (values: Omit<FramingCase, 'kind' | 'group'>): FramingCase => ({
  kind: 'framing',
  group: 'framing',
  ...values,
});
const cloudOf = (make: () => readonly SplatValues[]) => () => [{ set: splatsOf(make()) }];

export const FRAMING_CASES: readonly HardCase[] = [
  framing({
    name: 'framing-strays-and-failed-splats',
    breaks:
      'The camera is placed by bounds that strays thousands of units away stretch, or by a mean that failed splats at one point pull aside.',
    clouds: cloudOf(() => {
      const { cloud } = makers(8);
      const strays = cloud([-2000, -2000, -2000], [3000, 2000, 2000], 120, 5);
      return yDown([...statue(), ...strays, ...cloud([40, 40, 40], [40, 40, 40], 60, 0.01)]);
    }),
    expects: [...isStatue, isAway([0, 0, 0], 1, 12)],
    cameras: {
      f32: {
        kind: 'object',
        position: [-2.2957254710231347, -2.002625755058467, -3.6819763160850636],
        target: [0.5480276185592292, -0.5635476147532422, -0.28648674490378223],
        up: [0, -1, 0],
      },
      packed: {
        kind: 'object',
        position: [3.9197158148648623, -1.7827167722473996, -0.9862860855266083],
        target: [-0.1828499409786646, -0.7007009196555439, -0.2668439674231703],
        up: [0, -1, 0],
      },
    },
  }),
  framing({
    name: 'framing-fog-on-one-side',
    breaks: 'The camera stands in, or behind, the fog that training left on one side of the subject.',
    // On the side from which the camera looks if there is none.
    clouds: cloudOf(() =>
      yDown([...statue(), ...makers(9).cloud([-3, 0, -2.5], [3, 3, -1.5], 300, 0.5, 0.6)]),
    ),
    expects: [
      hasUp(UP_OF_Y_DOWN),
      showsFigure,
      looksFrom('a side without fog', [0, 0, 1], (degrees) => degrees > 60),
    ],
    cameras: {
      f32: {
        kind: 'object',
        position: [-0.1835940656569099, -1.6324870619537433, -3.7512693381871114],
        target: [-0.010353660043685736, -0.5999316489571698, 0.21972803799093055],
        up: [0, -1, 0],
      },
      packed: {
        kind: 'object',
        position: [-0.18359361457175374, -1.6324865824328962, -3.7512710487984693],
        target: [-0.010353145070117633, -0.5999307886456786, 0.21972779182267027],
        up: [0, -1, 0],
      },
    },
  }),
  framing({
    name: 'framing-1e7-from-the-origin',
    breaks:
      'Places far from the origin are float32 somewhere on the way, so that the camera is metres astray.',
    clouds: () => [{ set: splatsOf(yDown(statue()), { origin: FAR }) }],
    expects: [
      isOfKind('object'),
      hasUp(UP_OF_Y_DOWN),
      shows('the figure', () => moved(yDown(figure()), FAR)),
      isAway(FAR, 1, 12),
    ],
    cameras: {
      f32: {
        kind: 'object',
        position: [4999998.793064999, -3000001.892332818, 10000003.796894146],
        target: [5000000.22133478, -3000000.538947136, 9999999.884131718],
        up: [0, -1, 0],
      },
      packed: {
        kind: 'object',
        position: [4999998.793064978, -3000001.8923328086, 10000003.796894128],
        target: [5000000.221334754, -3000000.5389471306, 9999999.884131711],
        up: [0, -1, 0],
      },
    },
  }),
  framing({
    name: 'framing-size-1e-6',
    breaks: 'A length in the rules fits scenes in metres alone: all of a tiny one is nearer than that.',
    clouds: cloudOf(() => resized(yDown(statue()), 1e-6)),
    expects: [
      isOfKind('object'),
      hasUp(UP_OF_Y_DOWN),
      shows('the figure', () => resized(yDown(figure()), 1e-6)),
      isAway([0, 0, 0], 1e-6, 12e-6),
    ],
    cameras: {
      f32: {
        kind: 'object',
        position: [-0.000001206935098715665, -0.0000018923329599412602, 0.0000037968942769863775],
        target: [2.213347532488752e-7, -5.389472095840549e-7, -1.1586834892327542e-7],
        up: [0, -1, 0],
      },
      packed: {
        kind: 'object',
        position: [-0.000001206935120353618, -0.0000018923329511436867, 0.0000037968942590205283],
        target: [2.2133472779121274e-7, -5.389472044059238e-7, -1.1586835642498356e-7],
        up: [0, -1, 0],
      },
    },
  }),
  framing({
    name: 'framing-size-1e6',
    breaks: 'A length in the rules fits scenes in metres alone: all of a huge one is farther than that.',
    clouds: cloudOf(() => resized(yDown(statue()), 1e6)),
    expects: [
      isOfKind('object'),
      hasUp(UP_OF_Y_DOWN),
      shows('the figure', () => resized(yDown(figure()), 1e6)),
      isAway([0, 0, 0], 1e6, 12e6),
    ],
    cameras: {
      f32: {
        kind: 'object',
        position: [-1206935.070898541, -1892332.8242925, 3796894.0930719594],
        target: [221334.708412112, -538947.1427799433, -115868.33380148573],
        up: [0, -1, 0],
      },
      packed: {
        kind: 'object',
        position: [-1206935.091667715, -1892332.8159087505, 3796894.075902244],
        target: [221334.6840044898, -538947.1378438785, -115868.34100362768],
        up: [0, -1, 0],
      },
    },
  }),
  framing({
    name: 'framing-one-splat',
    breaks: 'The spread of one centre is 0, so that the camera stands in the splat, or at NaN.',
    clouds: cloudOf(() => [{ position: [1, 2, 3] }]),
    expects: [isAway([1, 2, 3], 0.5, 5), shows('the splat', () => [{ position: [1, 2, 3] }])],
    cameras: {
      f32: {
        kind: 'object',
        position: [0.5119324508835237, 1.793146959752989, 3.408760967050183],
        target: [1, 2, 3],
        up: [0, -1, 0],
      },
      packed: {
        kind: 'object',
        position: [0.5119324508835237, 1.793146959752989, 3.408760967050183],
        target: [1, 2, 3],
        up: [0, -1, 0],
      },
    },
  }),
  framing({
    name: 'framing-all-at-one-point',
    breaks: 'Many centres at one place have a range of 0, which is divided by.',
    clouds: cloudOf(() => Array.from({ length: 300 }, () => ({ position: [1, 2, 3] }))),
    expects: [isAway([1, 2, 3], 0.5, 5), shows('the point', () => [{ position: [1, 2, 3] }])],
    cameras: {
      f32: {
        kind: 'object',
        position: [0.5119324508835237, 1.793146959752989, 3.408760967050183],
        target: [1, 2, 3],
        up: [0, -1, 0],
      },
      packed: {
        kind: 'object',
        position: [0.5119324508835237, 1.793146959752989, 3.408760967050183],
        target: [1, 2, 3],
        up: [0, -1, 0],
      },
    },
  }),
  framing({
    name: 'framing-plane',
    breaks: 'A plane has no volume, and the camera looks at its edge, or is at NaN.',
    clouds: cloudOf(wall),
    expects: [
      shows('the plane', wall),
      looksFrom('either side, not the edge', [0, 0, 1], (degrees) => degrees < 60 || degrees > 120),
    ],
    cameras: {
      f32: {
        kind: 'object',
        position: [0.11810197254084083, -0.4694107135514854, 2.4349145579879945],
        target: [0.011347453186045547, -0.062266594844433185, -0.01210070240961565],
        up: [0, -1, 0],
      },
      packed: {
        kind: 'object',
        position: [0.11810197254084095, -0.46941071355148506, 2.4349145579879945],
        target: [0.01134745318604568, -0.062266594844433004, -0.012100702409615565],
        up: [0, -1, 0],
      },
    },
  }),
  framing({
    name: 'framing-two-far-clusters',
    breaks: 'The middle of two clusters is empty, and a camera that fits both in sees two dots from afar.',
    clouds: cloudOf(() => [...block(), ...moved(block(), [1000, 0, 0])]),
    expects: [shows('the nearer cluster', block), isAway([0, 0, 0], 2, 50)],
    cameras: {
      f32: {
        kind: 'object',
        position: [-29.004531107217076, 0.9879956321283937, -2.6803129070640166],
        target: [433.45511084950954, 52.73153293561983, 166.13063411621695],
        up: [0, -1, 0],
      },
      packed: {
        kind: 'object',
        position: [-29.004531107217076, 0.987995632128394, -2.6803129070640157],
        target: [433.45511084950954, 52.73153293561983, 166.13063411621695],
        up: [0, -1, 0],
      },
    },
  }),
  framing({
    name: 'framing-not-finite-or-transparent',
    breaks:
      'Splats that are not drawn, since they are not finite or have no opacity, count where the camera is chosen.',
    clouds: cloudOf(() => spoilt(yDown(statue()))),
    expects: [...isStatue, isAway([0, 0, 0], 1, 12)],
    cameras: {
      f32: {
        kind: 'object',
        position: [1.1940349557836532, -1.856508746058037, -3.7687017937018297],
        target: [-0.20051939667725585, -0.5350707936128494, 0.05169681136804168],
        up: [0, -1, 0],
      },
      packed: {
        kind: 'object',
        position: [1.194035156178559, -1.8565084662451958, -3.76870136204711],
        target: [-0.20051906363371239, -0.5350706394938858, 0.0516968796302056],
        up: [0, -1, 0],
      },
    },
  }),
  framing({
    name: 'framing-front-on-one-side',
    breaks: 'A board with a picture is looked at from its back, where there is as much surface.',
    clouds: cloudOf(() => yDown(board())),
    expects: [
      isOfKind('object'),
      hasUp(UP_OF_Y_DOWN),
      shows('the board', () => yDown(board())),
      looksFrom('the side of the picture', [0, 0, -1], (degrees) => degrees < 60),
    ],
    cameras: {
      f32: {
        kind: 'object',
        position: [-0.7281877865402182, -1.1500584481887772, -1.8869803988410245],
        target: [-0.127250073168176, -0.6905845759385117, 0.031209159337671176],
        up: [0, -1, 0],
      },
      packed: {
        kind: 'object',
        position: [-0.7282872826525026, -1.149490375426275, -1.8860954568150439],
        target: [-0.12748661352289092, -0.6901212864960411, 0.03165665696801898],
        up: [0, -1, 0],
      },
    },
  }),
  framing({
    name: 'framing-sky-with-y-down',
    breaks: 'The sky counts as the subject, and the camera stands outside of it, or on its head.',
    clouds: cloudOf(() => yDown(park())),
    expects: [
      isOfKind('surrounded'),
      hasUp(UP_OF_Y_DOWN),
      showsFigure,
      isAboveGround,
      isAway([0, 0, 0], 1, 20),
    ],
    cameras: {
      f32: {
        kind: 'surrounded',
        position: [3.1646239232542843, -1.6541815683188141, 0.2735853782247293],
        target: [-0.019752932930014948, -1.1228738643633918, -0.0022353726737263484],
        up: [0, -1, 0],
      },
      packed: {
        kind: 'surrounded',
        position: [3.1646239688556057, -1.6541815564696312, 0.2735852319193052],
        target: [-0.0197532216872374, -1.1228737967270712, -0.002235547940240434],
        up: [0, -1, 0],
      },
    },
  }),
  framing({
    name: 'framing-room-with-z-up',
    breaks: 'The camera stands outside of the room, or takes one of the walls for the floor.',
    clouds: cloudOf(() => zUp(room())),
    expects: [
      isOfKind('enclosed'),
      hasUp(UP_OF_Z_UP),
      isInside('the room, at the height of eyes', [-2.5, -3.5, 0.5], [2.5, 3.5, 2.3]),
    ],
    cameras: {
      f32: {
        kind: 'enclosed',
        position: [-0.7072721208844863, -3.4822357450973804, 1.3000197887413378],
        target: [0.08538597235521328, 1.03783872314479, 1.1289229147776636],
        up: [0, 0, 1],
      },
      packed: {
        kind: 'enclosed',
        position: [-0.714247567313058, -3.4841888766667943, 1.3000197887413378],
        target: [-0.5185042719618097, 1.0026172439539536, 1.1325758299676105],
        up: [0, 0, 1],
      },
    },
  }),
  framing({
    name: 'framing-tilted-place',
    breaks: 'Up is taken to be one of the axes, so that a place which follows none of them leans.',
    clouds: cloudOf(() => tilted(park())),
    expects: [
      isOfKind('surrounded'),
      hasUp(UP_OF_TILTED),
      shows('the figure', () => tilted(figure())),
      isAboveGround,
    ],
    cameras: {
      f32: {
        kind: 'surrounded',
        position: [3.16379768838883, -1.3328418977185899, 0.9474082437361134],
        target: [-0.017475048361826048, -0.8883782087108214, 0.4189165487183957],
        up: [0.000022598075941144008, -0.9035837736002776, 0.4284114419289117],
      },
      packed: {
        kind: 'surrounded',
        position: [3.1643010007484036, -1.3327507010543644, 0.9474763260749142],
        target: [-0.017471194208776443, -0.8884021991992959, 0.41892115950245834],
        up: [0.00007905273633104841, -0.9035981155683791, 0.42838118456806534],
      },
    },
  }),
  framing({
    name: 'framing-instance-turned-and-moved',
    breaks: 'The matrix of a cloud moves its centres, but not their sizes, their normals or up.',
    clouds: () => [{ set: splatsOf(yDown(statue())), modelMatrix: INSTANCE }],
    expects: [
      isOfKind('object'),
      hasUp(UP_OF_Z_UP),
      shows('the figure', () => moved(resized(zUp(figure()), 10), [100, 200, 300])),
    ],
    cameras: {
      f32: {
        kind: 'object',
        position: [87.93066568112977, 237.96895553738773, 318.92333541111265],
        target: [102.21336664017207, 198.84132259553374, 305.38947559604117],
        up: [0, 0, 1],
      },
      packed: {
        kind: 'object',
        position: [87.93066546170714, 237.96895535506738, 318.92333532179015],
        target: [102.21336638196472, 198.8413225194646, 305.38947554346987],
        up: [0, 0, 1],
      },
    },
  }),
];
