import { readFileSync } from 'node:fs';
import { readSplats } from '@websplatter/core';
import { capturePath, captures } from '@websplatter/node/captures';
import { gpuTest } from '@websplatter/node/gpu-test';
import { describe } from 'vitest';
import { expectPresetsOfObject, referenceEngine } from './testing/expect-presets.ts';

describe.runIf(captures)('presets against float64, with their cost, of', () => {
  gpuTest(
    'a captured robot',
    async () => {
      const name = 'playbot-lod3.ply';
      const set = await readSplats(readFileSync(capturePath(name)), { shPrecision: 'f32' });
      const engine = await referenceEngine();
      await expectPresetsOfObject(engine, name, set);
      engine.destroy();
    },
    600_000,
  );
});
