import { createTestDevice, gpuTest } from '@websplatter/node/gpu-test';
import { afterAll, beforeAll, describe, expect } from 'vitest';
import { SplatEngine } from '../engine.ts';
import type { CloudInstance } from '../scene/view-frame.ts';
import { EFFECT_EXAMPLES } from '../testing/effect-examples.ts';
import { randomSplats } from '../testing/random-splats.ts';
import { testCameras } from '../testing/test-cameras.ts';
import type { SplatView } from '../view.ts';
import { CLOUD_EFFECTS } from './effects.ts';
import { tint } from './tint.ts';

const SIZE = { widthPx: 16, heightPx: 16 };
const SET = randomSplats({ count: 300, seed: 70, shDegree: 1, logScales: [-4, -2] });
const CAMERAS = testCameras(1);

let device: GPUDevice;
let engine: SplatEngine;
let view: SplatView;
beforeAll(async () => {
  device = await createTestDevice();
  engine = await SplatEngine.create({ device, accuracy: 'high' });
  view = engine.createView();
});
afterAll(() => {
  engine?.destroy();
  device?.destroy();
});

async function ledgerOf(clouds: readonly CloudInstance[], camera = CAMERAS.perspective) {
  view.render({ camera, clouds, ...SIZE });
  await view.whenDrawn();
  return Object.fromEntries(view.effects().map((entry) => [entry.name, entry]));
}

describe('the ledger, of effects that callers ask for', () => {
  gpuTest('has nothing before the first picture', async () => {
    const fresh = engine.createView();
    expect(fresh.effects()).toEqual([]);
    fresh.destroy();
  });

  gpuTest('lists all, on where a cloud calls for them, with what they hold', async () => {
    const cloud = engine.add(SET, { name: 'garden' });
    const none = await ledgerOf([{ cloud }]);
    for (const { name } of CLOUD_EFFECTS) {
      const off = { isOn: false, reason: 'no cloud asks for it', clouds: [], bytes: 0 };
      expect(none[name]).toMatchObject(off);
    }
    const all = await ledgerOf([{ cloud, effects: EFFECT_EXAMPLES }]);
    for (const { effect, reason } of EFFECT_EXAMPLES) {
      expect(all[effect.name]).toMatchObject({ isOn: true, reason, clouds: ['garden'] });
      if (effect.parameters) expect(all[effect.name].bytes).toBeGreaterThanOrEqual(effect.parameters.bytes);
    }
    // A bit for each of 300 splats, and its colour and strength.
    expect(all.highlight.bytes).toBe(40 + 16);
    expect(all.tint.stages).toEqual(['project']);
    expect(all.clip.stages).toEqual(['cull-splats', 'project']);
    cloud.destroy();
  });

  gpuTest('says which cloud has which reason, and what is asked for in vain', async () => {
    const left = engine.add(SET, { name: 'left' });
    const right = engine.add(SET, { name: 'right' });
    const { tint: entry, opacity } = await ledgerOf([
      { cloud: left, effects: [tint([1, 0.5, 0.5])], opacity: 1 },
      { cloud: right, effects: [tint([0.5, 1, 1])] },
    ]);
    expect(entry.clouds).toEqual(['left', 'right']);
    expect(entry.reason).toBe(
      'left: colours are multiplied by 1, 0.5, 0.5; right: colours are multiplied by 0.5, 1, 1',
    );
    expect(opacity).toMatchObject({ isOn: false, reason: 'as it is asked for it would change nothing' });
    left.destroy();
    right.destroy();
  });

  gpuTest('is the engine’s of the view that was drawn last', async () => {
    const cloud = engine.add(SET);
    const isTinted = () => engine.effects().find(({ name }) => name === 'tint')!.isOn;
    await ledgerOf([{ cloud, effects: [tint([0, 1, 0])] }]);
    const other = engine.createView();
    other.render({ camera: CAMERAS.inside, clouds: [{ cloud }], ...SIZE });
    expect(isTinted()).toBe(false);
    other.destroy();
    expect(isTinted()).toBe(true);
    cloud.destroy();
  });
});
