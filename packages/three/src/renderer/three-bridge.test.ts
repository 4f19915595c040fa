import { Object3D } from 'three/webgpu';
import { afterAll, beforeAll, describe, expect, test, vi } from 'vitest';
import { ThreeInternalsError } from '../errors.ts';
import { camera, drawn, fakeRenderer, gpuTexture, scene } from '../testing/fake-renderer.ts';
import { hasWebGpuBackend, openPass } from './three-bridge.ts';

const open = (fake: ReturnType<typeof fakeRenderer>) => openPass(fake.renderer, scene, camera, drawn)!;

describe('the open pass', () => {
  test('has the target and viewport that three draws into', () => {
    const fake = fakeRenderer();
    expect(open(fake)).toMatchObject({
      target: fake.target,
      parts: [{ camera, widthPx: 100, heightPx: 80, host: { xPx: 0, yPx: 0 } }],
    });
    fake.context.viewport = true;
    expect(open(fake)).toMatchObject({ parts: [{ widthPx: 30, heightPx: 40, host: { xPx: 10, yPx: 20 } }] });
  });

  test('of a canvas has the canvas as its target, whatever three draws into first', () => {
    const fake = fakeRenderer();
    fake.context.renderTarget = { isPostProcessingRenderTarget: true };
    expect(open(fake).target).toBe(fake.canvasTarget);
    fake.context.renderTarget = null;
    expect(open(fake).target).toBe(fake.canvasTarget);
    const output = {};
    fake.fields.getOutputRenderTarget = () => output;
    expect(open(fake).target).toBe(output);
  });
});

describe('writesColor', () => {
  const COPY_DST = 2;
  beforeAll(() => void vi.stubGlobal('GPUTextureUsage', { COPY_DST }));
  afterAll(() => vi.unstubAllGlobals());

  function writesColor(
    change: (fake: ReturnType<typeof fakeRenderer>) => void = () => {},
  ): boolean | undefined {
    const fake = fakeRenderer();
    const texture = { ...gpuTexture('color'), format: 'rgba16float', usage: COPY_DST };
    fake.kept.set(fake.colorTexture, { texture });
    fake.data.descriptor = { colorAttachments: [{ storeOp: 'store' }] };
    change(fake);
    return open(fake).parts[0].host.writesColor;
  }

  test('is true if the image alone decides the pixels', () => {
    expect(writesColor()).toBe(true);
  });

  test('is false if samples are resolved over it, or draws also write elsewhere or not everywhere', () => {
    const attachment = { storeOp: 'store' };
    const withColors = (...colorAttachments: object[]) =>
      writesColor(({ data }) => Object.assign(data, { descriptor: { colorAttachments } }));
    expect(withColors({ ...attachment, resolveTarget: {} })).toBe(false);
    expect(withColors(attachment, attachment)).toBe(false);
    expect(writesColor(({ context }) => Object.assign(context, { scissor: true }))).toBe(false);
  });

  test('is false for textures of other formats, which cannot be copied to, and for the canvas', () => {
    const withTexture = (fields: object) =>
      writesColor(({ kept, colorTexture }) =>
        kept.set(colorTexture, { texture: { ...gpuTexture('color'), ...fields } }),
      );
    expect(withTexture({ format: 'rgba8unorm', usage: COPY_DST })).toBe(false);
    expect(withTexture({ format: 'rgba16float', usage: 16 })).toBe(false);
    expect(writesColor(({ context }) => Object.assign(context, { textures: null }))).toBe(false);
  });
});

describe('hasOccluders', () => {
  const writing = { object: new Object3D(), material: { depthWrite: true } };
  const sky = { object: new Object3D(), material: { depthWrite: false } };

  function hasOccluders(change: (fake: ReturnType<typeof fakeRenderer>) => void): boolean {
    const fake = fakeRenderer();
    change(fake);
    return open(fake).hasOccluders;
  }

  test('is true if an object before the splats writes depth', () => {
    expect(hasOccluders(() => {})).toBe(false);
    expect(hasOccluders(({ list }) => list.opaque.push(sky))).toBe(false);
    expect(hasOccluders(({ list }) => list.transparent.push(writing))).toBe(false);
    expect(hasOccluders(({ list }) => list.transparent.unshift(sky))).toBe(false);
    expect(hasOccluders(({ list }) => list.opaque.push(sky, writing))).toBe(true);
    expect(hasOccluders(({ list }) => list.transparent.unshift(writing))).toBe(true);
    expect(hasOccluders(({ list }) => list.transparentDoublePass.push(writing))).toBe(true);
    expect(hasOccluders(({ list }) => list.bundles.push({}))).toBe(true);
  });

  test('is true if depth is not cleared, and after an interruption', () => {
    const loaded = { colorAttachments: [], depthStencilAttachment: { depthLoadOp: 'load' } };
    expect(hasOccluders(({ data }) => Object.assign(data, { descriptor: loaded }))).toBe(true);
    expect(hasOccluders((fake) => open(fake).interrupt(() => {}))).toBe(true);
  });

  test('is true if three’s list is not the one that is drawn, or missing', () => {
    expect(hasOccluders(({ list }) => list.transparent.pop())).toBe(true);
    expect(hasOccluders(({ fields }) => Object.assign(fields, { lighting: {} }))).toBe(true);
    expect(hasOccluders(({ fields }) => delete fields._renderLists)).toBe(true);
  });
});

describe('an interruption', () => {
  test('restores the state that three expects', () => {
    const fake = fakeRenderer();
    Object.assign(fake.context, { viewport: true, scissor: true, stencil: true });
    Object.assign(fake.data, {
      currentStencilRef: 5,
      currentBlendColor: { r: 0.1, g: 0.2, b: 0.3 },
      currentBlendAlpha: 0.4,
    });
    open(fake).interrupt(() => {});
    expect(fake.calls.slice(2)).toEqual([
      ['setViewport', 10, 20, 30, 40, 0, 1],
      ['setScissorRect', 1, 2, 3, 4],
      ['setStencilReference', 5],
      ['setBlendConstant', { r: 0.1, g: 0.2, b: 0.3, a: 0.4 }],
    ]);
    const [, resumed] = fake.calls[1] as [string, GPURenderPassDescriptor];
    expect(resumed.depthStencilAttachment).toMatchObject({ depthLoadOp: 'load', stencilLoadOp: 'load' });
  });

  test('first draws the bundles that three keeps for the end, and closes an occlusion query', () => {
    const fake = fakeRenderer();
    fake.data.renderBundles = ['bundle'];
    const queries = { lastOcclusionObject: { occlusionTest: true }, occlusionQueryIndex: 3 };
    fake.context.occlusionQueryCount = 4;
    fake.backend.getOcclusionData = () => queries;
    open(fake).interrupt(() => {});
    expect(fake.calls.map(([name]) => name)).toEqual([
      'executeBundles',
      'endOcclusionQuery',
      'end',
      'beginRenderPass',
    ]);
    expect(fake.data.renderBundles).toEqual([]);
    expect(queries).toEqual({ lastOcclusionObject: null, occlusionQueryIndex: 4 });
  });

  test('finds occlusion queries where 0.185 has them', () => {
    const fake = fakeRenderer();
    fake.context.occlusionQueryCount = 1;
    Object.assign(fake.data, { lastOcclusionObject: { occlusionTest: true }, occlusionQueryIndex: 0 });
    open(fake).interrupt(() => {});
    expect(fake.data).toMatchObject({ lastOcclusionObject: null, occlusionQueryIndex: 1 });
  });

  test('counts the time in between as the pass’s', () => {
    const fake = fakeRenderer();
    const timestampWrites = { querySet: 'set', beginningOfPassWriteIndex: 6, endOfPassWriteIndex: 7 };
    Object.assign(fake.data.descriptor as object, { timestampWrites });
    open(fake).interrupt(() => {});
    expect(fake.calls[1][1]).toMatchObject({ timestampWrites: { querySet: 'set', endOfPassWriteIndex: 7 } });
    expect(fake.calls[1][1]).not.toHaveProperty('timestampWrites.beginningOfPassWriteIndex');
  });

  test('continues the pass if recording fails', () => {
    const fake = fakeRenderer();
    const fail = () => {
      throw new Error('no memory');
    };
    expect(() => open(fake).interrupt(fail)).toThrow('no memory');
    expect(fake.data.currentPass).toBe(fake.newPass);
  });

  test.each([
    ['samples that are not kept', 'lost-samples', { storeOp: 'discard' }, {}],
    ['samples that are not resolved', 'unresolved-samples', {}, { msaaTexture: {} }],
    ['slices', 'part-of-texture', {}, { texture: { dimension: '3d' } }],
  ])('is refused, with the pass untouched, for %s', (_, reason, attachment, textureData) => {
    const fake = fakeRenderer();
    const { colorAttachments } = fake.data.descriptor as { colorAttachments: object[] };
    Object.assign(colorAttachments[1], attachment);
    fake.kept.set(fake.colorTexture, { texture: gpuTexture('color'), ...textureData });
    expect(() => open(fake).interrupt(() => {})).toThrow(expect.objectContaining({ reason }));
    expect(fake.calls).toEqual([]);
    expect(fake.data.currentPass).toBe(fake.oldPass);
  });

  test('is refused for a mip level', () => {
    const fake = fakeRenderer();
    fake.context.activeMipmapLevel = 1;
    expect(() => open(fake).interrupt(() => {})).toThrow(
      expect.objectContaining({ reason: 'part-of-texture' }),
    );
  });
});

describe('an error names the property that a changed three lacks', () => {
  type Fake = ReturnType<typeof fakeRenderer>;
  const removals: [missing: string, part: (fake: Fake) => Record<string, unknown>, name: string][] = [
    ['renderer._currentRenderContext', ({ fields }) => fields, '_currentRenderContext'],
    ['renderer._compilationPromises', ({ fields }) => fields, '_compilationPromises'],
    ['renderer.backend', ({ fields }) => fields, 'backend'],
    ['renderer.getCanvasTarget', ({ fields }) => fields, 'getCanvasTarget'],
    ['renderer.backend.get', ({ backend }) => backend, 'get'],
    ['renderer.backend.textureUtils', ({ backend }) => backend, 'textureUtils'],
    ['backend.get(context).encoder', ({ data }) => data, 'encoder'],
    ['backend.get(context).descriptor', ({ data }) => data, 'descriptor'],
    ['backend.get(context).currentSets', ({ data }) => data, 'currentSets'],
    ['backend.get(context).renderBundles', ({ data }) => data, 'renderBundles'],
    ['context.viewportValue', ({ context }) => context, 'viewportValue'],
    ['context.scissor', ({ context }) => context, 'scissor'],
    ['context.occlusionQueryCount', ({ context }) => context, 'occlusionQueryCount'],
  ];

  test.each(removals)('%s', (missing, part, name) => {
    const fake = fakeRenderer();
    delete part(fake)[name];
    let error: unknown;
    try {
      openPass(fake.renderer, scene, camera, drawn);
    } catch (thrown) {
      error = thrown;
    }
    expect(error).toBeInstanceOf(ThreeInternalsError);
    const { message, code } = error as ThreeInternalsError;
    expect(code).toBe('three-internals');
    expect(message).toContain(missing);
    expect(message).toMatch(/^three r187 .*0\.185 to 0\.187/);
  });

  test('a texture without its GPU texture', () => {
    const fake = fakeRenderer();
    fake.kept.set(fake.colorTexture, {});
    expect(() => open(fake).interrupt(() => {})).toThrow(ThreeInternalsError);
  });
});

test('hasWebGpuBackend distinguishes backends', () => {
  expect(hasWebGpuBackend({ backend: { isWebGPUBackend: true } })).toBe(true);
  expect(hasWebGpuBackend({ backend: { isWebGLBackend: true } })).toBe(false);
  expect(hasWebGpuBackend({})).toBe(false);
});
