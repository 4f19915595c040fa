import {
  EFFECT_OPTIONS,
  type EffectOption,
  type OptionValue,
  type OptionValues,
} from '@websplatter/core/effect-options';
import { optionsBeside } from '../state/effect-values.ts';
import type { EffectChoices } from '../state/effects.ts';
import { linkField, type Refuse } from '../state/link-parts.ts';

/**
 * The effects that are on: `volumes:sphere:0:0.1:0:0.6:keep:0,brightness:0.5`; null if none is. The
 * values of the options that have a meaning follow an effect's name, in their order. Lengths are in
 * the units of the scene.
 *
 * Only the options that have a meaning are read, by the effect's name. The engine checks whether an
 * effect can have these numbers.
 */
export const EFFECTS_FIELD = linkField(
  'effects',
  { subject: 'The effects of the address', form: null },
  (choices: EffectChoices) => {
    const parts = Object.keys(EFFECT_OPTIONS).flatMap((name) => {
      const chosen = choices[name];
      if (!chosen?.isOn) return [];
      const texts = optionsBeside(name, chosen.values).map(([key]) => textOf(chosen.values[key]));
      return [name, ...texts].join(':');
    });
    return parts.length > 0 ? parts.join(',') : null;
  },
  (text, refuse): Readonly<Record<string, OptionValues>> => {
    const linked: Record<string, OptionValues> = {};
    for (const part of text.split(',')) {
      const [name, ...parts] = part.trim().split(':');
      if (!Object.hasOwn(EFFECT_OPTIONS, name))
        throw refuse(`there is no effect “${name}” among ${Object.keys(EFFECT_OPTIONS).join(', ')}`);
      if (name in linked) throw refuse(`${name} is there twice`);
      linked[name] = readValues(name, parts, refuse);
    }
    return linked;
  },
);

function textOf(value: OptionValue): string {
  if (value === Infinity) return 'all';
  return typeof value === 'object' ? value.join(':') : String(value).replace('#', '');
}

/** Reads the parts of one effect one after the other: earlier values decide which options follow. */
function readValues(name: string, parts: readonly string[], refuse: Refuse): OptionValues {
  const options = Object.entries(EFFECT_OPTIONS[name].options);
  const left = [...parts];
  let values: OptionValues = {};
  const refusedFor = (why: string) => {
    const words = options.flatMap(([key, option]) => (option.kind === 'choice' ? [[key, option.first]] : []));
    const meant = optionsBeside(name, { ...Object.fromEntries(words), ...values });
    return refuse(`of ${name}, ${why}; write ${[name, ...meant.map(formOf)].join(':')}`);
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
