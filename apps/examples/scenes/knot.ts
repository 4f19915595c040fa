import { encodePly, type Vec3 } from '@websplatter/core';
import { GOLDEN_RATIO, splatsOf, wheel } from './splats.ts';

const COUNT = 16_000;
const TUBE_RADIUS = 0.1;

/** A trefoil knot of small splats, lit from above, with all hues along its length. */
export function knotPly(): Uint8Array {
  const splats = splatsOf(COUNT, (i) => {
    const angle = (2 * Math.PI * i) / COUNT;
    const aroundTube = 2 * Math.PI * ((i * GOLDEN_RATIO) % 1);
    const [here, next] = [trefoil(angle), trefoil(angle + 1e-3)];
    const along = unit([next[0] - here[0], next[1] - here[1], next[2] - here[2]]);
    const side = unit(cross(along, [0, 0, 1]));
    const up = cross(side, along);
    const [cosine, sine] = [Math.cos(aroundTube), Math.sin(aroundTube)];
    const out = [0, 1, 2].map((axis) => cosine * side[axis] + sine * up[axis]);
    const light = 0.62 + 0.38 * (0.75 * out[1] + 0.6 * out[2]);
    // Stripes around the tube show its twist.
    const stripe = Math.cos(3 * aroundTube + 20 * angle) > 0.55 ? 1.25 : 1;
    return {
      position: here.map((each, axis) => each + TUBE_RADIUS * out[axis]),
      scale: [0.012, 0.003, 0.012],
      axis: out,
      color: wheel(i / COUNT, 0.5, 0.42).map((value) => value * light * stripe),
    };
  });
  return encodePly(splats);
}

const trefoil = (angle: number): Vec3 => [
  0.165 * (Math.sin(angle) + 2 * Math.sin(2 * angle)),
  0.165 * (Math.cos(angle) - 2 * Math.cos(2 * angle)),
  -0.165 * Math.sin(3 * angle),
];

const cross = (a: Vec3, b: Vec3): Vec3 => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];

function unit([x, y, z]: Vec3): Vec3 {
  const length = Math.hypot(x, y, z);
  return [x / length, y / length, z / length];
}
