import { expect, it } from 'vitest';
import { type Inspecting, NOTHING_INSPECTED } from './inspecting.ts';
import { leftSplats } from './left-splats.ts';
import type { SceneSummary } from './scene.ts';

const partOf = (key: number, splats: number, isHidden = false) => ({
  splats,
  cloudKeys: [`${key}/0`],
  look: { isHidden },
});
const sceneOf = (...parts: ReturnType<typeof partOf>[]) => ({ parts }) as unknown as SceneSummary;
const removing = (change: Partial<Inspecting> = {}): Inspecting => ({
  ...NOTHING_INSPECTED,
  selecting: {
    ...NOTHING_INSPECTED.selecting,
    removed: new Map([
      ['1/0', Uint32Array.of(0b111)],
      ['2/0', Uint32Array.of(0b1)],
      // A frame that is not shown.
      ['2/7', Uint32Array.of(0b1111)],
    ]),
  },
  ...change,
});

/**
 * @fault Order: splats are removed, the scene is cropped, and files are hidden
 * @consequence each of the viewer's words about what is left says the same number
 */
it('counts what is left of shown files', () => {
  const [a, b] = [partOf(1, 100), partOf(2, 50)];
  expect(leftSplats({ scene: sceneOf(a, b), inspecting: NOTHING_INSPECTED })).toBe(150);
  expect(leftSplats({ scene: sceneOf(a, b), inspecting: removing() })).toBe(146);
  expect(leftSplats({ scene: sceneOf(partOf(1, 100, true), b), inspecting: removing() })).toBe(49);
  expect(leftSplats({ scene: null, inspecting: NOTHING_INSPECTED })).toBe(0);
});

it('takes the number of splats that a crop leaves, once they are counted', () => {
  const crop = { min: [0, 0, 0], max: [1, 1, 1], keep: 'inside' } as const;
  const scene = sceneOf(partOf(1, 100));
  expect(leftSplats({ scene, inspecting: removing({ crop }) })).toBeNull();
  expect(leftSplats({ scene, inspecting: removing({ crop, cropCount: 7 }) })).toBe(7);
});
