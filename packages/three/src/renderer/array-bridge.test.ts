import { ArrayCamera, PerspectiveCamera, Vector4 } from 'three/webgpu';
import { afterEach, describe, expect, test, vi } from 'vitest';
import { drawn, fakeRenderer, gpuTexture, scene } from '../testing/fake-renderer.ts';
import { openArrayPass } from './array-bridge.ts';

afterEach(() => {
  vi.unstubAllGlobals();
});

/** An array of cameras with viewports side by side, 10.5 units wide. */
function cameras(count = 2): ArrayCamera {
  return new ArrayCamera(
    Array.from({ length: count }, (_, i) =>
      Object.assign(new PerspectiveCamera(), { viewport: new Vector4(10.5 * i, 3, 10.5, 20) }),
    ),
  );
}

const openFor = (
  fake: ReturnType<typeof fakeRenderer>,
  array: ArrayCamera,
  onError: (error: unknown) => void = () => {},
) => openArrayPass(fake.renderer, scene, array, drawn, onError)!;

describe('a pass of several cameras with viewports', () => {
  test('has a part for each, in whole pixels of a render target', () => {
    const fake = fakeRenderer();
    fake.fields.getPixelRatio = () => 2;
    const array = cameras();
    expect(openFor(fake, array).parts).toMatchObject([
      { camera: array.cameras[0], widthPx: 10, heightPx: 20, host: { xPx: 0, yPx: 3, layer: 0 } },
      { camera: array.cameras[1], widthPx: 10, heightPx: 20, host: { xPx: 10, yPx: 3, layer: 0 } },
    ]);
  });

  test('on a canvas takes viewports in units of its pixel ratio', () => {
    const fake = fakeRenderer();
    fake.fields.getPixelRatio = () => 2;
    fake.context.renderTarget = { isPostProcessingRenderTarget: true };
    const [, right] = openFor(fake, cameras()).parts;
    expect(right).toMatchObject({ widthPx: 21, heightPx: 40, host: { xPx: 21, yPx: 6 } });
  });

  test('gives a camera without a viewport the whole of it', () => {
    const [part] = openFor(fakeRenderer(), new ArrayCamera([new PerspectiveCamera()])).parts;
    expect(part).toMatchObject({ widthPx: 100, heightPx: 80, host: { xPx: 0, yPx: 0 } });
  });

  test('is refused for more cameras than a shader can read images', () => {
    const fake = fakeRenderer();
    expect(openFor(fake, cameras(16)).parts).toHaveLength(16);
    expect(() => openFor(fake, cameras(17))).toThrow(expect.objectContaining({ reason: 'many-cameras' }));
  });
});

describe('a pass of several cameras with layers', () => {
  /** The backend in the middle of a pass that it makes later, layer by layer. */
  function fakeLayers() {
    const fake = fakeRenderer();
    const stages: { bundles: unknown; readonly framebufferCopy: undefined }[] = [];
    fake.data.currentPass = null;
    fake.data.bundleEncoders = [{}, {}];
    fake.data.arrayCameraRenderStages = stages;
    const color = { ...gpuTexture('color'), usage: 1, depthOrArrayLayers: 2 };
    fake.context.textures = [fake.colorTexture];
    fake.kept.set(fake.colorTexture, { texture: color });
    Object.setPrototypeOf(fake.backend, {
      _finishArrayCameraBundleEncoders: () => ['bundle 0', 'bundle 1'],
      _createArrayCameraBundleEncoders: () => void fake.calls.push(['create encoders']),
    });
    vi.stubGlobal('GPUTextureUsage', { COPY_SRC: 1, TEXTURE_BINDING: 4 });
    return { ...fake, stages, color };
  }

  test('reads the samples of each layer’s own depth, and the layers that an XR session names', () => {
    const fake = fakeLayers();
    const msaaTextures = [gpuTexture('first'), gpuTexture('second')];
    fake.kept.set(fake.context.depthTexture, { texture: gpuTexture('depth'), msaaTextures });
    const xrViewDescriptors = [{ baseArrayLayer: 1 }, { baseArrayLayer: 0 }];
    fake.kept.set(fake.colorTexture, { texture: fake.color, xrViewDescriptors });
    const hosts = openFor(fake, cameras()).parts.map(({ host }) => host);
    expect(hosts.map(({ depth, layer }) => [depth?.label, layer])).toEqual([
      ['first', 1],
      ['second', 0],
    ]);
  });

  test('tells what fails later, and lets three go on', () => {
    const fake = fakeLayers();
    const onError = vi.fn();
    openFor(fake, cameras(), onError).interrupt((_, encoder) => {
      if (encoder) throw new Error('no memory');
    });
    expect(fake.stages[0].framebufferCopy).toBeUndefined();
    expect(onError).toHaveBeenCalledWith(new Error('no memory'));
  });

  test('may have something hidden once it was interrupted', () => {
    const fake = fakeLayers();
    Object.assign(fake.fields, { _renderLists: { get: () => fake.list } });
    expect(openFor(fake, cameras()).hasOccluders).toBe(false);
    openFor(fake, cameras()).interrupt(() => {});
    expect(openFor(fake, cameras()).hasOccluders).toBe(true);
  });

  test('is refused where three cannot be interrupted, or its images cannot be read', () => {
    const older = fakeLayers();
    delete older.data.arrayCameraRenderStages;
    expect(() => openFor(older, cameras())).toThrow(expect.objectContaining({ reason: 'layers-at-once' }));
    const unreadable = fakeLayers();
    Object.assign(unreadable.color, { usage: 16 });
    expect(() => openFor(unreadable, cameras())).toThrow(
      expect.objectContaining({ reason: 'unreadable-texture' }),
    );
  });
});
