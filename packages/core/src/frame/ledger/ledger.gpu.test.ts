import { gpuTest, shareTestDevice } from '@websplatter/node/gpu-test';
import { beforeAll, describe, expect } from 'vitest';
import { SplatEngine } from '../../create-engine.ts';
import type { Accuracy } from '../../data/accuracy/accuracy.ts';
import { identity4 } from '../../data/math/mat4.ts';
import { EFFECT_LIST } from '../../gpu/effects/effect-list.ts';
import { tint } from '../../gpu/effects/tint/tint.ts';
import { shaderBindings } from '../../gpu/pipelines.ts';
import { linkShader, loadVariant } from '../../gpu/shaders/link-shader.ts';
import { EFFECT_EXAMPLES } from '../../testing/effect-examples.ts';
import { FEATURE_SHADERS } from '../../testing/feature-shaders.ts';
import { randomSplats, splatsOf } from '../../testing/random-splats.ts';
import { TEST_MODELS, testCameras } from '../../testing/test-cameras.ts';
import type { EmbeddedFrameRequest } from '../../views/embedded-view.ts';
import type { SplatView } from '../../views/splat-view.ts';
import { frameStages } from '../frame-passes.ts';
import type { CloudInstance } from '../plan/frame-request.ts';
import { AUTOMATIC_FEATURES } from './automatic-features.ts';

const SIZE = { widthPx: 16, heightPx: 16 };
const SET = randomSplats({ count: 300, seed: 70, shDegree: 1, logScales: [-4, -2] });
const CAMERAS = testCameras(1);

let device: GPUDevice;
let engine: SplatEngine;
let view: SplatView;
beforeAll(async () => {
  device = await shareTestDevice();
  engine = await SplatEngine.create({ device, accuracy: 'high' });
  view = engine.createView();
});

async function ledgerOf(clouds: readonly CloudInstance[], camera = CAMERAS.perspective, accuracy?: Accuracy) {
  view.render({ camera, clouds, accuracy, ...SIZE });
  await view.whenDrawn();
  return Object.fromEntries(view.effects().map((entry) => [entry.name, entry]));
}

describe('the ledger of requested effects', () => {
  gpuTest('is empty before the first frame', async () => {
    const fresh = engine.createView();
    expect(fresh.effects()).toEqual([]);
    fresh.destroy();
  });

  gpuTest('lists all, on for the clouds that request them, with the bytes that they hold', async () => {
    const cloud = engine.add(SET, { name: 'garden' });
    const none = await ledgerOf([{ cloud }]);
    for (const { name } of Object.values(EFFECT_LIST)) {
      const off = { isOn: false, reason: 'no cloud asks for it', clouds: [], bytes: 0 };
      expect(none[name]).toMatchObject(off);
    }
    const all = await ledgerOf([{ cloud, effects: EFFECT_EXAMPLES }]);
    for (const { effect, reason } of EFFECT_EXAMPLES) {
      expect(all[effect.name]).toMatchObject({ isOn: true, reason, clouds: ['garden'] });
      if (effect.parameters) expect(all[effect.name].bytes).toBeGreaterThanOrEqual(effect.parameters.bytes);
    }
    // A bit for each of 300 splats, and the effect's colour and strength.
    expect(all.highlight.bytes).toBe(40 + 16);
    expect(all.tint.stages).toEqual(['project']);
    expect(all.volumes.stages).toEqual(['cull-splats', 'project']);
    cloud.destroy();
  });

  gpuTest('says which cloud has which reason, and which requests change nothing', async () => {
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
    expect(opacity).toMatchObject({ isOn: false, reason: 'its options would change nothing' });
    left.destroy();
    right.destroy();
  });

  gpuTest('of the engine is that of the view that was drawn last', async () => {
    const cloud = engine.add(SET);
    const isTinted = () => engine.effects().find(({ name }) => name === 'tint')!.isOn;
    await ledgerOf([{ cloud, effects: [tint([0, 1, 0])] }]);
    const other = engine.createView();
    other.render({ camera: CAMERAS.inside, clouds: [{ cloud }], ...SIZE });
    expect(isTinted()).toBe(false);
    expect(engine.drawnAccuracy()).toMatchObject({
      settings: other.shape!.accuracy,
      choice: null,
      rasterizer: other.rasterizer.rasterizer,
      rasterizerReason: other.rasterizer.reason,
    });
    other.destroy();
    expect(isTinted()).toBe(true);
    cloud.destroy();
  });
});

describe('the ledger of automatic features', () => {
  const ball = { logScales: [-2, -2, -2], opacityLogit: 3 };
  const examples: readonly (readonly [string, Partial<CloudInstance>, Accuracy])[] = [
    ['unchanged', {}, 'high'],
    [
      'moved, tinted, with degree 0',
      { modelMatrix: TEST_MODELS.moved, effects: [tint([1, 0, 0])], shDegree: 0 },
      'balanced',
    ],
    ['with all effects', { effects: EFFECT_EXAMPLES }, 'high'],
  ];

  for (const [name, instance, accuracy] of examples) {
    for (const camera of ['perspective', 'orthographic'] as const) {
      gpuTest(`${name}, ${camera}: agrees with the frame's shaders on each`, async () => {
        const cloud = engine.add(SET);
        const round = engine.add(splatsOf([ball, ball]));
        const clouds = [{ cloud, ...instance }, { cloud: round }];
        const ledger = await ledgerOf(clouds, CAMERAS[camera], accuracy);
        const stages = frameStages(view.shape!).map((entry) => ('stage' in entry ? entry : entry[0]));
        const texts = await Promise.all(stages.map(async (stage) => linkShader(await loadVariant(stage))));
        for (const effect of AUTOMATIC_FEATURES) {
          const own = FEATURE_SHADERS[effect.name];
          if (own.conditions.length === 0) continue;
          const isLinked = stages.some(({ conditions = {} }) =>
            own.conditions.some((each) => conditions[each]),
          );
          const isBound = texts.some((text) =>
            shaderBindings(text).some((binding) => own.bindings.includes(binding.name)),
          );
          expect(ledger[effect.name].isOn, effect.name).toBe(isLinked);
          if (own.bindings.length > 0) expect(isBound, effect.name).toBe(isLinked);
          expect(ledger[effect.name].reason).toMatch(/^[a-z].*[^.]$/);
        }
        cloud.destroy();
        round.destroy();
      });
    }
  }

  gpuTest('harmonics: the degree evaluated, its reason, and the bytes stored', async () => {
    const cloud = engine.add(SET, { name: 'garden' });
    const harmonics = async (instance: Partial<CloudInstance>) =>
      (await ledgerOf([{ cloud, ...instance }])).harmonics;
    const all = await harmonics({});
    expect(all).toMatchObject({ isOn: true, clouds: ['garden'] });
    expect(all.reason).toMatch(/: the file has degree 1$/);
    const bytes = engine.memory().resources.find(({ label }) => /garden.*(sh|harmonics)/i.test(label))!.bytes;
    expect(all.bytes).toBe(bytes);
    const asked = await harmonics({ shDegree: 0 });
    expect(asked).toMatchObject({ isOn: false, bytes, clouds: [] });
    expect(asked.reason).toBe('it is asked for with degree 0 of the file’s 1');
    cloud.destroy();
  });

  gpuTest('placement: the work of a matrix, without any shader', async () => {
    const cloud = engine.add(SET);
    const placement = async (modelMatrix?: ArrayLike<number>) => {
      const { transform } = await ledgerOf([{ cloud, modelMatrix }]);
      expect(transform).toMatchObject({ stages: [], bytes: 0 });
      return transform.isOn ? transform.reason : null;
    };
    expect(await placement()).toBeNull();
    expect(await placement(TEST_MODELS.identity)).toBeNull();
    const aside = identity4();
    aside[12] = 0.1;
    expect(await placement(aside)).toMatch(/moved/);
    expect(await placement(TEST_MODELS.mirrored)).toMatch(/at its own size/);
    expect(await placement(TEST_MODELS.sheared)).toMatch(/sheared/);
    const twice = identity4().map((value, i) => (i < 15 ? 2 * value : value));
    expect(await placement(twice)).toMatch(/alike/);
    cloud.destroy();
  });

  gpuTest('depth: tested and written only inside of another renderer’s frame', async () => {
    const cloud = engine.add(SET);
    const depth = { mapping: 'projection', compare: 'less-equal' } as const;
    const ledgerWith = async (
      wanted: Pick<EmbeddedFrameRequest, 'depth' | 'hasOccluders' | 'writesDepth'>,
    ) => {
      const embedded = engine.createEmbeddedView();
      const ready = new Promise<void>((resolve) => {
        embedded.onReady = resolve;
      });
      const frame = { camera: CAMERAS.perspective, clouds: [{ cloud }], ...SIZE, ...wanted };
      if (!embedded.prepare(frame)) {
        await ready;
        expect(embedded.prepare(frame)).toBe(true);
      }
      const [color, tested] = (['rgba16float', 'depth32float'] as const).map((format) =>
        device.createTexture({
          size: [SIZE.widthPx, SIZE.heightPx],
          format,
          usage: GPUTextureUsage.TEXTURE_BINDING | GPUTextureUsage.RENDER_ATTACHMENT,
        }),
      );
      const encoder = device.createCommandEncoder();
      embedded.draw(encoder, { color, depth: tested, xPx: 0, yPx: 0 });
      device.queue.submit([encoder.finish()]);
      const ledger = engine.effects().filter(({ name }) => /^depth-(test|write)$/.test(name));
      embedded.destroy();
      return ledger.map(({ name, isOn, bytes }) => ({ name, isOn, bytes }));
    };
    const pixels = SIZE.widthPx * SIZE.heightPx;
    const blended = device.features.has('float32-blendable' as GPUFeatureName) ? 4 : 2;
    expect(await ledgerWith({})).toEqual([
      { name: 'depth-test', isOn: false, bytes: 0 },
      { name: 'depth-write', isOn: false, bytes: 0 },
    ]);
    expect(await ledgerWith({ depth })).toEqual([
      { name: 'depth-test', isOn: true, bytes: 16 + 4 * pixels },
      { name: 'depth-write', isOn: false, bytes: 0 },
    ]);
    expect(await ledgerWith({ depth, writesDepth: true })).toEqual([
      { name: 'depth-test', isOn: true, bytes: 16 + 4 * pixels },
      { name: 'depth-write', isOn: true, bytes: (blended + 4) * pixels },
    ]);
    expect(await ledgerWith({ depth, hasOccluders: false, writesDepth: true })).toEqual([
      { name: 'depth-test', isOn: false, bytes: 0 },
      { name: 'depth-write', isOn: true, bytes: 16 + (blended + 4) * pixels },
    ]);
    cloud.destroy();
  });
});
