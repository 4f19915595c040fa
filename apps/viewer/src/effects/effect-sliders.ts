import type { NumberOption, OptionValues, ScenePlace, VectorOption } from '@websplatter/core/effect-options';
import { formatAt, roundedTo } from '@websplatter/kit/nice-steps';
import { optionsBeside, stepOf } from '../state/effect-values.ts';
import { add, dot, scale, subtract, type Vec3, withAxis } from '../state/vec3.ts';

/** One number of an effect, and the range of its slider. */
export interface EffectSlider {
  /** Name of the option, with the axis if it has three numbers: `center.x`. */
  readonly name: string;
  readonly label: string;
  readonly unit: NumberOption['unit'];
  readonly min: number;
  readonly max: number;
  readonly step: number;
  readonly read: (values: OptionValues) => number;
  readonly write: (values: OptionValues, value: number) => OptionValues;
}

const AXES = ['x', 'y', 'z'] as const;
const NO_DIRECTION: Vec3 = [0, 0, 0];

/** The sliders of an effect with these values, for a scene at `place`. */
export function slidersOf(effect: string, values: OptionValues, place: ScenePlace): readonly EffectSlider[] {
  const options = optionsBeside(effect, values);
  return options.flatMap(([name, option]) => {
    if (option.kind === 'number') return numberSlider(name, option, options, option.range(place, values));
    if (option.kind !== 'vector') return [];
    if (option.along?.(values)) return alongSlider(name, option, place);
    return AXES.map((_, axis) => axisSlider(name, option, axis, option.range(place, axis)));
  });
}

function numberSlider(
  name: string,
  option: NumberOption,
  options: ReturnType<typeof optionsBeside>,
  [min, max]: readonly [number, number],
): EffectSlider {
  const ends = endsOf(option, min, max);
  const { step } = ends;
  const { label, unit, isEndless, below } = option;
  const [above] = options.find(([, other]) => other.kind === 'number' && other.below === name) ?? [];
  return {
    ...{ name, label, unit, ...ends },
    min: above === undefined ? ends.min : ends.min + step,
    read: (values) => Number(values[name]),
    write: (values, value) => ({
      ...values,
      [name]: isEndless && value >= ends.max ? Infinity : value,
      ...(below && { [below]: Math.max(Number(values[below]), value + step) }),
      ...(above && { [above]: Math.min(Number(values[above]), value - step) }),
    }),
  };
}

/** A slider for one of an option's three numbers. */
function axisSlider(
  name: string,
  { label }: VectorOption,
  axis: number,
  [min, max]: readonly [number, number],
): EffectSlider {
  return {
    name: `${name}.${AXES[axis]}`,
    label: `${label} ${AXES[axis]}`,
    unit: 'units',
    ...endsOf({ unit: 'units' }, min, max),
    read: (values) => (values[name] as Vec3)[axis],
    write: (values, value) => ({ ...values, [name]: withAxis(values[name] as Vec3, axis, value) }),
  };
}

/** A slider for a point that moves along one direction; 0 is beside the scene's centre. */
function alongSlider(name: string, option: VectorOption, place: ScenePlace): EffectSlider {
  const [min, max] = option.range(place, 0);
  // After a change of direction, the old slider may get new values before it is replaced.
  const directionOf = (values: OptionValues) => option.along?.(values) ?? NO_DIRECTION;
  const read = (values: OptionValues) =>
    dot(subtract(values[name] as Vec3, place.center), directionOf(values));
  return {
    name,
    label: 'Position',
    unit: 'units',
    ...endsOf({ unit: 'units' }, min - place.center[0], max - place.center[0]),
    read,
    write: (values, value) => ({
      ...values,
      [name]: add(values[name] as Vec3, scale(directionOf(values), value - read(values))),
    }),
  };
}

/** Rounds the ends to multiples of the step, so that all values between them are short. */
function endsOf(option: Pick<NumberOption, 'unit'>, min: number, max: number) {
  const step = stepOf(option, max - min);
  return { min: roundedTo(min, step), max: roundedTo(max, step), step };
}

/** A slider's number as text: `1.25`, `+0.5`, `−90°`, `120 %`, `all`. */
export function formatSlider({ unit, step }: Pick<EffectSlider, 'unit' | 'step'>, value: number): string {
  if (value === Infinity) return 'all';
  const figure = formatAt(value, step);
  if (unit === 'degrees') return `${figure}°`;
  if (unit === 'percent') return `${figure} %`;
  return unit === 'stops' && value > 0 ? `+${figure}` : figure;
}
