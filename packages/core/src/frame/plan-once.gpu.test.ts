import { gpuTest, shareTestDevice } from '@websplatter/node/gpu-test';
import { beforeAll, beforeEach, describe, expect, vi } from 'vitest';
import { SplatEngine } from '../create-engine.ts';
import { perspectiveCamera } from '../data/camera/camera.ts';
import { identity4 } from '../data/math/mat4.ts';
import { defineEffect, fog, tint } from '../gpu/effects/index.ts';
import { FIXED_RASTERIZER } from '../testing/fixed-rasterizer.ts';
import { randomSplats } from '../testing/random-splats.ts';

/** Number of calls of the functions that plan a cloud, by name. */
const calls: Record<string, number> = {};

function counted<Module extends object>(module: Module, name: keyof Module & string): Module {
  const original = module[name] as (...args: unknown[]) => unknown;
  const wrapped = (...args: unknown[]) => {
    calls[name] = (calls[name] ?? 0) + 1;
    return original(...args);
  };
  return { ...module, [name]: wrapped };
}

vi.mock('../gpu/effects/cloud-effects.ts', async (original) =>
  counted(await original<typeof import('../gpu/effects/cloud-effects.ts')>(), 'cloudEffects'),
);
vi.mock('../data/camera/cloud-view.ts', async (original) =>
  counted(await original<typeof import('../data/camera/cloud-view.ts')>(), 'cloudView'),
);
vi.mock('../data/camera/frustum.ts', async (original) =>
  counted(await original<typeof import('../data/camera/frustum.ts')>(), 'frustumSides'),
);

/** A caller's effect that counts the calls of its functions. */
const glow = defineEffect<number, { by: 'f32' }>({
  name: 'test-glow',
  label: 'Glow',
  about: 'Adds to all colours.',
  hooks: { color: 'glowColor' },
  wgsl:
    'import parameters::TestGlow;\n' +
    'fn glowColor(color: vec3f, splat: Splat, splatIndex: u32, centerView: vec3f, glow: TestGlow) -> vec3f {\n' +
    '  return color + glow.by;\n}\nimport package::lib::packing::Splat;',
  fields: { by: 'f32' },
  calledFor: () => {
    calls.calledFor = (calls.calledFor ?? 0) + 1;
    return 'it was asked for';
  },
  valuesAt: (by) => {
    calls.valuesAt = (calls.valuesAt ?? 0) + 1;
    return { by };
  },
});

const SIZE = { widthPx: 32, heightPx: 32 };
const CLOUDS = 3;
const ONCE_EACH = {
  cloudEffects: CLOUDS,
  cloudView: CLOUDS,
  frustumSides: CLOUDS,
  calledFor: CLOUDS,
  valuesAt: CLOUDS,
};

let device: GPUDevice;
let engine: SplatEngine;

beforeAll(async () => {
  device = await shareTestDevice();
  // How a frame is planned does not depend on the rasteriser: one has fewer shaders to compile.
  engine = await SplatEngine.create({ device, accuracy: FIXED_RASTERIZER });
});
beforeEach(() => {
  for (const name of Object.keys(calls)) delete calls[name];
});

function request(z: number, effects = [glow(0.1)]) {
  return {
    ...SIZE,
    camera: perspectiveCamera({ position: [0, 0, z], target: [0, 0, 0], fovYDegrees: 50, aspect: 1 }),
    clouds: clouds.map((cloud, i) => {
      const modelMatrix = identity4();
      modelMatrix[12] = i / 4;
      return { cloud, modelMatrix, opacity: 0.5, effects };
    }),
  };
}

let clouds: ReturnType<SplatEngine['add']>[] = [];
beforeAll(() => {
  clouds = Array.from({ length: CLOUDS }, (_, i) =>
    engine.add(randomSplats({ count: 200, seed: 90 + i, shDegree: 1 })),
  );
});

/** Counts the calls of those functions that `draw` makes. */
function callsOf(draw: () => void): Record<string, number> {
  for (const name of Object.keys(calls)) delete calls[name];
  draw();
  return { ...calls };
}

describe('a frame is planned once: uses of effects, view and frustum of each cloud are worked out once', () => {
  gpuTest('by a view, whatever has changed since the last frame', async () => {
    const view = engine.createView();
    view.render(request(3));
    await view.whenDrawn();
    expect(callsOf(() => view.render(request(4)))).toEqual(ONCE_EACH);
    // Nothing has changed; then only colours, then the size.
    expect(callsOf(() => view.render(request(4)))).toEqual(ONCE_EACH);
    expect(callsOf(() => view.render(request(4, [glow(0.2)])))).toEqual(ONCE_EACH);
    expect(callsOf(() => view.render({ ...request(4), widthPx: 40 }))).toEqual(ONCE_EACH);
    // A forced frame keeps no colours, unlike the ones before: its shaders must be compiled first.
    view.render({ ...request(4), force: true });
    await view.whenDrawn();
    expect(callsOf(() => view.render({ ...request(4), force: true }))).toEqual(ONCE_EACH);
    expect(callsOf(() => view.effects())).not.toHaveProperty('cloudEffects');
    view.destroy();
  });

  gpuTest('by a view inside another renderer’s frame', async () => {
    const view = engine.createEmbeddedView();
    for (;;) {
      const ready = new Promise<void>((resolve) => {
        view.onReady = resolve;
      });
      if (view.prepare(request(3))) break;
      await ready;
    }
    expect(callsOf(() => view.prepare(request(4)))).toEqual(ONCE_EACH);
    expect(callsOf(() => view.prepare(request(4)))).toEqual(ONCE_EACH);
    view.destroy();
  });

  gpuTest('twice at most while shaders compile and the last effects are drawn in their place', async () => {
    const view = engine.createView();
    view.render(request(3));
    await view.whenDrawn();
    const fogged = [glow(0.1), fog({ color: [0, 0, 0], near: 1, far: 9 }), tint([1, 0.5, 0.5])];
    const asked = callsOf(() => view.render(request(5, fogged)));
    expect(asked.cloudView).toBe(2 * CLOUDS);
    expect(asked.cloudEffects).toBe(2 * CLOUDS);
    await view.whenDrawn();
    view.destroy();
  });
});
