import { fog } from '@websplatter/core/effects';
import { Fog, FogExp2, Scene } from 'three/webgpu';
import { expect, test, vi } from 'vitest';
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

test('a fog node is warned of once, and not where the scene has fog for splats beside it', () => {
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
