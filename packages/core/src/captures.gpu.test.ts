import { readFileSync } from 'node:fs';
import { capturePath, captures } from '@websplatter/node/captures';
import { gpuTest, shareBlendingDevice } from '@websplatter/node/gpu-test';
import { describe, test } from 'vitest';
import { readSplats } from './io/loading/read-splats.ts';
import { expectObjectAccurate, presetEngines } from './testing/preset-engines.ts';
import { expectRaysAsShown } from './testing/random-rays.ts';

const readRobot = () => readSplats(readFileSync(capturePath('playbot-lod3.ply')), { shPrecision: 'f32' });

describe.runIf(captures)('a captured robot', () => {
  gpuTest('is drawn as the float64 reference draws it, 256×256', async () => {
    const device = await shareBlendingDevice();
    const engines = await presetEngines(device);
    await expectObjectAccurate(engines, await readRobot());
    for (const engine of Object.values(engines)) engine.destroy();
    device.destroy();
  });

  test('is hit by rays where it is shown', async () => expectRaysAsShown(await readRobot()));
});
