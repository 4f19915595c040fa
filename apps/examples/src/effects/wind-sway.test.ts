import { readFileSync } from 'node:fs';
import { InvalidArgumentError, type Vec3 } from '@websplatter/core';
import type { SplatValues } from '@websplatter/core/reference';
import * as fc from 'fast-check';
import { expect, it } from 'vitest';
import { type WindSwayOptions, windSway } from './wind-sway.ts';
import { windSwayReference } from './wind-sway-reference.ts';

const identity = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];
const place = {
  modelMatrix: identity,
  origin: [10, -3, 2],
  viewMatrix: identity,
  projection: { isOrthographic: false, focalPx: [1, 1] },
} as const;
const number = (min: number, max: number) => fc.double({ min, max, noNaN: true });
const vector = fc.tuple(number(-9, 9), number(-9, 9), number(-9, 9));
const direction = vector.filter((axes) => Math.hypot(...axes) > 0.1);
const anyOptions: fc.Arbitrary<WindSwayOptions> = fc.record({
  amplitude: number(0, 3),
  timeS: number(0, 1e5),
  periodS: number(0.1, 20),
  waveLength: number(0.1, 20),
  direction,
  up: direction,
  ground: number(-9, 9),
  tall: number(0.1, 9),
});

function splatAt(position: Vec3): SplatValues {
  return { row: 0, position, opacity: 1, rotation: [1, 0, 0, 0], logScales: [0, 0, 0] };
}

it('moves no splat farther than its reach', () => {
  fc.assert(
    fc.property(anyOptions, vector, (options, position) => {
      const moved = windSwayReference(options, place).changeSplat!(splatAt(position), 0).position;
      const distance = Math.hypot(...moved.map((coordinate, i) => coordinate - position[i]));
      expect(distance).toBeLessThanOrEqual(windSway(options).reach.displacement + 1e-12);
    }),
  );
});

it('moves nothing on the ground, and is off without wind', () => {
  const below: Vec3 = [1, 2, 3];
  const options = { amplitude: 1, timeS: 0.4, ground: below[1] + place.origin[1] };
  expect(windSwayReference(options, place).changeSplat!(splatAt(below), 0).position).toEqual(below);
  expect(windSway(options).reason).toContain('up to 1');
  expect(windSway({ ...options, amplitude: 0 }).reason).toBeNull();
});

it.each([{ amplitude: -1 }, { timeS: Number.NaN }, { waveLength: 0 }])('refuses %o', (wrong) => {
  expect(() => windSway({ amplitude: 1, timeS: 0, ...wrong })).toThrow(InvalidArgumentError);
});

it('equals the example in docs/effects.md', () => {
  const textOf = (path: string) => readFileSync(new URL(path, import.meta.url), 'utf8');
  const guide = textOf('../../../../docs/effects.md');
  expect(guide).toContain(`\`\`\`wgsl\n${textOf('wind-sway.wgsl')}\`\`\``);
  const sources = ['wind-sway.ts', 'wind-sway-reference.ts', '../routes/wind-sway.tsx'].map(textOf).join('');
  const lines = new Set(sources.split('\n').map((line) => line.trim()));
  const shown = [...guide.matchAll(/```tsx?\n(.*?)```/gs)].map(([, code]) => code);
  const ofThese = shown.filter((code) => /windSway = |function windSwayReference|useFrame/.test(code));
  expect(ofThese).toHaveLength(3);
  for (const line of ofThese.join('').split('\n'))
    if (!line.includes('…')) expect(lines).toContain(line.trim());
});
