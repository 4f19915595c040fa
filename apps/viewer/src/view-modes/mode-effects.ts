import { defineEffect } from '@websplatter/core/effects';
import type { Sphere } from '../camera/scene-bounds.ts';
import type { Vec3 } from '../state/vec3.ts';
import centresWgsl from './centres.wgsl?raw';
import depthWgsl from './depth-colors.wgsl?raw';
import { viewDepthsOf } from './depth-range.ts';
import ellipsoidsWgsl from './ellipsoids.wgsl?raw';
import harmonicsWgsl from './harmonics-colors.wgsl?raw';
import levelsWgsl from './level-colors.wgsl?raw';
import opacityWgsl from './opacity-colors.wgsl?raw';
import overdrawWgsl from './overdraw.wgsl?raw';
import { DEPTH_RAMP, OVERDRAW_COLOR, type Ramp, shaderColor, UNSEEN_COLOR, VALUE_RAMP } from './ramp.ts';

/**
 * Radius at which dots of the mode `centres` are half opaque. Larger dots would be culled too
 * early.
 */
export const CENTRE_RADIUS_PX = 1.5;
/** Half-opaque edge of solid ellipses in the mode `ellipsoids`, in standard deviations. */
export const ELLIPSOID_EDGE = 1.5;
/**
 * Factor of standard deviations in the mode `ellipsoids`. Smaller factors harden edges and widen
 * thin splats.
 */
export const ELLIPSOID_SHRINKING = 0.4;
/** Fraction of its colour that the darkest ellipse keeps. */
export const ELLIPSOID_DARKEST = 0.6;
/** Opacity of every splat in the mode `overdraw`. */
export const OVERDRAW_OPACITY = 1 / 32;
/** Colour change at the end of the scale of the mode `harmonics`, in steps of an 8-bit channel. */
export const MOST_STEPS = 64;

/** Level at the end of the scale of the mode `detail`. */
export const COARSEST_LEVEL = 5;

export const centres = defineEffect<undefined, { radiusPx: 'f32' }>({
  name: 'centres',
  label: 'View mode: centres',
  about: 'Shows every splat as a dot.',
  hooks: { splat: 'shrinkToCentre', opacity: 'dotOpacity' },
  wgsl: centresWgsl,
  fields: { radiusPx: 'f32' },
  calledFor: () => 'the view mode shows centres',
  valuesAt: () => ({ radiusPx: CENTRE_RADIUS_PX }),
});

export const ellipsoids = defineEffect<undefined, { shrinking: 'f32'; peakOpacity: 'f32'; darkest: 'f32' }>({
  name: 'ellipsoids',
  label: 'View mode: ellipsoids',
  about: 'Shows every splat as a solid ellipse.',
  hooks: { splat: 'shrinkEllipsoid', opacity: 'solidOpacity', color: 'shadeEllipsoid' },
  wgsl: ellipsoidsWgsl,
  fields: { shrinking: 'f32', peakOpacity: 'f32', darkest: 'f32' },
  calledFor: () => 'the view mode shows ellipsoids',
  valuesAt: () => ({
    shrinking: ELLIPSOID_SHRINKING,
    // At the edge, the shrunk Gaussian has fallen so far that the opacity is 0.5.
    peakOpacity: 0.5 * Math.exp(0.5 * (ELLIPSOID_EDGE / ELLIPSOID_SHRINKING) ** 2),
    darkest: ELLIPSOID_DARKEST,
  }),
});

export interface DepthOptions {
  readonly bounds: Sphere;
  /** Called for each frame: the distance changes as the camera zooms. */
  readonly focusDistance: () => number;
}

export const depthColors = defineEffect<
  DepthOptions,
  { nearColor: 'vec3f'; near: 'f32'; farColor: 'vec3f'; farNearness: 'f32' }
>({
  name: 'depth-colors',
  label: 'View mode: depth',
  about: 'Colours splats by their depth.',
  hooks: { color: 'depthColor' },
  wgsl: depthWgsl,
  fields: { nearColor: 'vec3f', near: 'f32', farColor: 'vec3f', farNearness: 'f32' },
  calledFor: () => 'the view mode shows depths',
  valuesAt({ bounds, focusDistance }, { viewMatrix }) {
    const { near, far } = viewDepthsOf({ bounds, focusDistance: focusDistance() }, viewMatrix);
    const { low, high } = shaderRamp(DEPTH_RAMP);
    return { nearColor: low, near, farColor: high, farNearness: near / far };
  },
});

export const opacityColors = defineEffect<undefined, { low: 'vec3f'; high: 'vec3f' }>({
  name: 'opacity-colors',
  label: 'View mode: opacity',
  about: 'Colours splats by their opacity.',
  hooks: { color: 'opacityColor' },
  wgsl: opacityWgsl,
  fields: { low: 'vec3f', high: 'vec3f' },
  calledFor: () => 'the view mode shows opacities',
  valuesAt: () => shaderRamp(VALUE_RAMP),
});

export const harmonicsColors = defineEffect<undefined, { low: 'vec3f'; most: 'f32'; high: 'vec3f' }>({
  name: 'harmonics-colors',
  label: 'View mode: harmonics',
  about: 'Colours splats by how far their colour depends on the view.',
  hooks: { color: 'harmonicsColor' },
  wgsl: harmonicsWgsl,
  fields: { low: 'vec3f', most: 'f32', high: 'vec3f' },
  calledFor: () => 'the view mode shows what harmonics change',
  valuesAt: () => ({ ...shaderRamp(VALUE_RAMP), most: MOST_STEPS / 255 }),
});

export const overdraw = defineEffect<undefined, { color: 'vec3f'; opacity: 'f32' }>({
  name: 'overdraw',
  label: 'View mode: overdraw',
  about: 'Draws all splats in one colour, with the same small opacity.',
  hooks: { opacity: 'countedOpacity', color: 'countedColor' },
  wgsl: overdrawWgsl,
  fields: { color: 'vec3f', opacity: 'f32' },
  calledFor: () => 'the view mode shows overdraw',
  valuesAt: () => ({ color: shaderColor(OVERDRAW_COLOR), opacity: OVERDRAW_OPACITY }),
});

export const levelColors = defineEffect<
  undefined,
  { low: 'vec3f'; coarsest: 'f32'; high: 'vec3f'; missing: 'vec3f' }
>({
  name: 'level-colors',
  label: 'View mode: detail',
  about: 'Colours splats by their level of detail.',
  hooks: { color: 'levelColor' },
  takesLevel: true,
  wgsl: levelsWgsl,
  fields: { low: 'vec3f', coarsest: 'f32', high: 'vec3f', missing: 'vec3f' },
  calledFor: () => 'the view mode shows levels of detail',
  valuesAt: () => ({
    ...shaderRamp(VALUE_RAMP),
    coarsest: COARSEST_LEVEL,
    missing: shaderColor(UNSEEN_COLOR),
  }),
});

function shaderRamp({ low, high }: Ramp): { low: Vec3; high: Vec3 } {
  return { low: shaderColor(low), high: shaderColor(high) };
}
