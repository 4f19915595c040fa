import { linearPart, scalesEvenly } from '../../data/math/mat4.ts';
import type { SplatEffect } from '../../gpu/effects/effect.ts';
import type { CloudPlan } from '../plan/cloud-plan.ts';
import { type Detail, isFixedDetail, percentText } from '../plan/detail.ts';
import type { FramePlan } from '../plan/frame-plan.ts';
import type { CloudShape } from '../plan/frame-shape.ts';

/** GPU memory that a view holds for effects, in bytes. */
interface EffectHoldings {
  /** Selections, levels and rows. */
  readonly effects: { bytesOf(effect: SplatEffect, cloudIndex: number): number };
  /** The host's depth that splats are tested against. */
  readonly testedDepthBytes: number;
  /** The splats' own depth, for the host. */
  readonly writtenDepthBytes: number;
  /** Lists of the tiles. */
  readonly tilesBytes: number;
}

/** A frame that was drawn. */
export interface DrawnFrame {
  readonly plan: FramePlan;
  readonly held: EffectHoldings;
  /** Why it was drawn by tiles or quads, for people. */
  readonly rasterizer: { readonly reason: string };
}

/** One cloud of a frame. */
interface DrawnCloud {
  readonly plan: FramePlan;
  /** Index of the cloud in the frame. */
  readonly index: number;
  readonly cloud: CloudPlan;
  readonly shape: CloudShape;
}

/** Why a feature is on or off in one cloud of a frame, or in a whole frame: its `Place`. */
export interface Reasons<Place> {
  /** A function is called only if the feature is on. */
  readonly onReason: string | ((place: Place) => string);
  /** A function is called only if the feature is off. */
  readonly offReason: string | ((place: Place) => string);
}

interface FeatureOf<Place> extends Reasons<Place> {
  /** Lower case with hyphens. */
  readonly name: string;
  readonly label: string;
  /** The work of the feature, in one sentence. */
  readonly about: string;
  /** Stages that it may take part in; none if it is not in any shader. */
  readonly stages: readonly string[];
  readonly isOn: (place: Place) => boolean;
  /** Bytes of GPU memory held for it; default none. */
  readonly bytes?: (frame: DrawnFrame) => number;
}

/** An automatic feature that is on or off per cloud. */
interface FeatureOfCloud extends FeatureOf<DrawnCloud> {
  readonly of: 'cloud';
}

/** An automatic feature that is on or off for the whole view. */
interface FeatureOfView extends FeatureOf<DrawnFrame> {
  readonly of: 'view';
}

/**
 * An effect that splats, camera or host make necessary. The frame's shape decides whether it is on,
 * and thereby which shaders run; this entry gives the reason.
 */
export type AutomaticFeature = FeatureOfCloud | FeatureOfView;

/** All automatic features: the data of clouds, the view or its host make each of them necessary. */
export const AUTOMATIC_FEATURES: readonly AutomaticFeature[] = [
  {
    of: 'cloud',
    name: 'harmonics',
    label: 'View-dependent colour',
    about: 'Evaluates spherical harmonics up to the highest visible degree.',
    stages: ['project'],
    isOn: ({ shape }) => shape.shDegree > 0,
    onReason: (cloud) =>
      `colours depend on the viewing direction: ${degreeLimit(cloud)}${isPalette(cloud) ? ', as a palette' : ''}`,
    offReason: degreeLimit,
    // Includes stored bands that are not evaluated.
    bytes: ({ plan }) => {
      const pages = new Set(plan.shape.clouds.flatMap(({ planes }) => planes.pages));
      return [...pages].reduce((sum, { shRest }) => sum + (shRest?.size ?? 0), 0);
    },
  },
  {
    of: 'cloud',
    name: 'motion',
    label: 'Motion',
    about: 'Moves, turns and fades the splats of a scene that changes with the time.',
    stages: ['cull-chunks', 'cull-splats', 'project'],
    isOn: (cloud) => motionOf(cloud) !== null,
    onReason: (cloud) => motionOf(cloud)!,
    offReason: 'the splats stand still',
    bytes: ({ plan }) => {
      const pages = new Set(plan.shape.clouds.flatMap(({ planes }) => planes.pages));
      return [...pages].reduce(
        (sum, { motion }) => sum + (motion ? motion.splats.size + motion.reaches.size : 0),
        0,
      );
    },
  },
  {
    of: 'cloud',
    name: 'isotropic',
    label: 'Round splats',
    about: 'Ignores rotations if all splats are spheres.',
    stages: ['cull-splats', 'project'],
    isOn: ({ shape }) => shape.isIsotropic,
    onReason: 'all splats are spheres',
    offReason: ({ shape }) =>
      shape.cloud.facts.isIsotropic
        ? 'splats are round, but an effect may change their shapes'
        : 'some splats are not round',
  },
  {
    of: 'cloud',
    name: 'levels',
    label: 'Levels of detail',
    about: 'Draws merged splats in place of several that are too small to tell apart.',
    stages: [
      'cut-cells',
      'cut-count',
      'plan-cut',
      'touch-links',
      'cull-chunks',
      'cut-splats',
      'cull-splats',
      'project',
      'tile-count',
      'tile-emit',
      'tile-masks',
      'tile-rasterize',
      'tile-rest',
      'rasterize',
    ],
    isOn: ({ plan, shape }) => shape.levels !== null && (plan.detail !== 'full' || shape.cloud.pool !== null),
    onReason: ({ plan: { detail, request } }) => {
      if (detail === 'full') return 'merged splats stand for missing parts of the scene';
      const { maxErrorPx, maxSplats, maxShare } = detail;
      const limits = [
        ...(maxErrorPx === undefined ? [] : [`errors up to ${maxErrorPx} px are allowed`]),
        ...(maxSplats === undefined
          ? []
          : [`at most ${maxSplats.toLocaleString('en')} splats are asked for`]),
        ...(maxShare === undefined ? [] : [`at most ${percentText(maxShare)} of the splats are asked for`]),
      ];
      return [...limits, ...aimsOf(request.detail)].join(', ');
    },
    offReason: levelsOff,
  },
  {
    // A cloud's transform costs shaders nothing: it is part of one matrix, computed in float64.
    of: 'cloud',
    name: 'transform',
    label: 'Placement',
    about: 'Places a cloud in the world, on the CPU: shaders always take one matrix.',
    stages: [],
    isOn: (cloud) => placementOf(cloud) !== null,
    onReason: (cloud) => placementOf(cloud)!,
    offReason: 'it stands where its file puts it',
  },
  {
    of: 'cloud',
    name: 'instances',
    label: 'Instances',
    about: 'Draws a cloud in many places at once.',
    stages: ['cut-count', 'cull-chunks', 'cut-splats', 'cull-splats', 'project', 'wide-keys'],
    isOn: ({ shape }) => shape.instanceCount !== null,
    onReason: ({ shape }) => `it is drawn in ${shape.instanceCount!.toLocaleString('en')} places`,
    offReason: 'every cloud is shown once',
  },
  {
    of: 'view',
    name: 'orthographic',
    label: 'Orthographic view',
    about: 'Projects splats without perspective: all share one Jacobian.',
    stages: ['cull-splats', 'project', 'rasterize', 'tile-rasterize', 'tile-rest', 'compose'],
    isOn: ({ plan }) => plan.shape.isOrthographic,
    onReason: 'the camera has no perspective',
    offReason: 'the camera has perspective',
  },
  {
    // A frame has one order; the feature is on for clouds that ask for distances.
    of: 'cloud',
    name: 'distance-order',
    label: 'Order of distances',
    about: 'Sorts splats by their distances from the camera, not by their depths.',
    stages: ['cull-splats', 'project', 'wide-keys'],
    isOn: ({ plan, shape: { cloud } }) =>
      plan.shape.sortsByDistance &&
      (plan.request.sortBy === 'distance' || cloud.facts.fileFacts?.isSortedByDistance === true),
    onReason: ({ plan }) => `${plan.request.sortBy === 'distance' ? 'the request' : 'its file'} asks for it`,
    offReason: ({ plan }) => {
      if (plan.shape.isOrthographic) return 'the camera has no perspective';
      return plan.request.sortBy === 'depth' ? 'the request asks for depths' : 'no file asks for it';
    },
  },
  {
    of: 'view',
    name: 'depth-test',
    label: 'Hidden by meshes',
    about: 'Tests splats against the depth of meshes drawn before.',
    stages: ['resolve-depth', 'rasterize', 'tile-rasterize', 'tile-rest', 'compose'],
    isOn: ({ plan }) => plan.shape.depth?.isTested === true,
    onReason: ({ plan }) =>
      `something may hide splats; its depth is ${plan.shape.depth!.mapping === 'logarithmic' ? 'logarithmic' : 'projected'}`,
    offReason: 'nothing was drawn that could hide splats',
    bytes: ({ held }) => held.testedDepthBytes,
  },
  {
    of: 'view',
    name: 'depth-write',
    label: 'Depth of splats',
    about: 'Writes the depth of splats, for what the host draws later.',
    stages: ['rasterize', 'tile-rasterize', 'upscale', 'compose'],
    isOn: ({ plan }) => plan.shape.depth?.layerFormat != null,
    onReason: ({ plan }) => `the host needs it, in ${plan.shape.depth!.layerFormat}`,
    offReason: 'no host needs it',
    bytes: ({ held }) => held.writtenDepthBytes,
  },
  {
    of: 'view',
    name: 'fade',
    label: 'Fade',
    about: 'Blends the finished splats over the host’s image in part.',
    stages: ['compose'],
    isOn: ({ plan }) => plan.shape.isFaded,
    onReason: ({ plan }) => `the host asks for ${percentText(plan.request.fade!)} of the splats’ picture`,
    offReason: 'no host asks for it',
  },
  {
    of: 'view',
    name: 'lower-resolution',
    label: 'Lower resolution',
    about: 'Blends splats in fewer pixels than the image has, and enlarges them smoothly.',
    stages: ['resolve-depth', 'upscale'],
    isOn: ({ plan }) => plan.movingScale < 1 || plan.shape.accuracy.resolutionScale < 1,
    onReason: ({ plan: { movingScale, request, shape } }) =>
      movingScale < 1
        ? ['something moves, and all pixels would take too long', ...aimsOf(request.detail)].join(', ')
        : `the accuracy asks for ${percentText(shape.accuracy.resolutionScale)} of the width and height`,
    offReason: 'the accuracy asks for all pixels',
  },
  {
    of: 'view',
    name: 'tiles',
    label: 'Tiles',
    about: 'Blends splats by tiles in compute shaders instead of as quads, front to back in float32.',
    stages: [
      'tile-count',
      'tile-plan',
      'tile-emit',
      'tile-ranges',
      'tile-masks',
      'tile-rasterize',
      'tile-rest',
    ],
    isOn: ({ plan }) => plan.shape.rasterizer === 'tiles',
    onReason: ({ rasterizer }) => rasterizer.reason,
    offReason: ({ rasterizer }) => rasterizer.reason,
    bytes: ({ held }) => held.tilesBytes,
  },
];

/** Why a cloud moves; null if it does not. */
function motionOf({ cloud: { instance, uses } }: DrawnCloud): string | null {
  return instance.cloud.timeRange ? (uses[0]?.use.reason ?? null) : null;
}

function isPalette({ shape }: DrawnCloud): boolean {
  return shape.planes.shPrecision === 'palette';
}

/** Says which limit decides the degree of harmonics. */
function degreeLimit({ cloud: { instance }, shape }: DrawnCloud): string {
  const { declaredShDegree, trueShDegree } = instance.cloud.facts;
  const degree = shape.shDegree;
  if (degree < trueShDegree)
    return `it ${instance.shDegree === degree ? 'is asked for' : 'was loaded'} with degree ${degree} of the file’s ${declaredShDegree}`;
  return trueShDegree < declaredShDegree
    ? `the file has degree ${declaredShDegree}, but nothing above ${trueShDegree} could be seen`
    : `the file has degree ${declaredShDegree}`;
}

/** Why levels of detail are off. */
function levelsOff({ plan, cloud }: DrawnCloud): string {
  const { detail: asked = 'full' } = plan.request;
  if (asked === 'full' || plan.detail !== 'full') return cloud.inFull ?? 'levels of detail are being made';
  if (asked === 'auto') return 'all splats are drawn at rest, and in motion as long as it is smooth';
  if (!isFixedDetail(asked)) {
    return 'minPsnrDb' in asked
      ? `all splats are drawn, for ${asked.minPsnrDb} dB`
      : `all splats are drawn at rest, and in motion while frames take at most ${asked.maxFrameMs} ms`;
  }
  return asked.maxSplats === undefined && asked.maxShare === undefined
    ? 'no error is allowed'
    : 'all splats are within the budget';
}

/** The outcome that detail is found for; none if the detail is given. */
function aimsOf(asked: Detail = 'full'): string[] {
  if (isFixedDetail(asked)) return [];
  if (asked === 'auto') return ['for smooth motion'];
  return ['minPsnrDb' in asked ? `for ${asked.minPsnrDb} dB` : `for frames within ${asked.maxFrameMs} ms`];
}

/** Lengths and angles that differ by less count as the same. */
const TOLERANCE = 1e-6;

/** Says how a cloud is placed; null for the identity. */
function placementOf({ cloud: { instance } }: DrawnCloud): string | null {
  const { instances, modelMatrix: matrix } = instance;
  if (instances) return 'its instances have a place each';
  if (!matrix) return null;
  const m = linearPart(matrix);
  if (!scalesEvenly(m, TOLERANCE)) return 'it is stretched or sheared';
  const square = m[0] * m[0] + m[1] * m[1] + m[2] * m[2];
  if (Math.abs(square - 1) > TOLERANCE) return 'it is scaled alike in all directions';
  if (m.some((value, i) => value !== (i % 4 === 0 ? 1 : 0))) return 'it is turned, at its own size';
  return [matrix[12], matrix[13], matrix[14]].some((value) => value !== 0) ? 'it is moved' : null;
}
