import { InvalidArgumentError } from '@websplatter/core';
import fc from 'fast-check';
import { describe, expect, it } from 'vitest';
import { firstChoice } from '../effects/first-choice.ts';
import { CHOSEN_EFFECTS, type EffectChoices } from '../state/effect-choices.ts';
import { decodeEffects, encodeEffects } from './effects-text.ts';

const place = { center: [0, 0.1, 0], radius: 1, viewDepth: 2.5 } as const;
const clip = firstChoice('clip', place);
const fog = firstChoice('fog', place);
const reveal = firstChoice('reveal', place);
const on = <T>(choice: T) => ({ isOn: true, choice });

const TEXTS: readonly (readonly [EffectChoices, string])[] = [
  [{ clip: on(clip) }, 'clip:plane:0:0.1:0:0:-90:inside:0'],
  [{ clip: on({ ...clip, shape: 'box', keep: 'outside' }) }, 'clip:box:0:0.1:0:1:1:1:outside:0'],
  [{ clip: on({ ...clip, shape: 'sphere', softEdge: 0.25 }) }, 'clip:sphere:0:0.1:0:0.6:inside:0.25'],
  [{ reveal: on(reveal) }, 'reveal:0:0.1:0:0.6:0.1'],
  [{ reveal: on({ ...reveal, from: 'camera', radius: Infinity }) }, 'reveal:camera:all:0.1'],
  [{ antialias: on({ isAntialiased: false }) }, 'antialias:off'],
  [{ brightness: on({ stops: -1.5 }), tint: on({ color: '#ffd8a8' }) }, 'brightness:-1.5,tint:ffd8a8'],
  [{ fog: on(fog) }, 'fog:depths:1.5:4:c8d0dc'],
  [{ fog: on({ ...fog, kind: 'density' }) }, 'fog:density:0.24:c8d0dc'],
];

describe('effects in the address', () => {
  it.each(TEXTS)('%o are written as they are read', (choices, text) => {
    expect(encodeEffects(choices)).toBe(text);
    const linked = decodeEffects(text);
    for (const name of CHOSEN_EFFECTS) expect(choices[name]?.choice ?? {}).toMatchObject(linked[name] ?? {});
    expect(Object.keys(linked)).toEqual(Object.keys(choices));
  });

  it('leave out what is switched off', () => {
    expect(encodeEffects({})).toBeNull();
    expect(encodeEffects({ fog: { isOn: false, choice: fog } })).toBeNull();
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
    ['glow:1', 'no effect “glow” among clip, reveal'],
    ['tint:ffd8a8,tint:ffffff', 'tint is there twice'],
    ['tint:red', '“red” is no colour of six hexadecimal digits; write tint:ffd8a8'],
    ['brightness', 'a part is missing; write brightness:stops'],
    ['brightness:bright', '“bright” is no number'],
    ['brightness:1:2', '“2” is one part too many'],
    ['clip:cone:0:0:0', '“cone” is none of plane, box, sphere'],
    ['clip:sphere:0:0:0:1:around:0', '“around” is none of inside, outside'],
    ['reveal:camera:some:0', '“some” is no number'],
    ['fog:depths:1:2', 'a part is missing'],
  ])('refuse “%s”', (text, why) => {
    expect(() => decodeEffects(text)).toThrow(InvalidArgumentError);
    expect(() => decodeEffects(text)).toThrow(why);
  });
});
