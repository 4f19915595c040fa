import { InvalidArgumentError } from '../../../data/errors.ts';
import { checkKind, given, wrongArgument } from '../../../data/given.ts';
import {
  linearPart,
  type Mat3,
  multiply4,
  transform3,
  translated4,
  type Vec3,
} from '../../../data/math/mat4.ts';
import { type EffectPlace, effectFunction, numbersOf } from '../effect.ts';
import { checkRange, checkVector } from '../option-checks.ts';
import falloff from '../shadows/falloff.wgsl?raw';
import {
  checkCone,
  checkFalloff,
  cosinesOf,
  type LightCone,
  type LightFalloff,
} from '../shadows/light-cone.ts';
import lambert from './lambert.wgsl?raw';
import wgsl from './relight.wgsl?raw';

/** Colour of a light of `relight`. */
interface Irradiance {
  /**
   * Linear red, green and blue that the light gives a surface that faces it; of a point or spot light,
   * at a distance of 1. π makes a white surface white.
   */
  readonly irradiance: Vec3;
}

/** A light of `relight`, in world space. Directions may have any length but 0. */
export type RelightLight =
  /** Parallel light that shines along `direction`. */
  | (Irradiance & { readonly kind: 'directional'; readonly direction: Vec3 })
  | (Irradiance & LightFalloff & { readonly kind: 'point'; readonly position: Vec3 })
  /** A lamp that shines along `direction`, within its cone. */
  | (Irradiance & {
      readonly kind: 'spot';
      readonly position: Vec3;
      readonly direction: Vec3;
      readonly cone: LightCone;
    })
  /** Light of the whole sky, and of the ground: `ground` is the irradiance of a surface that faces down. */
  | (Irradiance & { readonly kind: 'hemisphere'; readonly ground: Vec3; readonly up: Vec3 });

/** Options of `relight`. */
export interface RelightOptions {
  /** At most 31. Default: none. */
  readonly lights?: readonly RelightLight[];
  /** Irradiance that surfaces get from everywhere, linear red, green and blue. Default: none. */
  readonly ambient?: Vec3;
  /** From 0, colours as captured, to 1, colours as lit by the lights alone. Default: 1. */
  readonly strength?: number;
}

const MOST_LIGHTS = 31;
/** A light in the list of relight.wgsl, in the order of the shader, in view space. */
type PackedLight = {
  /** Direction to a directional light, place of a lamp, or the direction up. */
  readonly place: readonly number[];
  readonly kind: number;
  /** Of a lamp at a distance of 1. */
  readonly irradiance: readonly number[];
  readonly decay: number;
  /** Direction that a lamp shines along, or the irradiance from the ground. */
  readonly axis: readonly number[];
  /** Where a lamp's light ends, world units; 0: nowhere. */
  readonly distance: number;
  /** Of a lamp's cone and of its bright middle. */
  readonly cosines: readonly number[];
  readonly unused: readonly number[];
};
/** vec4f before the lights, and of a light. */
const FIRST_LIGHT = 4;
const LIGHT_VECTORS = 4;
/** Length of the shortest list, so that up to seven lights come and go without another shader. */
const LEAST_VECTORS = FIRST_LIGHT + 7 * LIGHT_VECTORS;
const KINDS = { directional: 0, point: 1, spot: 1, hemisphere: 2 } as const;
/** Cosines that every direction is within. */
const NO_CONE = [-2, -1.5] as const;
const NOWHERE = [0, 0, 0];
const UNUSED = [0, 0];
const NO_CUTOFF = { distance: 0, cosines: [0, 0], unused: UNUSED };

/**
 * Lights splats, approximately: their colours are taken for the colours of a matt surface that `lights`
 * and `ambient` shine on. A splat's linear light is multiplied by its irradiance divided by π, as of a
 * white Lambert surface, so white splats look as white matt meshes do.
 *
 * The normal is the splat's shortest axis, turned to the eye. It counts by the splat's flatness,
 * f = 1 − shortest / middle standard deviation: a light counts by f · max(0, cos θ) + (1 − f) / 4, where
 * 1/4 is the mean over all directions. Discs are lit as surfaces; round splats and needles, which have no
 * normal, are lit evenly. Captures already have their own light and shadows in their colours, and their
 * normals are noisy: a `strength` below 1 hides both. Lights pass through everything: see `shadows`.
 *
 * @throws InvalidArgumentError for more than 31 lights, a light that is incomplete or has numbers out of
 *   range, or a strength outside of 0…1.
 * @example
 * const sun = { kind: 'directional', direction: [-1, -2, -1], irradiance: [3, 3, 3] } as const;
 * const effects = [relight({ lights: [sun], ambient: [1, 1, 1], strength: 0.8 })];
 * view.render({ camera, clouds: [{ cloud, effects }], widthPx, heightPx });
 */
export const relight = /* @__PURE__ */ effectFunction<RelightOptions>({
  name: 'relight',
  label: 'Relighting',
  about: 'Lights splats by normals of their shortest axes, approximately.',
  hooks: { color: 'relightColor' },
  wgsl: /* @__PURE__ */ [wgsl, lambert, falloff].join('\n'),
  check(options) {
    const { lights = [], ambient = [0, 0, 0], strength = 1 } = given(options, {}, 'relight');
    checkKind('lights', lights, 'a list');
    if (lights.length > MOST_LIGHTS) {
      const message = `There are ${lights.length} lights; a cloud is lit by up to ${MOST_LIGHTS}.`;
      throw new InvalidArgumentError('lights', message);
    }
    for (const [index, light] of lights.entries()) checkLight(`lights[${index}]`, light);
    checkVector('ambient', ambient, 'the irradiance from everywhere', { isNonNegative: true });
    checkRange('strength', strength, 1, 'the share of the light in colours');
  },
  calledFor({ lights = [], ambient = [0, 0, 0], strength = 1 }) {
    if (strength === 0) return null;
    const sources = [
      ...(lights.length > 0 ? [lights.length === 1 ? 'a light' : `${lights.length} lights`] : []),
      ...(ambient.some((value) => value > 0) ? ['ambient light'] : []),
    ];
    return sources.length > 0 ? `it is lit by ${sources.join(' and ')}` : 'it is lit by nothing';
  },
  list: {
    length: ({ lights = [] }) => Math.max(LEAST_VECTORS, FIRST_LIGHT + LIGHT_VECTORS * lights.length),
    at({ lights = [], ambient = [0, 0, 0], strength = 1 }, { modelMatrix, origin, viewMatrix, projection }) {
      const toView = linearPart(multiply4(viewMatrix, translated4(modelMatrix, origin)));
      const [rowX, rowY, rowZ] = normalRows(toView);
      const isOrthographic = projection.isOrthographic ? 1 : 0;
      const lightCount = lights.length;
      return [
        ...numbersOf({ rowX, lightCount, rowY, strength, rowZ, isOrthographic, ambient, unused: 0 }),
        ...lights.flatMap((light) => numbersOf(lightIn(light, viewMatrix))),
      ];
    },
  },
});

function checkLight(name: string, light: RelightLight): void {
  const { kind, irradiance } = given(light, {}, name);
  if (!Object.hasOwn(KINDS, kind))
    throw wrongArgument(
      `${name}.kind`,
      kind,
      Object.keys(KINDS)
        .join(', ')
        .replace(/, (\w+)$/, ' or $1'),
    );
  checkVector(`${name}.irradiance`, irradiance, 'the light that a surface gets', { isNonNegative: true });
  if (light.kind === 'hemisphere') {
    checkVector(`${name}.ground`, light.ground, 'the light from below', { isNonNegative: true });
    checkVector(`${name}.up`, light.up, 'where the sky is', { isDirection: true });
  }
  if (light.kind === 'directional' || light.kind === 'spot')
    checkVector(`${name}.direction`, light.direction, 'where the light shines', { isDirection: true });
  if (light.kind === 'point' || light.kind === 'spot')
    checkVector(`${name}.position`, light.position, 'where the lamp is, in world space');
  if (light.kind === 'point') checkFalloff(name, light);
  if (light.kind === 'spot') checkCone(`${name}.cone`, given(light.cone, {}, `${name}.cone`));
}

/** Returns the rows of the matrix that maps normals, of any length, by the map of points. */
function normalRows(m: Mat3): readonly Vec3[] {
  const largest = Math.max(...m.map(Math.abs)) || 1;
  const [a, b, c] = [0, 3, 6].map((first) => m.slice(first, first + 3).map((value) => value / largest));
  const cross = (u: number[], v: number[]) =>
    [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]] as const;
  // Cofactors: also of clouds that their matrix flattens.
  const columns = [cross(b, c), cross(c, a), cross(a, b)];
  return [0, 1, 2].map((row) => columns.map((column) => column[row]) as unknown as Vec3);
}

function lightIn(light: RelightLight, viewMatrix: EffectPlace['viewMatrix']): PackedLight {
  const inView = (direction: Vec3, sign: 1 | -1) => {
    const turned = transform3(linearPart(viewMatrix), direction);
    // Not `Math.hypot` of the direction itself: cameras may be scaled.
    const length = sign * Math.hypot(...turned);
    return turned.map((value) => value / length);
  };
  const placed = (position: Vec3) =>
    transform3(linearPart(viewMatrix), position).map((value, axis) => value + viewMatrix[12 + axis]);
  const { irradiance } = light;
  const kind = KINDS[light.kind];
  if (light.kind === 'hemisphere')
    return { place: inView(light.up, 1), kind, irradiance, decay: 0, axis: light.ground, ...NO_CUTOFF };
  if (light.kind === 'directional')
    return { place: inView(light.direction, -1), kind, irradiance, decay: 0, axis: NOWHERE, ...NO_CUTOFF };
  const { decay = 2, distance = 0 } = light.kind === 'spot' ? light.cone : light;
  const axis = light.kind === 'spot' ? inView(light.direction, 1) : [0, 0, 1];
  const cosines = light.kind === 'spot' ? cosinesOf(light.cone) : NO_CONE;
  return { place: placed(light.position), kind, irradiance, decay, axis, distance, cosines, unused: UNUSED };
}
