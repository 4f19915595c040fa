import type { SplatReach } from '../../data/camera/frustum.ts';
import { InvalidArgumentError } from '../../data/errors.ts';
import { checkKind, given, wrongArgument } from '../../data/given.ts';
import {
  componentsOf,
  type GpuFields,
  type GpuStruct,
  type GpuValues,
} from '../../data/layout/gpu-struct.ts';

const HOOKS = ['splat', 'opacity', 'color', 'screen', 'bounds'];
const NAME = /^[a-zA-Z]\w*$/;

/** The parts of an `EffectDefinition` that are checked. */
interface Definition {
  readonly name: string;
  readonly hooks: object;
  readonly wgsl: string;
  readonly fields?: GpuFields;
  readonly rows?: object;
  readonly resources?: object;
}

const FUNCTIONS = ['calledFor', 'check', 'hooksFor', 'selection', 'valuesAt', 'reach'];

/**
 * Checks what becomes code of shaders. WGSL refuses the rest: words that it reserves, and wrong functions.
 *
 * @throws InvalidArgumentError
 */
export function checkDefinition(definition: Definition): void {
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

/** @throws InvalidArgumentError unless `values` has a number or a list, of the right length, for each field. */
export function checkValues(effect: string, { fields }: GpuStruct<GpuFields>, values: unknown): void {
  const owner = `The effect ${effect}`;
  if (typeof values !== 'object' || values === null)
    throw wrongArgument('valuesAt', values, `an object with ${Object.keys(fields).join(', ')}`, owner);
  for (const field in fields) {
    const value = (values as GpuValues<GpuFields>)[field];
    const count = componentsOf(fields[field]);
    const isRight =
      typeof value === 'number' ? count === 1 : typeof value === 'object' && value?.length === count;
    const expected = count === 1 ? 'a number' : `a list of ${count} numbers`;
    if (!isRight) throw wrongArgument(`valuesAt.${field}`, value, expected, owner);
  }
}

/** @throws InvalidArgumentError unless `list` has up to four numbers for each of `length` vectors. */
export function checkList(effect: string, list: ArrayLike<number>, length: number): void {
  if (typeof list === 'object' && list !== null && list.length <= 4 * length) return;
  throw wrongArgument('list.at', list, `a list of up to ${4 * length} numbers`, `The effect ${effect}`);
}

/** @throws InvalidArgumentError */
export function checkReach(effect: string, reach: SplatReach): void {
  const owner = `The effect ${effect}`;
  if (typeof reach !== 'object' || reach === null) throw wrongArgument('reach', reach, 'an object', owner);
  const { displacement, displacementWorld = 0, growth } = reach;
  // Infinity: without a limit.
  for (const [name, value] of Object.entries({ displacement, displacementWorld, growth }))
    if (!(typeof value === 'number' && value >= 0))
      throw wrongArgument(`reach.${name}`, value, 'a number, 0 or more', owner);
}
