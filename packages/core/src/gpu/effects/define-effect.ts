import type { SplatReach } from '../../data/camera/frustum.ts';
import { InvalidArgumentError } from '../../data/errors.ts';
import { checkKind, given, wrongArgument } from '../../data/given.ts';
import { componentsOf, type GpuFields, type GpuValues } from '../../data/layout/gpu-struct.ts';
import { type EffectDefinition, type EffectFunction, effectFunction, NO_REACH } from './effect.ts';

const HOOKS = ['splat', 'opacity', 'color', 'screen', 'bounds'];
const NAME = /^[a-zA-Z]\w*$/;

const FUNCTIONS = ['calledFor', 'check', 'hooksFor', 'selection', 'valuesAt', 'reach'];

/**
 * Defines a new effect: returns a function that makes uses of it for `CloudInstance.effects`.
 * Shaders contain an effect's code only if a cloud of the frame uses the effect and `calledFor`
 * returns a reason.
 *
 * Names that the WGSL declares are its own: other effects, and the engine, may have the same. An error in it
 * is a `ShaderError` of the first frame; the cloud is then drawn without the effect.
 *
 * @throws InvalidArgumentError for a name that is not lower case with hyphens, an effect without
 *   hooks, fields of unknown types, rows other than `splatRows`, or WGSL with a condition (`@if(NAME)`):
 *   conditions are the engine's. Frames throw it for values that do not fit the fields.
 * @example
 * const invert = defineEffect({
 *   name: 'invert', label: 'Invert', about: 'Inverts all colours.',
 *   hooks: { color: 'invertColor' },
 *   wgsl: `import package::lib::packing::Splat;
 * fn invertColor(color: vec3f, splat: Splat, index: u32, centerView: vec3f) -> vec3f { return 1.0 - saturate(color); }`,
 *   calledFor: () => 'colours are inverted',
 * });
 * view.render({ camera, clouds: [{ cloud, effects: [invert()] }], widthPx, heightPx });
 */
export function defineEffect<Options, const Fields extends GpuFields = Record<never, never>>(
  definition: EffectDefinition<Options, Fields>,
): EffectFunction<Options> {
  checkDefinition(definition as EffectDefinition<never, GpuFields>);
  const { name, fields, list, valuesAt, reach } = definition;
  try {
    return effectFunction({
      ...definition,
      list: list && {
        ...list,
        length: (options) => checkedLength(list.length(options)),
        at: (options, place) => checkedList(name, list.at(options, place), list.length(options)),
      },
      valuesAt: fields && ((options, place) => checkedValues(name, fields, valuesAt?.(options, place))),
      reach: reach && ((options) => checkedReach(name, reach(options) ?? NO_REACH)),
    });
  } catch (error) {
    throw new InvalidArgumentError('fields', `The effect ${name}: ${(error as Error).message}`);
  }
}

/**
 * Checks what becomes code of shaders. WGSL refuses the rest: words that it reserves, and wrong functions.
 *
 * @throws InvalidArgumentError
 */
function checkDefinition(definition: EffectDefinition<never, GpuFields>): void {
  const { name, hooks, wgsl, fields = {}, rows, resources } = given(definition, {}, 'definition');
  if (typeof name !== 'string' || !/^[a-z][a-z0-9]*(-[a-z0-9]+)*$/.test(name)) {
    const message = `An effect is named "${name}"; names are lower case with hyphens, like "wind-sway".`;
    throw new InvalidArgumentError('name', message);
  }
  const owner = `The effect ${name}`;
  const check = (argument: string, isRight: boolean, value: unknown, expected: string) => {
    if (!isRight) throw wrongArgument(argument, value, expected, owner);
  };
  given(hooks, {}, 'hooks');
  if (Object.keys(hooks).length === 0)
    throw new InvalidArgumentError('hooks', `${owner} has no hooks: it would change nothing.`);
  for (const [hook, called] of Object.entries(hooks)) {
    check('hooks', HOOKS.includes(hook), hook, `one of ${HOOKS.slice(0, 3).join(', ')}`);
    check(
      `hooks.${hook}`,
      typeof called === 'string' && NAME.test(called),
      called,
      'the name of a function in its WGSL',
    );
  }
  check('wgsl', typeof wgsl === 'string', wgsl, 'the text of its functions');
  const [condition] = wgsl.replace(/\/\/.*/g, '').match(/@(?:if|unroll)\b.*/) ?? [];
  if (condition)
    throw new InvalidArgumentError('wgsl', `${owner} has "${condition}": use a field and \`if\`.`);
  for (const argument of FUNCTIONS) {
    const value = (definition as unknown as Record<string, unknown>)[argument];
    checkKind(argument, value, argument === 'calledFor' ? 'a function' : 'a function?');
  }
  for (const field of Object.keys(given(fields, {}, 'fields')))
    check('fields', NAME.test(field), field, 'names of letters and digits, such as phase');
  if (rows) given(rows, { wgsl: 'a function' }, 'rows');
  if (resources) given(resources, { on: 'a function' }, 'resources');
}

function checkedLength(length: number): number {
  checkKind('list.length', length, 'a whole number');
  return length;
}

/** @throws InvalidArgumentError unless `values` has a number or a list, of the right length, for each field. */
function checkedValues<Fields extends GpuFields>(
  effect: string,
  fields: Fields,
  values: GpuValues<Fields> | undefined,
): GpuValues<Fields> {
  const owner = `The effect ${effect}`;
  if (typeof values !== 'object' || values === null)
    throw wrongArgument('valuesAt', values, `an object with ${Object.keys(fields).join(', ')}`, owner);
  for (const field in fields) {
    const value = values[field];
    const count = componentsOf(fields[field]);
    const isRight =
      typeof value === 'number' ? count === 1 : typeof value === 'object' && value?.length === count;
    const expected = count === 1 ? 'a number' : `a list of ${count} numbers`;
    if (!isRight) throw wrongArgument(`valuesAt.${field}`, value, expected, owner);
  }
  return values;
}

/** @throws InvalidArgumentError unless `list` has up to four numbers for each of `length` vectors. */
function checkedList(effect: string, list: ArrayLike<number>, length: number): ArrayLike<number> {
  if (typeof list === 'object' && list !== null && list.length <= 4 * length) return list;
  throw wrongArgument('list.at', list, `a list of up to ${4 * length} numbers`, `The effect ${effect}`);
}

/** @throws InvalidArgumentError */
function checkedReach(effect: string, reach: SplatReach): SplatReach {
  const owner = `The effect ${effect}`;
  if (typeof reach !== 'object' || reach === null) throw wrongArgument('reach', reach, 'an object', owner);
  const { displacement, displacementWorld = 0, growth } = reach;
  // Infinity: without a limit.
  for (const [name, value] of Object.entries({ displacement, displacementWorld, growth }))
    if (!(typeof value === 'number' && value >= 0))
      throw wrongArgument(`reach.${name}`, value, 'a number, 0 or more', owner);
  return reach;
}
