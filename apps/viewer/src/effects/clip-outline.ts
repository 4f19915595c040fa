import { type ClipValues, planeNormal } from '@websplatter/core/effect-options';
import { boxOutline, circleOutline, type Outline } from '../camera/picture-space.ts';
import { add, cross, normalize, scale, subtract, UNIT_AXES, type Vec3 } from '../state/vec3.ts';

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
  if (shape === 'sphere') return AXIS_PAIRS.map(([u, v]) => circleOutline(center, u, v, values.radius));
  return planeOutline(center, planeNormal(values), planeRadius, values.keep === 'inside' ? 1 : -1);
}

const [X, Y, Z] = UNIT_AXES;
const AXIS_PAIRS = [
  [X, Y],
  [Y, Z],
  [Z, X],
] as const;

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
