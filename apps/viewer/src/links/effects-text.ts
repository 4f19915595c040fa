import { InvalidArgumentError } from '@websplatter/core';
import type { Vec3 } from '../camera/vec3.ts';
import {
  CHOSEN_EFFECTS,
  type ChosenEffect,
  type ClipChoice,
  type EffectChoice,
  type EffectChoices,
  type HexColor,
} from '../state/effect-choices.ts';

/** What an address tells of effects that are on: of a clip, say, nothing about the shapes that it does not have. */
export type LinkedEffects = { readonly [Name in ChosenEffect]?: Partial<EffectChoice<Name>> };

/** How each effect is written. */
const FORMS: Readonly<Record<ChosenEffect, string>> = {
  clip: 'clip:plane:x:y:z:turn:tilt:inside:0, clip:box:x:y:z:width:height:depth:inside:0 or clip:sphere:x:y:z:radius:outside:0, each with its soft edge last',
  reveal:
    'reveal:camera:radius:softEdge or reveal:x:y:z:radius:softEdge, with the radius “all” for everything',
  antialias: 'antialias:on or antialias:off',
  brightness: 'brightness:stops',
  tint: 'tint:ffd8a8',
  fog: 'fog:depths:near:far:c8d0dc or fog:density:density:c8d0dc',
};

type Part = string | number;

const WRITERS: { readonly [Name in ChosenEffect]: (choice: EffectChoice<Name>) => readonly Part[] } = {
  clip: (choice) => [choice.shape, ...choice.center, ...clipSize(choice), choice.keep, choice.softEdge],
  reveal: ({ from, radius, softEdge }) => [
    ...(from === 'camera' ? [from] : from),
    radius === Infinity ? 'all' : radius,
    softEdge,
  ],
  antialias: ({ isAntialiased }) => [isAntialiased ? 'on' : 'off'],
  brightness: ({ stops }) => [stops],
  tint: ({ color }) => [color.slice(1)],
  fog: ({ kind, near, far, density, color }) => [
    kind,
    ...(kind === 'depths' ? [near, far] : [density]),
    color.slice(1),
  ],
};

function clipSize({ shape, size, radius, turnDegrees, tiltDegrees }: ClipChoice): readonly number[] {
  if (shape === 'box') return size;
  return shape === 'sphere' ? [radius] : [turnDegrees, tiltDegrees];
}

/**
 * For the address, the effects that are on: `clip:sphere:0:0.1:0:0.6:inside:0,brightness:0.5`; null if none is. Lengths are in
 * the units of the scene. Numbers are the shortest that read back as the same float64.
 */
export function encodeEffects(choices: EffectChoices): string | null {
  const parts = CHOSEN_EFFECTS.flatMap((name) => {
    const chosen = choices[name];
    const write = WRITERS[name] as (choice: EffectChoice) => readonly Part[];
    return chosen?.isOn ? [[name, ...write(chosen.choice)].join(':')] : [];
  });
  return parts.length > 0 ? parts.join(',') : null;
}

/**
 * Reads what `encodeEffects` wrote. Whether an effect can have these numbers is for the engine to say.
 *
 * @throws InvalidArgumentError naming the effect or the part that cannot be, and how it is written.
 */
export function decodeEffects(text: string): LinkedEffects {
  const linked: Record<string, unknown> = {};
  for (const part of text.split(',')) {
    const [name, ...values] = part.trim().split(':');
    if (!isChosenEffect(name))
      throw refused(`there is no effect “${name}” among ${CHOSEN_EFFECTS.join(', ')}`);
    if (name in linked) throw refused(`${name} is there twice`);
    linked[name] = READERS[name](new Parts(name, values));
  }
  return linked;
}

function isChosenEffect(name: string): name is ChosenEffect {
  return (CHOSEN_EFFECTS as readonly string[]).includes(name);
}

const READERS: { readonly [Name in ChosenEffect]: (parts: Parts) => Partial<EffectChoice<Name>> } = {
  clip(parts) {
    const shape = parts.oneOf('plane', 'box', 'sphere');
    const center = parts.vector();
    const size =
      shape === 'box'
        ? { size: parts.vector() }
        : shape === 'sphere'
          ? { radius: parts.number() }
          : { turnDegrees: parts.number(), tiltDegrees: parts.number() };
    const keep = parts.oneOf('inside', 'outside');
    return parts.ended({ shape, center, ...size, keep, softEdge: parts.number() });
  },
  reveal(parts) {
    const from = parts.takesWord('camera') ? 'camera' : parts.vector();
    const radius = parts.takesWord('all') ? Infinity : parts.number();
    return parts.ended({ from, radius, softEdge: parts.number() });
  },
  antialias: (parts) => parts.ended({ isAntialiased: parts.oneOf('on', 'off') === 'on' }),
  brightness: (parts) => parts.ended({ stops: parts.number() }),
  tint: (parts) => parts.ended({ color: parts.color() }),
  fog(parts) {
    const kind = parts.oneOf('depths', 'density');
    const depths =
      kind === 'depths' ? { near: parts.number(), far: parts.number() } : { density: parts.number() };
    return parts.ended({ kind, ...depths, color: parts.color() });
  },
};

/** The parts of one effect, read one after the other. */
class Parts {
  readonly #name: ChosenEffect;
  readonly #parts: readonly string[];
  #at = 0;

  constructor(name: ChosenEffect, parts: readonly string[]) {
    this.#name = name;
    this.#parts = parts;
  }

  number(): number {
    const part = this.#next();
    const value = part === '' ? Number.NaN : Number(part);
    if (!Number.isFinite(value)) throw this.#refused(`“${part}” is no number`);
    return value;
  }

  vector(): Vec3 {
    return [this.number(), this.number(), this.number()];
  }

  oneOf<Word extends string>(...words: readonly Word[]): Word {
    const part = this.#next();
    const word = words.find((each) => each === part);
    if (word === undefined) throw this.#refused(`“${part}” is none of ${words.join(', ')}`);
    return word;
  }

  /** Goes on after this word, if it is the next. */
  takesWord(word: string): boolean {
    const isNext = this.#parts[this.#at] === word;
    if (isNext) this.#at++;
    return isNext;
  }

  color(): HexColor {
    const part = this.#next();
    if (!/^[0-9a-f]{6}$/i.test(part)) throw this.#refused(`“${part}” is no colour of six hexadecimal digits`);
    return `#${part.toLowerCase()}`;
  }

  /** `value`, if no parts are left over. */
  ended<T>(value: T): T {
    if (this.#at < this.#parts.length) throw this.#refused(`“${this.#parts[this.#at]}” is one part too many`);
    return value;
  }

  #next(): string {
    if (this.#at >= this.#parts.length) throw this.#refused('a part is missing');
    return this.#parts[this.#at++];
  }

  #refused(why: string): InvalidArgumentError {
    return refused(`of ${this.#name}, ${why}; write ${FORMS[this.#name]}`);
  }
}

function refused(why: string): InvalidArgumentError {
  return new InvalidArgumentError('effects', `The effects of the address cannot be read: ${why}.`);
}
