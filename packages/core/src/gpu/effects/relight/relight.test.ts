import { describe, expect, test } from 'vitest';
import { InvalidArgumentError } from '../../../data/errors.ts';
import { identity4, type Vec3 } from '../../../data/math/mat4.ts';
import { decodeSrgb } from '../../../reference/srgb.ts';
import { project } from '../../../stages/project/project.ts';
import { PROJECT } from '../../../testing/effect-stages.ts';
import { linkShader } from '../../shaders/link-shader.ts';
import { effectSetOf } from '../effect-set.ts';
import { tint } from '../tint/tint.ts';
import { reference } from './relight.reference.ts';
import { type RelightLight, type RelightOptions, relight } from './relight.ts';

const PLACE = {
  modelMatrix: identity4(),
  origin: [0, 0, 0],
  viewMatrix: identity4(),
  projection: { isOrthographic: false, focalPx: [1, 1] },
} as const;
/** A disc that faces the eye, and one that shows its edge. */
const DISC: Vec3 = [0, 0, -50];
const ROUND: Vec3 = [-3, -3, -3];
const PI3: Vec3 = [Math.PI, Math.PI, Math.PI];
const BEHIND_THE_EYE: RelightLight = { kind: 'directional', direction: [0, 0, -1], irradiance: PI3 };

/** Linear red of a white splat that is 2 in front of the eye. */
function lightAt(options: RelightOptions, logScales = DISC, place = {}): number {
  const splat = { opacity: 1, row: 0, rotation: [1, 0, 0, 0], logScales, position: [0, 0, -2] } as const;
  const [red] = reference(options, { ...PLACE, ...place }).changeColor!([1, 1, 1], splat, 0, [0, 0, -2]);
  return decodeSrgb(red);
}

describe('relight', () => {
  test('makes a white disc white that faces light of π', () => {
    expect(lightAt({ lights: [BEHIND_THE_EYE] })).toBeCloseTo(1, 6);
    expect(lightAt({ ambient: PI3 })).toBeCloseTo(1, 6);
    expect(lightAt({ ambient: PI3, lights: [BEHIND_THE_EYE] })).toBeCloseTo(2, 6);
  });

  test('falls off with the cosine, on the side of the eye', () => {
    const aslant: RelightLight = { ...BEHIND_THE_EYE, direction: [Math.sqrt(3), 0, -1] };
    expect(lightAt({ lights: [aslant] })).toBeCloseTo(0.5, 6);
    const fromBehind: RelightLight = { ...BEHIND_THE_EYE, direction: [0, 0, 1] };
    expect(lightAt({ lights: [fromBehind], ambient: [0.1, 0.1, 0.1] })).toBeCloseTo(0.1 / Math.PI, 6);
  });

  test('lights round splats and needles evenly, by a quarter, and others in between', () => {
    for (const logScales of [ROUND, [-5, 0, -5], [-5, -5, 0]] as const)
      expect(lightAt({ lights: [BEHIND_THE_EYE] }, logScales)).toBeCloseTo(0.25, 6);
    expect(lightAt({ lights: [BEHIND_THE_EYE] }, [0, 0, Math.log(0.5)])).toBeCloseTo(0.625, 6);
  });

  test('by a strength mixes with the captured light', () => {
    expect(lightAt({ strength: 0.25 })).toBeCloseTo(0.75, 6);
    expect(lightAt({ ambient: [6, 6, 6], strength: 0 })).toBeCloseTo(1, 6);
  });

  test('by lamps decays with the distance, and ends', () => {
    const lamp: RelightLight = { kind: 'point', position: [0, 0, 0], irradiance: PI3 };
    expect(lightAt({ lights: [lamp] })).toBeCloseTo(1 / 4, 6);
    expect(lightAt({ lights: [{ ...lamp, decay: 1 }] })).toBeCloseTo(1 / 2, 6);
    expect(lightAt({ lights: [{ ...lamp, distance: 4 }] })).toBeCloseTo((1 / 4) * (15 / 16) ** 2, 6);
    expect(lightAt({ lights: [{ ...lamp, distance: 2 }] })).toBeCloseTo(0, 6);
    const spot = { ...lamp, kind: 'spot', direction: [0, 0, -7], cone: { angle: 0.2 } } as const;
    expect(lightAt({ lights: [spot] })).toBeCloseTo(1 / 4, 6);
    expect(lightAt({ lights: [{ ...spot, direction: [0.3, 0, -1] }] })).toBeCloseTo(0, 6);
    const half = { angle: 0.4, penumbra: 1 };
    const atHalf = Math.acos((1 + Math.cos(0.4)) / 2);
    const aside: Vec3 = [Math.sin(atHalf), 0, -Math.cos(atHalf)];
    expect(lightAt({ lights: [{ ...spot, direction: aside, cone: half }] })).toBeCloseTo(1 / 8, 6);
  });

  test('by sky and ground depends on where the normal points', () => {
    const sky = { kind: 'hemisphere', irradiance: PI3, ground: [0, 0, 0] } as const;
    expect(lightAt({ lights: [{ ...sky, up: [0, 0, 3] }] })).toBeCloseTo(1, 6);
    expect(lightAt({ lights: [{ ...sky, up: [0, 3, 0] }] })).toBeCloseTo(0.5, 6);
    expect(lightAt({ lights: [{ ...sky, up: [0, 0, 3] }] }, ROUND)).toBeCloseTo(0.5, 6);
  });

  test('turns normals with the cloud, also where it is stretched', () => {
    // Stretched along z by 3, then turned by a half-right angle about y.
    const [s, c] = [Math.SQRT1_2, Math.SQRT1_2];
    const modelMatrix = [c, 0, -s, 0, 0, 1, 0, 0, 3 * s, 0, 3 * c, 0, 0, 0, 0, 1];
    expect(lightAt({ lights: [BEHIND_THE_EYE] }, DISC, { modelMatrix })).toBeCloseTo(s, 6);
    const light: RelightLight = { ...BEHIND_THE_EYE, direction: [-1, 0, -1] };
    expect(lightAt({ lights: [light] }, DISC, { modelMatrix })).toBeCloseTo(1, 6);
  });

  test('has a reason unless its strength is 0, and one shader for up to seven lights', () => {
    const lights = (count: number) => relight({ lights: Array(count).fill(BEHIND_THE_EYE) });
    expect(relight({ strength: 0, ambient: PI3 }).reason).toBeNull();
    expect(relight({}).reason).toBe('it is lit by nothing');
    expect(relight({ ambient: PI3 }).reason).toBe('it is lit by ambient light');
    expect(lights(1).reason).toBe('it is lit by a light');
    expect(relight({ ambient: PI3, lights: [BEHIND_THE_EYE, BEHIND_THE_EYE] }).reason).toBe(
      'it is lit by 2 lights and ambient light',
    );
    expect(effectSetOf([lights(0)])).toBe(effectSetOf([lights(7)]));
    expect(effectSetOf([lights(8)])).toBe(effectSetOf([lights(15)]));
  });

  test('is in no shader without it', () => {
    const variant = { ...PROJECT, storedShDegree: 0, shDegree: 0 } as const;
    const text = (uses: Parameters<typeof effectSetOf>[0]) =>
      linkShader(project({ ...variant, effects: effectSetOf(uses) }));
    expect(text([tint([1, 0, 0])])).not.toMatch(/relight|irradiance|shadingNormal/i);
    expect(text([relight({}), tint([1, 0, 0])])).toMatch(/var irradiance = relightAt/);
  });

  const refused: Readonly<Record<string, readonly [object | undefined, RegExp]>> = {
    'no options': [undefined, /^relight is undefined; .*an object/],
    'lights that are no list': [{ lights: BEHIND_THE_EYE }, /^lights is .*a list/],
    '32 lights': [{ lights: Array(32).fill(BEHIND_THE_EYE) }, /There are 32 lights; .*up to 31/],
    'an unknown kind': [
      { lights: [{ ...BEHIND_THE_EYE, kind: 'area' }] },
      /^lights\[0\]\.kind is area; .*directional, point, spot or hemisphere/,
    ],
    'negative light': [
      { lights: [{ ...BEHIND_THE_EYE, irradiance: [1, -1, 0] }] },
      /^lights\[0\]\.irradiance is \[1, -1, 0\]/,
    ],
    'no direction': [{ lights: [{ ...BEHIND_THE_EYE, direction: [0, 0, 0] }] }, /direction is \[0, 0, 0\]/],
    'no position': [{ lights: [{ ...BEHIND_THE_EYE, kind: 'point' }] }, /position is undefined/],
    'a negative decay': [
      { lights: [{ kind: 'point', position: [0, 0, 0], irradiance: PI3, decay: -1 }] },
      /^lights\[0\]\.decay is -1; .*0 or more/,
    ],
    'a spot light without a cone': [
      { lights: [{ ...BEHIND_THE_EYE, kind: 'spot', position: [0, 0, 0] }] },
      /^lights\[0\]\.cone is undefined/,
    ],
    'a flat cone': [
      { lights: [{ ...BEHIND_THE_EYE, kind: 'spot', position: [0, 0, 0], cone: { angle: 2 } }] },
      /cone\.angle is 2; .*below π\/2/,
    ],
    'a sky without a ground': [
      { lights: [{ kind: 'hemisphere', irradiance: PI3, up: [0, 1, 0] }] },
      /^lights\[0\]\.ground is undefined/,
    ],
    'ambient light below 0': [{ ambient: [-1, 0, 0] }, /^ambient is \[-1, 0, 0\]/],
    'a strength above 1': [{ strength: 1.5 }, /^strength is 1\.5; .*0…1/],
  };
  for (const [what, [options, message]] of Object.entries(refused))
    test(`rejects ${what}`, () => {
      expect(() => relight(options as RelightOptions)).toThrow(InvalidArgumentError);
      expect(() => relight(options as RelightOptions)).toThrow(message);
    });
});
