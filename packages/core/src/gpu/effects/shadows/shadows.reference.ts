import { depthMapping } from '../../../data/camera/depth-convention.ts';
import { linearPart, multiply4, transform3, translated4, type Vec3 } from '../../../data/math/mat4.ts';
import { rotationMatrix } from '../../../reference/covariance.ts';
import type { EffectReference, SplatValues } from '../../../reference/effects/effect-reference.ts';
import { leftAt, leftInCone } from '../../../reference/effects/light-falloff.ts';
import { decodeSrgb, encodeSrgb } from '../../../reference/srgb.ts';
import type { EffectPlace } from '../effect.ts';
import type { ShadowLight, ShadowsOptions } from './shadows.ts';

/** The contents of a shadow map, top row first. */
export interface MapDepths {
  readonly widthPx: number;
  readonly heightPx: number;
  readonly depths: ArrayLike<number>;
}

/** Each map has its contents in `depthsOf`: the CPU cannot read textures. */
export function reference(
  options: ShadowsOptions & { readonly depthsOf?: (map: GPUTexture) => MapDepths },
  place: EffectPlace,
): EffectReference {
  const { lights, steady = [0, 0, 0], depthsOf } = options;
  if (!depthsOf) throw new RangeError('The reference of shadows takes the depths of maps in depthsOf.');
  return {
    changeColor(color, splat) {
      const found = lights.map((light) => lightAt(light, depthsOf(light.map), splat, place));
      const kept = (value: number, channel: 0 | 1 | 2) => {
        const of = (light: ShadowLight, i: number) => light.irradiance[channel] * found[i].falloff;
        const all = lights.reduce((sum, light, i) => sum + of(light, i), steady[channel]);
        const taken = lights.reduce(
          (sum, light, i) => sum + of(light, i) * (light.strength ?? 1) * (1 - found[i].through),
          0,
        );
        return encodeSrgb(decodeSrgb(value) * (all > 0 ? 1 - taken / all : 1));
      };
      return [kept(color[0], 0), kept(color[1], 1), kept(color[2], 2)];
    },
  };
}

/** Part of a light that would reach a splat's centre, and share of it that nothing is in front of. */
function lightAt(
  light: ShadowLight,
  map: MapDepths,
  { position, rotation, logScales }: SplatValues,
  { modelMatrix, origin }: EffectPlace,
): { readonly falloff: number; readonly through: number } {
  const { camera, depth = { compare: 'less-equal', mapping: 'projection' }, bias = 0, offset = 0 } = light;
  const { projectionMatrix: p } = camera;
  const toView = multiply4(camera.viewMatrix, translated4(modelMatrix, origin));
  const linear = linearPart(toView);
  const inView = transform3(linear, position).map((value, axis) => value + toView[12 + axis]);
  const depthView = -inView[2];
  const isOrthographic = p[11] === 0;
  const w = isOrthographic ? p[15] : -p[11] * depthView;
  const ndc = [0, 1].map(
    (axis) => (p[axis] * inView[0] + p[4 + axis] * inView[1] + p[8 + axis] * inView[2] + p[12 + axis]) / w,
  );
  const falloff = falloffAt(light, inView as unknown as Vec3);
  if (isOrthographic ? false : depthView <= 0) return { falloff, through: 1 };
  const [rw, rx, ry, rz] = rotation;
  // Row-major: column `axis` is the splat's own axis in the cloud.
  const axes = rotationMatrix(rw, rx, ry, rz);
  const spread = Math.hypot(
    ...logScales.map(
      (log, axis) => Math.exp(log) * transform3(linear, [axes[axis], axes[3 + axis], axes[6 + axis]])[2],
    ),
  );
  const nearer = depthView - 3 * spread - offset;
  if (ndc.some((value) => Math.abs(value) > 1) || (!isOrthographic && nearer <= 0))
    return { falloff, through: 1 };
  const { offset: at, factor } = depthMapping(camera, depth.mapping);
  const form = isOrthographic ? nearer : depth.mapping === 'projection' ? 1 / nearer : Math.log2(nearer);
  const away = depth.compare === 'less-equal' ? 1 : -1;
  const tested = away * (at + factor * form) + bias;
  const { widthPx, heightPx, depths } = map;
  const x = (0.5 + 0.5 * ndc[0]) * widthPx - 0.5;
  const y = (0.5 - 0.5 * ndc[1]) * heightPx - 0.5;
  const weights = (place: number) => {
    const part = place - Math.floor(place);
    return [1 - part, 1, 1, part];
  };
  const clamped = (value: number, size: number) => Math.min(Math.max(value, 0), size - 1);
  let through = 0;
  for (const [row, weightY] of weights(y).entries())
    for (const [column, weightX] of weights(x).entries()) {
      const texelX = clamped(Math.floor(x) + column - 1, widthPx);
      const texelY = clamped(Math.floor(y) + row - 1, heightPx);
      if (tested <= away * depths[texelY * widthPx + texelX]) through += (weightX * weightY) / 9;
    }
  return { falloff, through };
}

/** As three's lights fall off. */
function falloffAt({ cone }: ShadowLight, inView: Vec3): number {
  if (!cone) return 1;
  if (inView[2] >= 0) return 0;
  const distance = Math.hypot(...inView);
  return leftAt(distance, cone) * leftInCone(-inView[2] / distance, cone);
}
