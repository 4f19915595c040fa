import { linearPart, multiply4, transform3, translated4, type Vec3 } from '../../../data/math/mat4.ts';
import { rotationMatrix } from '../../../reference/covariance.ts';
import type { EffectReference, SplatValues } from '../../../reference/effects/effect-reference.ts';
import { leftAt, leftInCone } from '../../../reference/effects/light-falloff.ts';
import { decodeSrgb, encodeSrgb } from '../../../reference/srgb.ts';
import type { EffectPlace } from '../effect.ts';
import type { RelightLight, RelightOptions } from './relight.ts';

/** Mean of max(0, cos θ) over all directions. */
const EVENLY_LIT = 1 / 4;

export function reference(options: RelightOptions, place: EffectPlace): EffectReference {
  const { lights = [], ambient = [0, 0, 0], strength = 1 } = options;
  return {
    changeColor(color, splat, _index, centerView) {
      const surface = surfaceOf(splat, centerView, place);
      const sum = [...ambient];
      for (const light of lights)
        for (const [channel, value] of irradianceOf(light, surface, place).entries()) sum[channel] += value;
      const lit = (value: number, channel: 0 | 1 | 2) =>
        encodeSrgb(decodeSrgb(value) * (1 - strength + (strength * sum[channel]) / Math.PI));
      return [lit(color[0], 0), lit(color[1], 1), lit(color[2], 2)];
    },
  };
}

/** A splat as light meets it, in view space. */
interface Surface {
  readonly center: Vec3;
  /** Of length 1. */
  readonly normal: Vec3;
  /** Weight of the normal, 0…1. */
  readonly flatness: number;
}

function surfaceOf(
  { rotation, logScales }: SplatValues,
  center: Vec3,
  { modelMatrix, origin, viewMatrix, projection }: EffectPlace,
): Surface {
  const toView = linearPart(multiply4(viewMatrix, translated4(modelMatrix, origin)));
  const m = rotationMatrix(...rotation);
  const axes = logScales
    .map((log, axis) => ({ scale: Math.exp(log), axis: [m[axis], m[3 + axis], m[6 + axis]] as const }))
    .toSorted((a, b) => a.scale - b.scale);
  // A normal stays perpendicular to the two longer axes.
  const normal = cross(transform3(toView, axes[1].axis), transform3(toView, axes[2].axis));
  const size = Math.hypot(...normal);
  if (size === 0) return { center, normal: [0, 0, 0], flatness: 0 };
  const toEye = projection.isOrthographic ? [0, 0, 1] : center.map((value) => -value);
  const side = dot(normal, toEye) < 0 ? -1 : 1;
  const [x, y, z] = normal.map((value) => (side * value) / size);
  return { center, normal: [x, y, z], flatness: 1 - axes[0].scale / axes[1].scale };
}

function irradianceOf(
  light: RelightLight,
  { center, normal, flatness }: Surface,
  { viewMatrix }: EffectPlace,
): number[] {
  const turned = (direction: Vec3) => unit(transform3(linearPart(viewMatrix), direction));
  const lambert = (toLight: readonly number[]) =>
    flatness * Math.max(0, dot(normal, toLight)) + (1 - flatness) * EVENLY_LIT;
  const { irradiance } = light;
  if (light.kind === 'hemisphere') {
    const sky = 0.5 + 0.5 * flatness * dot(normal, turned(light.up));
    return irradiance.map((value, channel) => sky * value + (1 - sky) * light.ground[channel]);
  }
  if (light.kind === 'directional') {
    const factor = lambert(turned(light.direction).map((value) => -value));
    return irradiance.map((value) => factor * value);
  }
  const place = transform3(linearPart(viewMatrix), light.position);
  const way = place.map((value, axis) => value + viewMatrix[12 + axis] - center[axis]);
  const distance = Math.hypot(...way);
  const toLight = unit(way);
  const left =
    light.kind === 'point'
      ? leftAt(distance, light)
      : leftAt(distance, light.cone) * leftInCone(-dot(turned(light.direction), toLight), light.cone);
  return irradiance.map((value) => left * lambert(toLight) * value);
}

function unit(v: readonly number[]): number[] {
  const length = Math.hypot(...v);
  return v.map((value) => (length > 0 ? value / length : 0));
}

function dot(a: readonly number[], b: readonly number[]): number {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

function cross(a: readonly number[], b: readonly number[]): number[] {
  return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
}
