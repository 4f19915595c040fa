// Proves: scenes that stand still have no binding and no line of shaders for motion.
import { expect, test } from 'vitest';
import { effectSetOf } from '../../gpu/effects/effect-set.ts';
import { shaderBindings } from '../../gpu/pipelines.ts';
import { linkInput, linkShader } from '../../gpu/shaders/link-shader.ts';
import { linkModules } from '../../gpu/shaders/shader-linker.ts';
import { cullChunks } from '../../stages/cull/cull.ts';
import { withoutConditions } from '../../testing/without-conditions.ts';
import { motion } from './motion.gpu.ts';

const namesIn = (text: string) => shaderBindings(text).map(({ name }) => name);

// link-shader.test.ts: no stage of a still scene binds anything for motion.
test('still scenes are linked as in a build without motion', () => {
  const input = linkInput(cullChunks());
  const modules = Object.fromEntries(
    Object.entries(input.modules).map(([name, text]) => [name, withoutConditions(text, ['BOUNDS_EFFECTS'])]),
  );
  expect(linkModules({ ...input, modules })).toBe(linkShader(cullChunks()));
});

test('moving scenes move the bounds of chunks, and cuts of levels do not', () => {
  const effects = effectSetOf([motion({ time: 0.5, range: [0, 1] })]);
  expect(namesIn(linkShader(cullChunks({ effects })))).toContain('motionReaches');
  expect(namesIn(linkShader(cullChunks({ effects })))).not.toContain('motion');
});

test('the first and last time hold beyond them, and the reason names the time that is shown', () => {
  const at = (time: number) => motion({ time, range: [2, 4] });
  const place = {
    modelMatrix: [],
    origin: [0, 0, 0],
    viewMatrix: [],
    projection: { isOrthographic: false, focalPx: [1, 1] },
  } as const;
  expect(at(1).valuesAt(place)).toEqual({ time: 2, interval: 0 });
  expect(at(3).valuesAt(place)).toEqual({ time: 3, interval: 16 });
  expect(at(9).valuesAt(place)).toEqual({ time: 4, interval: 31 });
  expect(at(2.71001).reason).toBe('its splats move, and are shown at 2.71');
});
