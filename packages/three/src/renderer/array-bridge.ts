// three's internals for passes of several cameras; loaded when an ArrayCamera draws splats.
import type { HostPass } from '@websplatter/core';
import type { ArrayCamera, Camera, Object3D, Scene, Vector4, WebGPURenderer } from 'three/webgpu';
import {
  type Backend,
  type OpenPass,
  openPass,
  PassRefusal,
  probe,
  type RenderContext,
  type RenderContextData,
  type RendererInternals,
  type TextureData,
} from './three-bridge.ts';

/** The backend's data about a pass with a layer of its target for each camera. */
interface LayersData extends RenderContextData {
  /** Draws so far, in stages, each with a copy of every layer after it; since 0.187. */
  readonly arrayCameraRenderStages?: {
    readonly bundles: readonly GPURenderBundle[];
    readonly framebufferCopy: undefined;
  }[];
}

interface LayersBackend extends Backend {
  _finishArrayCameraBundleEncoders(data: LayersData): GPURenderBundle[];
  _createArrayCameraBundleEncoders(context: RenderContext, data: LayersData): void;
}

/** The backend's data about a texture with layers. */
interface LayeredTextureData extends TextureData {
  /** For the images of an XR session. */
  readonly xrViewDescriptors?: readonly GPUTextureViewDescriptor[] | null;
}

/** A shader's limit on textures: the layer's material has one for each camera. */
export const MOST_CAMERAS = 16;

/**
 * As `openPass`, for the cameras of `camera`: each has a viewport of the target or, in XR, a layer.
 *
 * @param onError called with errors thrown while layers are recorded: three would abandon its
 *   frame.
 */
export function openArrayPass(
  renderer: WebGPURenderer,
  scene: Scene,
  camera: ArrayCamera,
  drawn: Object3D,
  onError: (error: unknown) => void,
): OpenPass | null {
  const opened = openPass(renderer, scene, camera, drawn);
  if (!opened) return null;
  const [part] = opened.parts;
  // Viewports may overlap, and layers are drawn later: the draw of each camera shows its image.
  const pass = { ...opened, parts: [{ ...part, host: { ...part.host, writesColor: false } }] };
  if (camera.cameras.length > MOST_CAMERAS) throw new PassRefusal('many-cameras');
  const internals = renderer as unknown as RendererInternals;
  const context = internals._currentRenderContext!;
  const data: LayersData = internals.backend.get(context) as RenderContextData;
  return data.bundleEncoders
    ? withLayers(pass, camera.cameras, internals.backend, context, data, onError)
    : withViewports(pass, camera.cameras, ratioOf(renderer, context));
}

/** Pixels per unit of a camera's viewport, as three takes it. */
function ratioOf(renderer: WebGPURenderer, { renderTarget }: RenderContext): number {
  const isCanvas = renderTarget === null || renderTarget.isPostProcessingRenderTarget === true;
  return isCanvas ? renderer.getPixelRatio() : 1;
}

/** Makes parts of `pass` side by side in one layer. All are recorded in one interruption. */
function withViewports(pass: OpenPass, cameras: readonly Camera[], ratio: number): OpenPass {
  const [whole] = pass.parts;
  const px = (value: number) => Math.floor(value * ratio);
  const parts = cameras.map((camera) => {
    // three has cameras of an array draw into their viewports, which their type does not have.
    const { viewport } = camera as Camera & { viewport?: Vector4 };
    if (!viewport) return { ...whole, camera };
    return {
      camera,
      widthPx: px(viewport.width),
      heightPx: px(viewport.height),
      host: { ...whole.host, xPx: px(viewport.x), yPx: px(viewport.y) },
    };
  });
  return {
    ...pass,
    parts,
    interrupt: (record) =>
      pass.interrupt((_, encoder) => {
        for (let part = 0; part < parts.length; part++) record(part, encoder);
      }),
  };
}

/**
 * Makes parts of `pass` with a layer each. three only notes draws, and makes a layer's passes at
 * the end of its render.
 */
function withLayers(
  pass: OpenPass,
  cameras: readonly Camera[],
  backend: Backend,
  context: RenderContext,
  data: LayersData,
  onError: (error: unknown) => void,
): OpenPass {
  const { arrayCameraRenderStages: stages } = data;
  if (!stages) throw new PassRefusal('layers-at-once');
  const layers = backend as LayersBackend;
  // The prototype: each object is probed once, and `openPass` has probed the backend itself.
  probe(Object.getPrototypeOf(layers), 'renderer.backend', {
    function: ['_finishArrayCameraBundleEncoders', '_createArrayCameraBundleEncoders'],
  });
  const [whole] = pass.parts;
  const parts = cameras.map((camera, i) => ({
    ...whole,
    camera,
    host: { ...whole.host, ...layerOf(i, backend, context) },
  }));
  return {
    ...pass,
    hasOccluders: pass.hasOccluders || stages.length > 0,
    parts,
    interrupt: (record) => {
      for (let part = 0; part < parts.length; part++) record(part, null);
      let layer = 0;
      stages.push({
        bundles: layers._finishArrayCameraBundleEncoders(data),
        // three reads this between two passes of each layer: record there instead of copying.
        get framebufferCopy() {
          try {
            record(layer++, data.encoder);
          } catch (error) {
            onError(error);
          }
          return undefined;
        },
      });
      layers._createArrayCameraBundleEncoders(context, data);
    },
  };
}

/** Returns the textures of a camera, and its layer of them. */
function layerOf(
  index: number,
  backend: Backend,
  { textures, depthTexture }: RenderContext,
): Pick<HostPass, 'color' | 'depth' | 'layer'> {
  const { texture, xrViewDescriptors } = backend.get(textures![0]) as LayeredTextureData;
  const { TEXTURE_BINDING, COPY_SRC } = GPUTextureUsage;
  if (!texture || !(texture.usage & (TEXTURE_BINDING | COPY_SRC)))
    throw new PassRefusal('unreadable-texture');
  const depth = depthTexture && (backend.get(depthTexture) as TextureData);
  return {
    color: texture,
    depth: depth?.msaaTextures?.[index] ?? depth?.texture ?? null,
    layer: xrViewDescriptors?.[index]?.baseArrayLayer ?? index,
  };
}
