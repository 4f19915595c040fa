import { InvalidArgumentError } from '@websplatter/core';
import {
  EFFECT_OPTIONS,
  type EffectOption,
  type OptionValue,
  type OptionValues,
} from '@websplatter/core/effect-options';
import { optionsBeside } from './effect-values.ts';
import type { EffectChoices } from './effects.ts';

/**
 * For the address, the effects that are on: `clip:sphere:0:0.1:0:0.6:inside:0,brightness:0.5`; null
 * if none is. After the name come the values of the options that have a meaning, in their order.
 * Lengths are in the units of the scene. Numbers are the shortest that read back as the same
 * float64.
 */
export function encodeEffects(choices: EffectChoices): string | null {
  const parts = Object.keys(EFFECT_OPTIONS).flatMap((name) => {
    const chosen = choices[name];
    if (!chosen?.isOn) return [];
    const texts = optionsBeside(name, chosen.values).map(([key]) => textOf(chosen.values[key]));
    return [name, ...texts].join(':');
  });
  return parts.length > 0 ? parts.join(',') : null;
}

function textOf(value: OptionValue): string {
  if (value === Infinity) return 'all';
  return typeof value === 'object' ? value.join(':') : String(value).replace('#', '');
}

/**
 * Reads the text of `encodeEffects`, by the effect's name: of a clip, say, nothing about the shapes
 * that it does not have. Whether an effect can have these numbers is for the engine to say.
 *
 * @throws InvalidArgumentError naming the effect or the part that cannot be, and how it is written.
 */
export function decodeEffects(text: string): Readonly<Record<string, OptionValues>> {
  const linked: Record<string, OptionValues> = {};
  for (const part of text.split(',')) {
    const [name, ...parts] = part.trim().split(':');
    if (!Object.hasOwn(EFFECT_OPTIONS, name))
      throw refused(`there is no effect “${name}” among ${Object.keys(EFFECT_OPTIONS).join(', ')}`);
    if (name in linked) throw refused(`${name} is there twice`);
    linked[name] = readValues(name, parts);
  }
  return linked;
}

/** Reads the parts of one effect one after the other: which follow depends on those before. */
function readValues(name: string, parts: readonly string[]): OptionValues {
  const options = Object.entries(EFFECT_OPTIONS[name].options);
  const left = [...parts];
  let values: OptionValues = {};
  const refusedFor = (why: string) => {
    const words = options.flatMap(([key, option]) => (option.kind === 'choice' ? [[key, option.first]] : []));
    const meant = optionsBeside(name, { ...Object.fromEntries(words), ...values });
    return refused(`of ${name}, ${why}; write ${[name, ...meant.map(formOf)].join(':')}`);
  };
  const next = (isRight: (part: string) => boolean, why: string) => {
    const part = left.shift();
    if (part === undefined) throw refusedFor('a part is missing');
    if (!isRight(part)) throw refusedFor(`“${part}” is ${why}`);
    return part;
  };
  const number = () => Number(next((part) => part !== '' && Number.isFinite(Number(part)), 'no number'));
  const isNext = (word: string) => left[0] === word && left.shift() === word;
  const read = (option: EffectOption): OptionValue => {
    switch (option.kind) {
      case 'number':
        return option.isEndless && isNext('all') ? Infinity : number();
      case 'color':
        return `#${next((part) => /^[0-9a-f]{6}$/i.test(part), 'no colour of six hexadecimal digits').toLowerCase()}`;
      case 'choice': {
        const words = Object.keys(option.choices(values));
        return next((part) => words.includes(part), `none of ${words.join(', ')}`);
      }
      default:
        if (option.kind === 'origin' && isNext('camera')) return 'camera';
        return [number(), number(), number()];
    }
  };
  for (const [key, option] of options) {
    const hasMeaning = optionsBeside(name, values).some(([each]) => each === key);
    if (hasMeaning) values = { ...values, [key]: read(option) };
  }
  if (left.length > 0) throw refusedFor(`“${left[0]}” is one part too many`);
  return values;
}

/** How an option is written. */
function formOf([key, option]: readonly [string, EffectOption]): string {
  switch (option.kind) {
    case 'number':
      return option.isEndless ? `${key}|all` : key;
    case 'color':
      return textOf(option.first);
    case 'choice':
      return Object.keys(option.choices({})).join('|');
    case 'origin':
      return 'camera|x:y:z';
    default:
      return 'x:y:z';
  }
}

function refused(why: string): InvalidArgumentError {
  return new InvalidArgumentError('effects', `The effects of the address cannot be read: ${why}.`);
}
