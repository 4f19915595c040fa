import { describe, expect, test } from 'vitest';
import { orthographicCamera } from '../../../data/camera/camera.ts';
import { InvalidArgumentError } from '../../../data/errors.ts';
import { identity4 } from '../../../data/math/mat4.ts';
import { project } from '../../../stages/project/project.ts';
import { PROJECT } from '../../../testing/effect-stages.ts';
import { linkShader } from '../../shaders/link-shader.ts';
import { effectSetOf } from '../effect-set.ts';
import { tint } from '../tint/tint.ts';
import { reference } from './shadows.reference.ts';
import { type ShadowLight, type ShadowsOptions, shadows } from './shadows.ts';

const MAP = { createView: () => ({}) } as unknown as GPUTexture;
/** Sees ±4 about the origin, and depths of 0…10 from 5 above. */
const CAMERA = orthographicCamera({
  position: [0, 5, 0],
  target: [0, 0, 0],
  up: [0, 0, -1],
  height: 8,
  aspect: 1,
});
const SUN: ShadowLight = {
  map: MAP,
  camera: { ...CAMERA, projectionMatrix: [0.25, 0, 0, 0, 0, 0.25, 0, 0, 0, 0, -0.1, 0, 0, 0, 0, 1] },
  irradiance: [3, 3, 3],
};
const PLACE = {
  modelMatrix: identity4(),
  origin: [0, 0, 0],
  viewMatrix: identity4(),
  projection: { isOrthographic: false, focalPx: [1, 1] },
} as const;
const SPLAT = { opacity: 1, row: 0, rotation: [1, 0, 0, 0], logScales: [-9, -9, -9] } as const;

/** Red of a white splat; the left half of the map has depth 3, and the right half none. */
function redAt(x: number, y: number, options: Partial<ShadowsOptions> = {}, scale = 0): number {
  const depths = Array.from({ length: 64 }, (_, i) => (i % 8 < 4 ? 0.3 : 1));
  const depthsOf = () => ({ widthPx: 8, heightPx: 8, depths });
  const { changeColor } = reference({ lights: [SUN], ...options, depthsOf }, PLACE);
  const logScales = [-9, scale ? Math.log(scale) : -9, -9] as const;
  const splat = { ...SPLAT, logScales, position: [x, y, 0] } as const;
  const [red] = changeColor!([1, 1, 1], splat, 0, [0, 0, 0]);
  return Math.round(red * 1e9) / 1e9;
}

describe('shadows', () => {
  test('take the light of splats behind what the map shows, and none in front of it', () => {
    expect(redAt(-2, 0)).toBe(0);
    expect(redAt(-2, 2.1)).toBe(1);
    expect(redAt(2, 0)).toBe(1);
    // Beyond the map.
    expect(redAt(-5, 0)).toBe(1);
  });

  test('leave the share of other light, as of a white surface: a quarter of it is 0.5371', () => {
    expect(redAt(-2, 0, { steady: [1, 1, 1] })).toBeCloseTo(0.5371, 4);
    expect(redAt(-2, 0, { lights: [{ ...SUN, strength: 0.75 }] })).toBeCloseTo(0.5371, 4);
  });

  test('fade over three texels', () => {
    const red = [-2.1, -1.5, -0.5, 0, 0.5, 1.5].map((x) => redAt(x, 0));
    expect(red).toEqual(red.toSorted((a, b) => a - b));
    expect(new Set(red.slice(1, 5)).size).toBe(4);
    // Half of the light, encoded.
    expect([red[0], red[5]]).toEqual([0, 1]);
    expect(red[3]).toBeCloseTo(0.7354, 4);
  });

  test('spare splats that reach towards the light, by three standard deviations', () => {
    expect(redAt(-2, 1, {}, 0.3)).toBe(0);
    expect(redAt(-2, 1, {}, 0.34)).toBe(1);
    expect(redAt(-2, 1, { lights: [{ ...SUN, offset: 1.1 }] })).toBe(1);
    expect(redAt(-2, 1.9, { lights: [{ ...SUN, bias: -0.02 }] })).toBe(1);
  });

  test('have a reason with lights, and one shader for any number of them', () => {
    expect(shadows({ lights: [] }).reason).toBeNull();
    expect(shadows({ lights: [SUN] }).reason).toBe('a light casts shadows on it');
    expect(shadows({ lights: [SUN, SUN] }).reason).toBe('2 lights cast shadows on it');
    const setOf = (count: number) => effectSetOf([shadows({ lights: Array(count).fill(SUN) })]);
    expect(setOf(1)).toBe(setOf(4));
  });

  test('are in no shader without them', () => {
    const variant = { ...PROJECT, storedShDegree: 0, shDegree: 0 } as const;
    const text = (uses: Parameters<typeof effectSetOf>[0]) =>
      linkShader(project({ ...variant, effects: effectSetOf(uses) }));
    const tinted = text([tint([1, 0, 0])]);
    expect(tinted).not.toMatch(/shadow|texture/i);
    expect(text([shadows({ lights: [SUN] }), tint([1, 0, 0])])).toMatch(/textureLoad\(map/);
  });

  const refused: Readonly<Record<string, readonly [object, RegExp]>> = {
    'no list': [{}, /^lights is undefined; .*a list/],
    'five lights': [{ lights: Array(5).fill(SUN) }, /There are 5 lights; .*up to 4/],
    'no map': [{ lights: [{ ...SUN, map: undefined }] }, /^lights\[0\]\.map is undefined/],
    'no camera': [{ lights: [{ ...SUN, camera: undefined }] }, /^lights\[0\]\.camera is undefined/],
    'negative light': [{ lights: [{ ...SUN, irradiance: [1, -1, 0] }] }, /irradiance is \[1, -1, 0\]/],
    'strength above 1': [{ lights: [{ ...SUN, strength: 2 }] }, /strength is 2; .*0…1/],
    'a flat cone': [{ lights: [{ ...SUN, cone: { angle: 0 } }] }, /cone\.angle is 0; .*above 0/],
    'a bias that is none': [{ lights: [{ ...SUN, bias: Number.NaN }] }, /bias is NaN/],
    'negative other light': [{ lights: [SUN], steady: [-1, 0, 0] }, /^steady is/],
  };
  for (const [what, [options, message]] of Object.entries(refused))
    test(`rejects ${what}`, () => {
      expect(() => shadows(options as ShadowsOptions)).toThrow(InvalidArgumentError);
      expect(() => shadows(options as ShadowsOptions)).toThrow(message);
    });
});
