import type { Vec3 } from '../camera/vec3.ts';
import { add, dot, scale, subtract } from '../camera/vec3.ts';
import type {
  BrightnessChoice,
  ChosenEffect,
  ClipChoice,
  EffectChoice,
  FogChoice,
  RevealChoice,
} from '../state/effect-choices.ts';
import { planeNormal } from './effect-uses.ts';
import { formatAt, roundedTo, stepFor } from './nice-steps.ts';
import type { ScenePlace } from './scene-place.ts';

/** One number of a choice, and the range that it can be moved in by hand. */
export interface EffectSlider<Choice> {
  /** Name of the option, as in the engine's interface. */
  readonly name: string;
  readonly label: string;
  readonly unit: SliderUnit;
  readonly min: number;
  readonly max: number;
  readonly step: number;
  readonly read: (choice: Choice) => number;
  readonly write: (choice: Choice, value: number) => Choice;
}

/** `units`: of the scene. */
export type SliderUnit = 'units' | 'degrees' | 'stops' | 'per unit';

/** Depths and distances from a camera can be chosen up to this many radii of the scene. */
const FARTHEST_RADII = 6;
const AXES = ['x', 'y', 'z'] as const;

const STOPS: EffectSlider<BrightnessChoice> = {
  name: 'factor',
  label: 'Exposure',
  unit: 'stops',
  ...{ min: -4, max: 4, step: 0.1 },
  read: ({ stops }) => stops,
  write: (choice, stops) => ({ ...choice, stops }),
};

function clipSliders({ shape }: ClipChoice, place: ScenePlace): readonly EffectSlider<ClipChoice>[] {
  const { radius } = place;
  const softEdge = slider<ClipChoice>('softEdge', 'Soft edge', 0, radius / 2);
  if (shape === 'plane') return [planePosition(place), PLANE_TURN, PLANE_TILT, softEdge];
  const middle = AXES.map((_, axis) => middleAlong(axis, place));
  if (shape === 'sphere') return [slider('radius', 'Radius', 0, 2 * radius), ...middle, softEdge];
  return [...AXES.map((_, axis) => edgeAlong(axis, place)), ...middle, softEdge];
}

/** Moves the plane along the direction that it faces; 0 is the scene's middle. */
function planePosition({ center, radius }: ScenePlace): EffectSlider<ClipChoice> {
  const positionOf = (choice: ClipChoice) => dot(subtract(choice.center, center), planeNormal(choice));
  return {
    ...slider<ClipChoice>('point', 'Position', -1.5 * radius, 1.5 * radius),
    read: positionOf,
    write: (choice, value) => ({
      ...choice,
      center: add(choice.center, scale(planeNormal(choice), value - positionOf(choice))),
    }),
  };
}

const PLANE_TURN: EffectSlider<ClipChoice> = {
  name: 'turn',
  label: 'Turn',
  unit: 'degrees',
  ...{ min: -180, max: 180, step: 1 },
  read: ({ turnDegrees }) => turnDegrees,
  write: (choice, turnDegrees) => ({ ...choice, turnDegrees }),
};

const PLANE_TILT: EffectSlider<ClipChoice> = {
  name: 'tilt',
  label: 'Tilt',
  unit: 'degrees',
  ...{ min: -90, max: 90, step: 1 },
  read: ({ tiltDegrees }) => tiltDegrees,
  write: (choice, tiltDegrees) => ({ ...choice, tiltDegrees }),
};

function middleAlong(axis: number, { center, radius }: ScenePlace): EffectSlider<ClipChoice> {
  const [min, max] = [center[axis] - 1.5 * radius, center[axis] + 1.5 * radius];
  return {
    ...slider<ClipChoice>(`center.${AXES[axis]}`, `Middle ${AXES[axis]}`, min, max),
    read: (choice) => choice.center[axis],
    write: (choice, value) => ({ ...choice, center: withComponent(choice.center, axis, value) }),
  };
}

function edgeAlong(axis: number, { radius }: ScenePlace): EffectSlider<ClipChoice> {
  return {
    ...slider<ClipChoice>(`size.${AXES[axis]}`, `Length ${AXES[axis]}`, 0, 3 * radius),
    read: (choice) => choice.size[axis],
    write: (choice, value) => ({ ...choice, size: withComponent(choice.size, axis, value) }),
  };
}

function revealSliders({ from }: RevealChoice, place: ScenePlace): readonly EffectSlider<RevealChoice>[] {
  const max = revealReach(from, place);
  const radius = slider<RevealChoice>('radius', 'Radius', 0, max);
  return [
    // The right end shows everything, however far away.
    { ...radius, write: (choice, value) => ({ ...choice, radius: value < radius.max ? value : Infinity }) },
    slider('softEdge', 'Soft edge', 0, place.radius),
  ];
}

/** A radius from which on most of the scene is there. */
export function revealReach(from: RevealChoice['from'], { radius }: ScenePlace): number {
  return (from === 'camera' ? FARTHEST_RADII : 2) * radius;
}

function fogSliders({ kind }: FogChoice, { radius }: ScenePlace): readonly EffectSlider<FogChoice>[] {
  if (kind === 'density')
    return [{ ...slider<FogChoice>('density', 'Density', 0, 2 / radius), unit: 'per unit' }];
  const depth = slider<FogChoice>('near', 'Begins at depth', 0, FARTHEST_RADII * radius);
  // One gives way to the other: fog without depth is none.
  return [
    {
      ...depth,
      write: (choice, near) => ({ ...choice, near, far: Math.max(choice.far, near + depth.step) }),
    },
    {
      ...slider('far', 'Complete at depth', depth.step, FARTHEST_RADII * radius),
      write: (choice, far) => ({ ...choice, far, near: Math.min(choice.near, far - depth.step) }),
    },
  ];
}

const SLIDERS: {
  readonly [Name in ChosenEffect]: (
    choice: EffectChoice<Name>,
    place: ScenePlace,
  ) => readonly EffectSlider<EffectChoice<Name>>[];
} = {
  clip: clipSliders,
  reveal: revealSliders,
  antialias: () => [],
  brightness: () => [STOPS],
  tint: () => [],
  fog: fogSliders,
};

/** The sliders of an effect with this choice, in a scene at `place`. */
export function slidersOf<Name extends ChosenEffect>(
  name: Name,
  choice: EffectChoice<Name>,
  place: ScenePlace,
): readonly EffectSlider<EffectChoice<Name>>[] {
  return SLIDERS[name](choice, place);
}

type NumberOf<Choice> = { [Key in keyof Choice]: Choice[Key] extends number ? Key : never }[keyof Choice];

/** For a length that is a number of the choice by itself. The ends are multiples of the step: then all its values are short. */
function slider<Choice>(name: string, label: string, min: number, max: number): EffectSlider<Choice> {
  const step = stepFor(max - min);
  const key = name as NumberOf<Choice> & string;
  return {
    name,
    label,
    unit: 'units',
    min: roundedTo(min, step),
    max: roundedTo(max, step),
    step,
    read: (choice) => Number(choice[key]),
    write: (choice, value) => ({ ...choice, [key]: value }),
  };
}

function withComponent(vector: Vec3, axis: number, value: number): Vec3 {
  return [0, 1, 2].map((each) => (each === axis ? value : vector[each])) as unknown as Vec3;
}

/** `1.25`, `+0.5 stops`, `−90°`, `all`: the number at a slider as people read it. */
export function formatSlider(
  { unit, step }: Pick<EffectSlider<unknown>, 'unit' | 'step'>,
  value: number,
): string {
  if (value === Infinity) return 'all';
  const figure = formatAt(value, step);
  if (unit === 'degrees') return `${figure}°`;
  return unit === 'stops' && value > 0 ? `+${figure}` : figure;
}
