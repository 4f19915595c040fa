import { fog } from '@websplatter/core/effects';
import {
  color,
  densityFogFactor,
  exponentialHeightFogFactor,
  float,
  fog as fogNodeOf,
  rangeFogFactor,
  uniform,
} from 'three/tsl';
import { Color, Fog, FogExp2, Scene } from 'three/webgpu';
import { describe, expect, test, vi } from 'vitest';
import { sceneFog } from './scene-fog.ts';

/** Returns the options of the fog of a scene with `fog`. */
function optionsOf(ofScene: Fog | FogExp2): unknown {
  const scene = new Scene();
  scene.fog = ofScene;
  const [use, ...others] = sceneFog(scene);
  expect(use.effect).toBe(fog.effect);
  expect(others).toEqual([]);
  return use.options;
}

test('fog has the options of the scene’s fog', () => {
  expect(optionsOf(new Fog('white', 2, 5))).toEqual({ color: [1, 1, 1], near: 2, far: 5 });
  expect(optionsOf(new FogExp2('black', 0.1))).toEqual({ color: [0, 0, 0], density: 0.1 });
});

test.each([new Fog('white', 5, 5), new Fog('white', 5, 2)])(
  'fog that three accepts is accepted: %o',
  (ofScene) => {
    expect(() => optionsOf(ofScene)).not.toThrow();
  },
);

/** Returns the options of the fog of a scene with `fogNode` and white fog beside it. */
function optionsOfNode(fogNode: object): unknown {
  const scene = Object.assign(new Scene(), { fogNode });
  scene.fog = new Fog('white', 2, 5);
  return sceneFog(scene)[0].options;
}

describe('a fog node', () => {
  test('of range or density is followed, with the present values of uniforms', () => {
    const [tone, far] = [uniform(new Color('white')), uniform(7)];
    const node = fogNodeOf(tone, rangeFogFactor(float(3), far));
    expect(optionsOfNode(node)).toEqual({ color: [1, 1, 1], near: 3, far: 7 });
    tone.value.set('black');
    far.value = 8;
    expect(optionsOfNode(node)).toEqual({ color: [0, 0, 0], near: 3, far: 8 });
    const dense = fogNodeOf(color(0x000000), densityFogFactor(float(0.5)));
    expect(optionsOfNode(dense)).toEqual({ color: [0, 0, 0], density: 0.5 });
  });

  test.each([
    ['by height', fogNodeOf(color(0), exponentialHeightFogFactor(float(1), float(2)))],
    ['of computed distances', fogNodeOf(color(0), rangeFogFactor(float(1), float(2).mul(3)))],
    ['of a computed density', fogNodeOf(color(0), densityFogFactor(float(1).mul(3)))],
    ['of a computed colour', fogNodeOf(color(0).mul(2), densityFogFactor(float(1)))],
    ['of a factor alone', rangeFogFactor(float(1), float(2))],
    ['of another kind', {}],
  ])('%s is not, and the fog beside it is', (_, node) => {
    expect(optionsOfNode(node)).toEqual({ color: [1, 1, 1], near: 2, far: 5 });
  });
});

test('a fog node that is not followed is warned of once, and not where the scene has fog for splats beside it', () => {
  const warn = vi.spyOn(console, 'warn').mockImplementation(() => {});
  const scene = Object.assign(new Scene(), { fogNode: {} });
  scene.fog = new Fog('white', 2, 5);
  expect(sceneFog(scene)).toHaveLength(1);
  expect(warn).not.toHaveBeenCalled();
  scene.fog = null;
  for (let i = 0; i < 2; i++) expect(sceneFog(scene)).toEqual([]);
  expect(warn).toHaveBeenCalledExactlyOnceWith(expect.stringContaining('Set scene.fog'));
  warn.mockRestore();
});
