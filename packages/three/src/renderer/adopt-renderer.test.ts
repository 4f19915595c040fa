import { CodeUnavailableError, InvalidArgumentError, SplatEngine } from '@websplatter/core';
import { collectGarbage } from '@websplatter/node/collect-garbage';
import { beforeEach, describe, expect, test, vi } from 'vitest';
import { SplatCloudObject } from '../cloud/splat-cloud-object.ts';
import { SplatsUnsupportedRendererError, ThreeInternalsError } from '../errors.ts';
import { layersAround } from '../layer/splat-layer.ts';
import { fakeEngine } from '../testing/fake-engine.ts';
import { camera, fakeRenderer, scene } from '../testing/fake-renderer.ts';
import { splatDataAt } from '../testing/test-clouds.ts';
import {
  adoptRenderer,
  attachEngine,
  findSplatEngine,
  onDeviceLost,
  setSplatDetail,
  splatDetailOf,
  splatEngineOf,
} from './adopt-renderer.ts';

let create = vi.spyOn(SplatEngine, 'create');

/** Engines that were destroyed. */
const destroyed: object[] = [];

function engineWithEnd() {
  const { engine, lose } = fakeEngine();
  return { engine: Object.assign(engine, { destroy: () => void destroyed.push(engine) }), lose };
}

beforeEach(() => {
  scene.clear();
  destroyed.length = 0;
  create = vi.spyOn(SplatEngine, 'create').mockReset();
  create.mockImplementation(async () => engineWithEnd().engine);
});

/** A WebGPURenderer of three's as far as it is looked at, before it is initialised. */
function foreignRenderer({ device = { limits: {} } as object | undefined, ...parameters } = {}) {
  const backend = { isWebGPUBackend: true, device: null as object | null, parameters };
  const disposed = vi.fn(async () => {});
  const renderer = {
    isWebGPURenderer: true,
    backend,
    init: vi.fn(async () => {
      backend.device = device ?? null;
    }),
    dispose: disposed,
  };
  return { renderer, backend, device, disposed };
}

describe('a renderer that somebody else made', () => {
  test('gets an engine on its own device, which is made once', async () => {
    const { renderer, device } = foreignRenderer();
    expect(findSplatEngine(renderer)).toBeNull();
    expect(() => splatEngineOf(renderer)).toThrow(/still being fetched: await adoptRenderer\(renderer\)/);
    expect(await adoptRenderer(renderer)).toBe(renderer);
    const engine = splatEngineOf(renderer);
    expect(create.mock.calls).toEqual([[expect.objectContaining({ device })]]);
    expect(findSplatEngine(renderer)).toBe(engine);
    expect(await adoptRenderer(renderer)).toBe(renderer);
    expect(create).toHaveBeenCalledTimes(1);
  });

  test('takes options before anything else', async () => {
    const { renderer } = foreignRenderer();
    await adoptRenderer(renderer, { accuracy: 'high', streamBudgetBytes: 7, detail: 'auto' });
    expect(create.mock.lastCall![0]).toMatchObject({ accuracy: 'high', streamBudgetBytes: 7 });
    expect(splatDetailOf(renderer)).toBe('auto');
    setSplatDetail(renderer, 'full');
    expect(splatDetailOf(renderer)).toBe('full');
    const late = adoptRenderer(renderer, { accuracy: 'fast' });
    await expect(late).rejects.toThrow(InvalidArgumentError);
    await expect(late).rejects.toThrow('before anything is loaded for it or drawn with it');
  });

  test('is told the one line that raises its limits', async () => {
    const { renderer } = foreignRenderer();
    await adoptRenderer(renderer);
    const line = 'new WebGPURenderer({ requiredLimits: await splatLimits() })';
    expect(create.mock.lastCall![0]!.limitAdvice).toContain(line);
    const onDevice = foreignRenderer({ parameters: { device: {} } } as never);
    onDevice.backend.parameters = { device: {} } as never;
    await adoptRenderer(onDevice.renderer);
    const ofDevice = 'adapter.requestDevice({ requiredLimits: await splatLimits() })';
    expect(create.mock.lastCall![0]!.limitAdvice).toContain(ofDevice);
  });

  test('ends its engine when it is disposed of, also one that comes later', async () => {
    const { renderer, disposed } = foreignRenderer();
    const engine = splatEngineOf(await adoptRenderer(renderer));
    await renderer.dispose();
    await renderer.dispose();
    expect(disposed).toHaveBeenCalledTimes(1);
    expect(destroyed).toEqual([engine]);
    const { renderer: early } = foreignRenderer();
    const coming = adoptRenderer(early);
    await early.dispose();
    expect(destroyed).toEqual([engine, splatEngineOf(await coming)]);
  });

  test('tells of the loss of its device, not of its disposal', async () => {
    const told = vi.fn();
    for (const isDisposed of [false, true]) {
      const { renderer } = foreignRenderer();
      const { engine, lose } = engineWithEnd();
      create.mockResolvedValueOnce(engine);
      onDeviceLost(renderer, told);
      const stop = onDeviceLost(renderer, () => told('stopped'));
      stop();
      await adoptRenderer(renderer);
      if (isDisposed) await renderer.dispose();
      lose();
      await engine.lost;
    }
    expect(told.mock.calls).toEqual([[undefined]]);
  });

  test('requests a frame when it has its engine, and reports why it gets none', async () => {
    const cloud = new SplatCloudObject(splatDataAt([0, 0, 0]));
    const onError = vi.fn();
    const needsFrame = vi.fn();
    cloud.onError = onError;
    cloud.addEventListener('needsframe', needsFrame);
    scene.add(cloud);
    scene.updateMatrixWorld();
    const [layer] = layersAround(cloud);
    const draw = (renderer: object) => layer.onBeforeRender(renderer, scene, camera);
    const { renderer } = foreignRenderer();
    draw(renderer);
    draw(renderer);
    await expect.poll(() => needsFrame).toHaveBeenCalledTimes(1);
    expect(onError).not.toHaveBeenCalled();
    const failure = new CodeUnavailableError('engine', { cause: new Error('offline') });
    create.mockRejectedValueOnce(failure);
    const { renderer: failing } = foreignRenderer();
    draw(failing);
    await expect.poll(() => onError.mock.calls).toEqual([[failure]]);
    draw(failing);
    expect(() => findSplatEngine(failing)).toThrow(failure);
    expect(onError).toHaveBeenCalledTimes(1);
    await adoptRenderer(failing, { accuracy: 'high' });
    expect(splatEngineOf(failing)).toBeDefined();
  });

  test('tells where its device cannot draw as exactly as is asked', async () => {
    const { renderer: of, fields } = fakeRenderer();
    fields.getMRT = () => null;
    const { engine } = fakeEngine();
    const settings = engine.resolveAccuracy('balanced').settings;
    const notices = ['This device cannot blend rgba32float.'];
    Object.assign(engine, {
      resolveAccuracy: () => ({ settings, notices }),
      createEmbeddedView: () => ({ prepare: () => false, destroy: () => {} }),
    });
    fields.dispose = async () => {};
    attachEngine(of, engine, 'full');
    const cloud = new SplatCloudObject(splatDataAt([0, 0, -1]));
    const errors: string[] = [];
    cloud.onError = (error) => errors.push(`${error.name}: ${error.message}`);
    scene.add(cloud);
    scene.updateMatrixWorld();
    const [layer] = layersAround(cloud);
    for (let frame = 0; frame < 2; frame++) layer.onBeforeRender(of, scene, camera);
    await null;
    expect(errors).toEqual([expect.stringMatching(/^SplatsPrecisionError: .*cannot blend rgba32float/)]);
  });

  test('of another release of three may have no device where it is looked for', async () => {
    const { renderer } = foreignRenderer({ device: undefined });
    const { backend } = renderer;
    renderer.init.mockImplementation(async () => {
      backend.device = null;
    });
    await expect(adoptRenderer(renderer)).rejects.toThrow(ThreeInternalsError);
  });
});

test('a renderer of createSplatRenderer has its engine at once', async () => {
  const { renderer } = foreignRenderer();
  const { engine } = engineWithEnd();
  attachEngine(renderer as never, engine, 'auto');
  expect(splatEngineOf(renderer)).toBe(engine);
  expect(splatDetailOf(renderer)).toBe('auto');
  expect(await adoptRenderer(renderer)).toBe(renderer);
  expect(create).not.toHaveBeenCalled();
});

describe('a renderer that cannot draw splats', () => {
  test('has no engine, and the error says what to write instead', () => {
    const ask = () => splatEngineOf({ isWebGLRenderer: true });
    expect(ask).toThrow(SplatsUnsupportedRendererError);
    expect(ask).toThrow(/createSplatRenderer.*<SplatCanvas>; this is three’s WebGLRenderer/);
    expect(() => splatEngineOf({})).toThrow(/this is an object of the class Object\.$/);
    expect(() => splatEngineOf(Object.create(null))).toThrow(/of the class none/);
    expect(() => onDeviceLost({}, () => {})).toThrow(SplatsUnsupportedRendererError);
  });

  test('is one that draws with WebGL 2, and the error says why', async () => {
    const withWebGl = (parameters: object) => ({ isWebGPURenderer: true, backend: { parameters } });
    expect(() => findSplatEngine(withWebGl({ forceWebGL: true }))).toThrow(
      /WebGL 2, because forceWebGL is set/,
    );
    expect(() => findSplatEngine(withWebGl({}))).toThrow(/there is no WebGPU here, or .* requiredLimits/);
    const { renderer } = foreignRenderer();
    renderer.init.mockImplementation(async () => {
      renderer.backend = withWebGl({}).backend as never;
    });
    await expect(adoptRenderer(renderer)).rejects.toThrow(/requiredLimits/);
    expect(() => findSplatEngine(renderer)).toThrow(SplatsUnsupportedRendererError);
  });

  test('is one on a device of the compatibility mode', async () => {
    create.mockRestore();
    const limits = { maxStorageBuffersInVertexStage: 0 };
    const { renderer } = foreignRenderer({ device: { limits, createBuffer() {}, adapterInfo: {} } });
    const failure = await adoptRenderer(renderer).catch((error) => error);
    expect(failure).toBeInstanceOf(SplatsUnsupportedRendererError);
    expect(failure.message).toMatch(/compatibility mode: maxStorageBuffersInVertexStage is 0/);
  });
});

/** @fault Devices and engines: splats and renderers of three.js come and go while engine and device live on */
test('a renderer leaves memory though its device lives', async () => {
  const { engine } = engineWithEnd();
  const attached = () => {
    const { renderer } = foreignRenderer();
    attachEngine(renderer as never, engine, 'full');
    onDeviceLost(renderer, () => renderer);
    return new WeakRef(renderer);
  };
  const left = attached();
  await collectGarbage();
  expect(left.deref()).toBeUndefined();
  expect(engine.lost).toBeInstanceOf(Promise);
});
