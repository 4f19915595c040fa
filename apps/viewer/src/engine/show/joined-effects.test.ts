import {
  antialias,
  defineEffect,
  type EffectUse,
  fog,
  highlight,
  SplatSelection,
  tint,
  volumes,
} from '@websplatter/core/effects';
import { expect, it } from 'vitest';
import { NO_EFFECTS } from '../../state/effects.ts';
import { joinedEffects } from './drawing.ts';

const box = { shape: 'box', mode: 'keep', size: [1, 1, 1] } as const;
const plane = { shape: 'plane', mode: 'hide', normal: [0, 1, 0], softEdge: 0.25 } as const;
const namesOf = (uses: readonly EffectUse[]) => uses.map(({ effect }) => effect.name);

it('is empty where nothing is asked for', () => {
  expect(joinedEffects(NO_EFFECTS, '1/0')).toEqual([]);
});

it('joins what several panels ask for', () => {
  const grey = fog({ color: [0.5, 0.5, 0.5], density: 1 });
  const marked = new Map([['1/0', [tint([1, 0, 0])]]]);
  const requested = { ...NO_EFFECTS, effects: [grey], marked };
  expect(namesOf(joinedEffects(requested, '1/0'))).toEqual(['fog', 'tint']);
  // Other clouds have other marks, or none.
  expect(namesOf(joinedEffects(requested, '2/0'))).toEqual(['fog']);
});

it('cuts with the volumes of all panels', () => {
  const requested = {
    ...NO_EFFECTS,
    effects: [volumes([plane])],
    crop: [volumes([box])],
  };
  const joined = joinedEffects(requested, '1/0');
  expect(namesOf(joined)).toEqual(['volumes']);
  expect(joined[0].options).toEqual([plane, box]);
});

it('lets the last of several panels have any other effect', () => {
  const red = tint([1, 0, 0]);
  const marked = new Map([['1/0', [red]]]);
  expect(joinedEffects({ ...NO_EFFECTS, effects: [tint([0, 1, 0])], marked }, '1/0')).toEqual([red]);
});

it('leaves the colours of a view mode as they are, but for marks', () => {
  const mode = defineEffect<undefined>({
    name: 'own-colors',
    label: 'Own colours',
    about: 'Colours splats.',
    hooks: { color: 'ownColor' },
    wgsl: '',
    calledFor: () => 'the mode asks for it',
  })();
  const marked = highlight({ selection: new SplatSelection(), color: [1, 0, 0], strength: 1 });
  const effects = [antialias(true), tint([1, 0, 0]), volumes([box]), marked];
  const joined = joinedEffects({ ...NO_EFFECTS, effects, 'view-mode': [mode, antialias(false)] }, '1/0');
  expect(namesOf(joined)).toEqual(['antialias', 'volumes', 'highlight', 'own-colors']);
  expect(joined[0].options).toBe(false);
  const unmarked = joinedEffects({ ...NO_EFFECTS, effects, 'view-mode': [antialias(false)] }, '1/0');
  expect(namesOf(unmarked)).toEqual(['antialias', 'tint', 'volumes', 'highlight']);
});
