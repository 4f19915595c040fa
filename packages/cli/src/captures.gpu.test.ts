import { readFileSync } from 'node:fs';
import { readSplats } from '@websplatter/core';
import { capturePath, captures } from '@websplatter/node/captures';
import { gpuTest } from '@websplatter/node/gpu-test';
import { describe } from 'vitest';
import { expectPresetsOfObject, referenceEngine } from './testing/expect-presets.ts';

describe.runIf(captures)('presets against float64, of', () => {
  gpuTest(
    'a captured robot',
    async () => {
      const set = await readSplats(readFileSync(capturePath('playbot-lod3.ply')), { shPrecision: 'f32' });
      const engine = await referenceEngine();
      await expectPresetsOfObject(engine, set);
      engine.destroy();
    },
    600_000,
  );
});
