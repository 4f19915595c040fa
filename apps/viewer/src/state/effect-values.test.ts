import { describe, expect, it } from 'vitest';
import { chosenUses, firstValues } from './effect-values.ts';
import { NO_CHOICES } from './effects.ts';

const place = { center: [0, 0, 0], radius: 1, viewDepth: 2 } as const;
const first = firstValues('volumes', place);
const fog = firstValues('fog', place);

describe('effects for the engine', () => {
  it('is nothing at first', () => expect(chosenUses(NO_CHOICES)).toEqual([]));

  it('are those switched on, with the options of the engine', () => {
    const uses = chosenUses({
      fog: { isOn: true, values: { ...fog, color: '#ff8000' } },
      tint: { isOn: false, values: { color: '#00ff00' } },
      brightness: { isOn: true, values: { stops: -1 } },
      antialias: { isOn: true, values: { state: 'off' } },
    });
    expect(uses.map(({ effect, options }) => [effect.name, options])).toEqual([
      ['antialias', false],
      ['brightness', 0.5],
      ['fog', { color: [1, 128 / 255, 0], near: 1, far: 3.5 }],
    ]);
  });

  it('is fog by density instead of depths', () => {
    const [use] = chosenUses({ fog: { isOn: true, values: { ...fog, kind: 'density' } } });
    expect(use.options).toMatchObject({ density: 0.3 });
  });

  it.each([
    [{ shape: 'box' }, { shape: 'box', center: [0, 0, 0], size: [1, 1, 1], mode: 'keep' }],
    [
      { shape: 'sphere', mode: 'hide' },
      { shape: 'sphere', center: [0, 0, 0], radius: 0.6, mode: 'hide' },
    ],
    [
      { turnDegrees: 90, tiltDegrees: 0 },
      { shape: 'plane', normal: [1, 0, expect.closeTo(0, 12)] },
    ],
  ] as const)('is a volume: %o', (changes, volume) => {
    const [{ options }] = chosenUses({ volumes: { isOn: true, values: { ...first, ...changes } } });
    expect(options).toMatchObject([volume]);
  });
});
