import { type ClipValues, planeNormal } from '@websplatter/core/effect-options';
import { boxOutline, type Outline } from '../camera/picture-space.ts';
import { add, cross, normalize, scale, subtract, type Vec3 } from '../camera/vec3.ts';

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
