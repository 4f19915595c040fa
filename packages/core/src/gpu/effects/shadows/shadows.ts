import { type Camera, checkMatrix } from '../../../data/camera/camera.ts';
import { type DepthConvention, depthMapping } from '../../../data/camera/depth-convention.ts';
import { InvalidArgumentError } from '../../../data/errors.ts';
import { checkKind, given, wrongArgument } from '../../../data/given.ts';
import { multiply4, translated4, type Vec3 } from '../../../data/math/mat4.ts';
import { type EffectPlace, effectFunction, numbersOf } from '../effect.ts';
import { effectResources } from '../effect-resources.ts';
import { checkLength, checkRange, checkVector, isFiniteF32 } from '../option-checks.ts';
import falloff from './falloff.wgsl?raw';
import { checkCone, cosinesOf, type LightCone } from './light-cone.ts';
import wgsl from './shadows.wgsl?raw';

/** A directional light or a spot light that casts shadows. */
export interface ShadowLight {
  /** Depths of what casts shadows, as `camera` sees it: a depth texture with one sample and layer. */
  readonly map: GPUTexture;
  /**
   * A number that changes whenever the map is drawn again: while it is the same, frames may stay as
   * they are. Default: the map may change before each frame.
   */
  readonly version?: number;
  /**
   * The light's view: orthographic for a directional light, in perspective for a spot light. Its
   * projection has depths of 0…1.
   */
  readonly camera: Camera;
  /** How `map` stores depth. Default: projected depth, 0 at the near plane. */
  readonly depth?: DepthConvention;
  /**
   * Linear red, green and blue that the light gives a surface that faces it; of a spot light, at a
   * distance of 1. Only its ratio to other lights counts.
   */
  readonly irradiance: Vec3;
  /** The cone of a spot light. Default: a directional light. */
  readonly cone?: LightCone;
  /** Share of the light that shadows take, 0…1. Default: 1. */
  readonly strength?: number;
  /** Added to the stored depth that is tested; below 0: splats are moved towards the light. Default: 0. */
  readonly bias?: number;
  /** Distance that splats are moved towards the light before the test, world units. Default: 0. */
  readonly offset?: number;
}

/** Options of `shadows`. */
export interface ShadowsOptions {
  /** At most four lights. */
  readonly lights: readonly ShadowLight[];
  /** Irradiance of all light that casts no shadows, linear red, green and blue. Default: none. */
  readonly steady?: Vec3;
}

const MOST_LIGHTS = 4;
/** vec4f of a light in shadows.wgsl. */
const LIGHT_VECTORS = 7;
const FORMS = { linear: 1, reciprocal: 2, logarithmic: 3 } as const;
/** In place of the cosine of a cone. */
const NO_CONE = -2;
const PROJECTED: DepthConvention = { compare: 'less-equal', mapping: 'projection' };

/**
 * Darkens splats in the shadows of lights, by shadow maps that the caller draws. A splat keeps the
 * share of its linear light that a white surface facing the lights would keep: the light that still
 * reaches the splat over all light. Without shadows, colours stay as they are.
 *
 * Each map is sampled at the splat's centre, as the mean of three by three texels about it. Depths
 * are compared with the centre's depth less three standard deviations of the splat along the light,
 * so that the splats of one surface do not shade each other.
 *
 * @example
 * const sun = { map: depthTexture, camera: cameraOfSun, irradiance: [3, 3, 3] } as const;
 * const clouds = [{ cloud, effects: [shadows({ lights: [sun], steady: [1, 1, 1] })] }];
 */
export const shadows = /* @__PURE__ */ effectFunction<ShadowsOptions>({
  name: 'shadows',
  label: 'Shadows',
  about: 'Darkens splats in the shadows of lights.',
  hooks: { color: 'shadowsColor' },
  wgsl: /* @__PURE__ */ [wgsl, falloff].join('\n'),
  check(options) {
    const { lights, steady = [0, 0, 0] } = given(options, {}, 'shadows');
    checkKind('lights', lights, 'a list');
    if (lights.length > MOST_LIGHTS) {
      const message = `There are ${lights.length} lights; a cloud takes the shadows of up to ${MOST_LIGHTS}.`;
      throw new InvalidArgumentError('lights', message);
    }
    for (const [index, light] of lights.entries()) checkLight(`lights[${index}]`, light);
    const meaning = 'the irradiance of light without shadows';
    checkVector('steady', steady, meaning, { isNonNegative: true });
  },
  calledFor({ lights }) {
    if (lights.length === 0) return null;
    return lights.length === 1 ? 'a light casts shadows on it' : `${lights.length} lights cast shadows on it`;
  },
  list: {
    // One length, so that lights come and go without another shader.
    length: () => 1 + LIGHT_VECTORS * MOST_LIGHTS,
    at: ({ lights, steady = [0, 0, 0] }, place) => [
      ...steady,
      lights.length,
      ...lights.flatMap((light) => lightNumbers(light, place)),
    ],
  },
  resources: /* @__PURE__ */ effectResources(
    { map0: 'depth', map1: 'depth', map2: 'depth', map3: 'depth' },
    // Shaders declare all maps: the first one takes the place of those that there are not.
    ({ lights }: ShadowsOptions) => {
      const [map0, map1, map2, map3] = Array.from({ length: MOST_LIGHTS }, (_, i) => {
        const { map, version } = lights[i] ?? lights[0];
        return { source: map, version };
      });
      return { map0, map1, map2, map3 };
    },
  ),
});

function checkLight(name: string, light: ShadowLight): void {
  const {
    map,
    camera,
    irradiance,
    cone,
    strength = 1,
    bias = 0,
    offset = 0,
  } = given(light, { version: 'a number?' }, name);
  given(map, { createView: 'a function' }, `${name}.map`);
  checkMatrix(`${name}.camera.viewMatrix`, given(camera, {}, `${name}.camera`).viewMatrix);
  checkMatrix(`${name}.camera.projectionMatrix`, camera.projectionMatrix);
  checkVector(`${name}.irradiance`, irradiance, 'the light that a surface gets', { isNonNegative: true });
  checkRange(`${name}.strength`, strength, 1, 'the share of the light that shadows take');
  checkLength(`${name}.offset`, offset, 'how far splats are moved towards the light');
  if (!isFiniteF32(bias)) throw wrongArgument(`${name}.bias`, bias, 'a finite number');
  if (cone) checkCone(`${name}.cone`, given(cone, {}, `${name}.cone`));
}

/** The numbers of one light, in the order of shadows.wgsl. */
function lightNumbers(light: ShadowLight, { modelMatrix, origin }: EffectPlace): number[] {
  const { camera, depth = PROJECTED, irradiance, cone, strength = 1, bias = 0, offset = 0 } = light;
  const p = camera.projectionMatrix;
  const isOrthographic = p[11] === 0;
  const toView = multiply4(camera.viewMatrix, translated4(modelMatrix, origin));
  const toClip = multiply4(p, toView);
  const row = (m: ArrayLike<number>, r: number, factor: number) =>
    [0, 1, 2, 3].map((column) => factor * m[4 * column + r]);
  const scale = isOrthographic ? 1 / p[15] : -1 / p[11];
  const mapping = depthMapping(camera, depth.mapping);
  const form = formOf(isOrthographic, depth.mapping);
  const { decay = 2, distance = 0 } = cone ?? {};
  return numbersOf({
    rowX: row(toClip, 0, scale),
    rowY: row(toClip, 1, scale),
    rowDepth: row(toView, 2, -1),
    irradiance,
    strength,
    mappingOffset: mapping.offset,
    mappingFactor: mapping.factor,
    form: depth.compare === 'less-equal' ? form : -form,
    bias,
    offset,
    decay,
    distance,
    unused: 0,
    halfExtent: [1 / p[0], 1 / p[5]],
    cosines: cone ? cosinesOf(cone) : [NO_CONE, 0],
  });
}

function formOf(isOrthographic: boolean, mapping: DepthConvention['mapping']): number {
  if (isOrthographic) return FORMS.linear;
  return mapping === 'projection' ? FORMS.reciprocal : FORMS.logarithmic;
}
