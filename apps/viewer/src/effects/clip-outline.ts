import { type ClipValues, planeNormal } from '@websplatter/core/effect-options';
import { add, cross, normalize, scale, subtract, type Vec3 } from '../camera/vec3.ts';

/** Lines of the world, each a row of points. */
export type Outline = readonly (readonly Vec3[])[];

const CIRCLE_POINTS = 48;

/**
 * Lines of a clip volume: the edges of its box, three circles of its sphere, a square in its plane.
 *
 * @param planeRadius half the length of that square.
 */
export function clipOutline(values: ClipValues, planeRadius: number): Outline {
  const { shape, center } = values;
  if (shape === 'box') {
    const half = scale(values.size, 0.5);
    return boxOutline(subtract(center, half), add(center, half));
  }
  if (shape === 'sphere') return AXIS_PAIRS.map(([u, v]) => circle(center, u, v, values.radius));
  return planeOutline(center, planeNormal(values), planeRadius, values.keep === 'inside' ? 1 : -1);
}

const [X, Y, Z]: readonly Vec3[] = [
  [1, 0, 0],
  [0, 1, 0],
  [0, 0, 1],
];
const AXIS_PAIRS = [
  [X, Y],
  [Y, Z],
  [Z, X],
] as const;

/** The twelve edges of a box. */
export function boxOutline(min: Vec3, max: Vec3): Outline {
  const level = (y: number): Vec3[] => [
    [min[0], y, min[2]],
    [max[0], y, min[2]],
    [max[0], y, max[2]],
    [min[0], y, max[2]],
    [min[0], y, min[2]],
  ];
  const [below, above] = [level(min[1]), level(max[1])];
  return [below, above, ...below.slice(1).map((point, i) => [point, above[i + 1]])];
}

function circle(center: Vec3, u: Vec3, v: Vec3, radius: number): Vec3[] {
  return Array.from({ length: CIRCLE_POINTS + 1 }, (_, i) => {
    const angle = (2 * Math.PI * i) / CIRCLE_POINTS;
    return add(center, add(scale(u, radius * Math.cos(angle)), scale(v, radius * Math.sin(angle))));
  });
}

/** A square, and a line from its middle to the side that stays. */
function planeOutline(center: Vec3, normal: Vec3, radius: number, side: 1 | -1): Outline {
  const u = normalize(cross(Math.abs(normal[1]) > 0.9 ? X : Y, normal));
  const v = cross(normal, u);
  const corner = (a: number, b: number) => add(center, add(scale(u, a * radius), scale(v, b * radius)));
  return [
    [corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1), corner(-1, -1)],
    [center, add(center, scale(normal, (side * radius) / 3))],
  ];
}
