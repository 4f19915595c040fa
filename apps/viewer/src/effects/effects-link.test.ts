import { InvalidArgumentError } from '@websplatter/core';
import { EFFECT_OPTIONS, type OptionValues } from '@websplatter/core/effect-options';
import fc from 'fast-check';
import { describe, expect, it } from 'vitest';
import { chosenUses, firstValues } from '../state/effect-values.ts';
import type { EffectChoices } from '../state/effects.ts';
import { EFFECTS_FIELD } from './effects-link.ts';

const { encode: encodeEffects, decode: decodeEffects } = EFFECTS_FIELD;

const place = { center: [0, 0.1, 0], radius: 1, viewDepth: 2.5 } as const;
const volumes = firstValues('volumes', place);
const fog = firstValues('fog', place);
const reveal = firstValues('reveal', place);
const on = (values: OptionValues) => ({ isOn: true, values });

const TEXTS: readonly (readonly [EffectChoices, string])[] = [
  [{ volumes: on(volumes) }, 'volumes:plane:0:0.1:0:0:-90:keep:0'],
  [{ volumes: on({ ...volumes, shape: 'box', mode: 'hide' }) }, 'volumes:box:0:0.1:0:1:1:1:hide:0'],
  [{ volumes: on({ ...volumes, shape: 'sphere', softEdge: 0.25 }) }, 'volumes:sphere:0:0.1:0:0.6:keep:0.25'],
  [{ reveal: on(reveal) }, 'reveal:0:0.1:0:0.6:0.1'],
  [{ reveal: on({ ...reveal, from: 'camera', radius: Infinity }) }, 'reveal:camera:all:0.1'],
  [{ antialias: on({ state: 'off' }) }, 'antialias:off'],
  [{ brightness: on({ stops: -1.5 }), tint: on({ color: '#ffd8a8' }) }, 'brightness:-1.5,tint:ffd8a8'],
  [{ fog: on(fog) }, 'fog:depths:1.5:4:c8d0dc'],
  [{ fog: on({ ...fog, kind: 'density' }) }, 'fog:density:0.24:c8d0dc'],
];

describe('effects in the address', () => {
  it.each(TEXTS)('%o are written as they are read', (choices, text) => {
    expect(encodeEffects(choices)).toBe(text);
    const linked = decodeEffects(text);
    expect(Object.keys(linked)).toEqual(Object.keys(choices));
    for (const [name, values] of Object.entries(linked)) expect(choices[name]?.values).toMatchObject(values);
  });

  it.each(Object.keys(EFFECT_OPTIONS))('tell what %s begins with, which the engine takes', (name) => {
    const choices = { [name]: on(firstValues(name, place)) };
    expect(chosenUses(choices)).toMatchObject([{ effect: { name }, reason: expect.any(String) }]);
    const linked = decodeEffects(encodeEffects(choices) ?? '');
    expect(choices[name].values).toMatchObject(linked[name]);
  });

  it('leave out what is switched off', () => {
    expect(encodeEffects({})).toBeNull();
    expect(encodeEffects({ fog: { isOn: false, values: fog } })).toBeNull();
  });

  it('keep every number to the last bit', () => {
    fc.assert(
      fc.property(fc.double({ noNaN: true, noDefaultInfinity: true }), (stops) => {
        const text = encodeEffects({ brightness: on({ stops }) }) ?? '';
        expect(decodeEffects(text).brightness?.stops).toBe(stops + 0);
      }),
    );
  });

  it.each([
    ['', 'no effect “”'],
    ['glow:1', 'no effect “glow” among volumes, reveal'],
    ['tint:ffd8a8,tint:ffffff', 'tint is there twice'],
    ['tint:red', '“red” is no colour of six hexadecimal digits; write tint:ffd8a8'],
    ['brightness', 'a part is missing; write brightness:stops'],
    ['brightness:bright', '“bright” is no number'],
    ['brightness:1:2', '“2” is one part too many'],
    ['volumes:cone:0:0:0', '“cone” is none of plane, box, sphere'],
    ['volumes:sphere:0:0:0:1:around:0', '“around” is none of keep, hide'],
    ['reveal:camera:some:0', '“some” is no number'],
    ['fog:depths:1:2', 'a part is missing; write fog:depths|density:near:far:c8d0dc'],
    ['fog:thick', '“thick” is none of depths, density; write fog:depths|density:near:far:c8d0dc'],
  ])('refuse “%s”', (text, why) => {
    expect(() => decodeEffects(text)).toThrow(InvalidArgumentError);
    expect(() => decodeEffects(text)).toThrow(why);
  });
});
