// All knowledge of three's internals is in this file and, for several cameras, outputs, shadow maps,
// events and storage buffers, in array-bridge.ts, layer-outputs.ts, scene-shadows.ts, dispatch.ts and
// make-gpu-splats.ts: three has no public way to draw with WebGPU in the middle of its own pass. The
// properties used here have kept their names from 0.170 to 0.187; each is checked before it is used.
import type { DepthConvention, HostPass } from '@websplatter/core';
import { type Camera, type Object3D, REVISION, type Scene, type WebGPURenderer } from 'three/webgpu';
import { ThreeInternalsError } from '../errors.ts';

/** Why a pass cannot be interrupted. */
export type RefusalReason =
  | 'many-cameras'
  | 'layers-at-once'
  | 'unreadable-texture'
  | 'lost-samples'
  | 'unresolved-samples'
  | 'part-of-texture';

/** Thrown for a pass that cannot be interrupted; pass-errors.ts, loaded later, has the words. */
export class PassRefusal {
  readonly reason: RefusalReason;
  constructor(reason: RefusalReason) {
    this.reason = reason;
  }
}

/** One camera's view of a pass, and its place. */
export interface PassPart {
  readonly camera: Camera;
  readonly widthPx: number;
  readonly heightPx: number;
  /** With the top left of the viewport, whole pixels, y down. */
  readonly host: HostPass;
}

/** One of three's render passes while it is recorded. */
export interface OpenPass {
  /** The target: a RenderTarget of the application, or the CanvasTarget. */
  readonly target: object;
  /** One for each camera that draws in the pass, in three's order. */
  readonly parts: readonly PassPart[];
  /** Undefined if the target has no depth. */
  readonly depth: DepthConvention | undefined;
  /** Whether objects drawn before may hide the splats; true if that is unknown. */
  readonly hasOccluders: boolean;
  /**
   * Ends the pass, lets `record` record passes of its own for each part, and continues the pass as
   * it was. If three makes its passes only at the end of its render, `record` is first called for
   * each part without an encoder, to make the image, and later again with one.
   */
  interrupt(record: (part: number, encoder: GPUCommandEncoder | null) => void): void;
}

/**
 * Returns the pass that `renderer` is recording during the `onBeforeRender` of `drawn`, or null if
 * it only compiles shaders.
 *
 * @param camera if it is an ArrayCamera, `openArrayPass` makes parts of the pass.
 * @throws ThreeInternalsError if three has changed; PassRefusal if the pass cannot be interrupted.
 */
export function openPass(
  renderer: WebGPURenderer,
  scene: Scene,
  camera: Camera,
  drawn: Object3D,
): OpenPass | null {
  const internals = internalsOf(renderer);
  const context = internals._currentRenderContext;
  if (internals._compilationPromises !== null || context === null) return null;
  const { backend } = internals;
  const data = backend.get(context) as RenderContextData;
  if (!data.currentPass && !data.bundleEncoders) return null;
  probe(data, 'backend.get(context)', { object: ['encoder', 'descriptor', 'currentSets', 'renderBundles'] });
  probe(data.descriptor, 'backend.get(context).descriptor', { object: ['colorAttachments'] });
  probe(context, 'context', {
    object: ['textures', 'viewportValue', 'scissorValue'],
    boolean: ['depth', 'stencil', 'viewport', 'scissor'],
    number: ['width', 'height', 'activeCubeFace', 'activeMipmapLevel', 'occlusionQueryCount'],
  });
  const { x, y, width, height } = context.viewport ? context.viewportValue : { x: 0, y: 0, ...context };
  if (data.currentPass) checkResumable(data.descriptor);
  const color = colorOf(backend, context, data.descriptor);
  const host: HostPass = {
    color,
    depth: context.depth ? depthOf(backend, context) : null,
    xPx: x,
    yPx: y,
    layer: context.activeCubeFace,
    writesColor: isWritable(color, context, data),
  };
  return {
    target: targetKey(renderer, context),
    parts: [{ camera, widthPx: width, heightPx: height, host }],
    depth: context.depth ? depthConvention(renderer) : undefined,
    hasOccluders: isDepthLoaded(data) || mayHaveWrittenDepth(internals, scene, camera, drawn),
    interrupt: (record) => {
      suspend(backend, context, data);
      try {
        record(0, data.encoder);
      } finally {
        resume(context, data);
      }
    },
  };
}

/** Whether this is three's WebGPURenderer and draws with WebGPU, not with its WebGL 2 backend. */
export function hasWebGpuBackend(renderer: object): renderer is WebGPURenderer {
  return (renderer as { backend?: { isWebGPUBackend?: boolean } }).backend?.isWebGPUBackend === true;
}

/** Returns the device of an initialised renderer, and whether three has made it. */
export function deviceOf(renderer: WebGPURenderer): {
  readonly device: GPUDevice;
  readonly isMadeByThree: boolean;
} {
  const { device, parameters } = (renderer as unknown as RendererInternals).backend;
  if (!device) throw new ThreeInternalsError('renderer.backend.device', REVISION);
  return { device, isMadeByThree: !parameters?.device };
}

/** Whether a WebGPURenderer was made with `forceWebGL`; otherwise it has fallen back to WebGL 2. */
export function isWebGlForced(renderer: object): boolean {
  const { backend } = renderer as Partial<RendererInternals>;
  return backend?.parameters?.forceWebGL === true;
}

interface Rectangle {
  readonly x: number;
  readonly y: number;
  readonly width: number;
  readonly height: number;
}

/** The properties of a RenderContext that are read here. */
export interface RenderContext {
  readonly renderTarget: (object & { readonly isPostProcessingRenderTarget?: boolean }) | null;
  readonly textures: readonly { readonly name: string }[] | null;
  readonly depthTexture: object | null;
  readonly depth: boolean;
  readonly stencil: boolean;
  readonly width: number;
  readonly height: number;
  readonly viewport: boolean;
  readonly viewportValue: Rectangle & { readonly minDepth: number; readonly maxDepth: number };
  readonly scissor: boolean;
  readonly scissorValue: Rectangle;
  readonly activeCubeFace: number;
  readonly activeMipmapLevel: number;
  readonly occlusionQueryCount: number;
}

/** The backend's data about a RenderContext while it is drawn. */
export interface RenderContextData extends OcclusionData {
  currentPass: GPURenderPassEncoder | null | undefined;
  readonly encoder: GPUCommandEncoder;
  readonly descriptor: PassDescriptor;
  currentSets: object;
  renderBundles: GPURenderBundle[];
  /** Recordings by camera, if three makes a pass for each camera of an array when all is drawn. */
  readonly bundleEncoders?: readonly GPURenderBundleEncoder[];
  readonly currentStencilRef?: number;
  readonly currentBlendColor?: { readonly r: number; readonly g: number; readonly b: number };
  readonly currentBlendAlpha?: number;
}

interface OcclusionData {
  lastOcclusionObject?: { readonly occlusionTest?: boolean } | null;
  occlusionQueryIndex?: number;
}

type PassDescriptor = Omit<GPURenderPassDescriptor, 'colorAttachments'> & {
  readonly colorAttachments: readonly GPURenderPassColorAttachment[];
};

/** The backend's data about a Texture. */
export interface TextureData {
  readonly texture?: GPUTexture;
  /** Target of draws if the texture is resolved from samples: one, or since 0.187 one per layer. */
  readonly msaaTexture?: GPUTexture;
  readonly msaaTextures?: readonly GPUTexture[];
}

export interface Backend {
  get(of: object): object;
  readonly context: GPUCanvasContext;
  /** Null before `renderer.init()`. */
  readonly device?: GPUDevice | null;
  /** Parameters of the renderer's constructor. */
  readonly parameters?: { readonly device?: GPUDevice; readonly forceWebGL?: boolean };
  readonly textureUtils: { getDepthBuffer(depth: boolean, stencil: boolean): GPUTexture };
  /** Since 0.186; before, the render context's own data held it. */
  getOcclusionData?(context: RenderContext): OcclusionData;
}

export interface RendererInternals {
  readonly _currentRenderContext: RenderContext | null;
  readonly _compilationPromises: readonly unknown[] | null;
  /** Read if present; without it, nothing is known about the objects drawn before. */
  readonly _renderLists?: { get?(scene: Scene, camera: Camera, lighting: unknown): RenderList };
  /** Since 0.187 part of the key of a list. */
  readonly lighting?: unknown;
  readonly backend: Backend;
}

/** A scene's objects for a camera in three's order: bundles, opaque objects, transparent ones. */
interface RenderList {
  readonly bundles?: readonly object[];
  readonly opaque?: readonly RenderItem[];
  readonly transparentDoublePass?: readonly RenderItem[];
  readonly transparent?: readonly RenderItem[];
}

interface RenderItem {
  readonly object: Object3D;
  readonly material: { readonly depthWrite?: boolean };
}

const probed = new WeakSet<object>();
/** Passes that continue an interrupted one. */
const resumedPasses = new WeakSet<object>();

function internalsOf(renderer: WebGPURenderer): RendererInternals {
  const internals = renderer as unknown as RendererInternals;
  probe(internals, 'renderer', {
    object: ['_currentRenderContext', '_compilationPromises', 'backend'],
    function: ['getCanvasTarget'],
  });
  probe(internals.backend, 'renderer.backend', { function: ['get'], object: ['textureUtils'] });
  probe(internals.backend.textureUtils, 'renderer.backend.textureUtils', { function: ['getDepthBuffer'] });
  return internals;
}

/**
 * Throws unless `object` has the properties of `shape`. Each object is checked once.
 *
 * @param shape names of properties, by type.
 */
export function probe(
  object: object,
  path: string,
  shape: Readonly<Record<string, readonly string[]>>,
): void {
  if (probed.has(object)) return;
  for (const type in shape)
    for (const name of shape[type])
      if (typeof (object as Record<string, unknown>)[name] !== type)
        throw new ThreeInternalsError(`${path}.${name} (${type})`, REVISION);
  probed.add(object);
}

/**
 * Returns the object that identifies the target: three draws frames for a canvas into a target of
 * its own first.
 */
function targetKey(renderer: WebGPURenderer, { renderTarget }: RenderContext): object {
  const isCanvas = renderTarget === null || renderTarget.isPostProcessingRenderTarget === true;
  return isCanvas ? (renderer.getOutputRenderTarget() ?? renderer.getCanvasTarget()) : renderTarget;
}

function depthConvention(renderer: WebGPURenderer): DepthConvention {
  return {
    compare: renderer.reversedDepthBuffer ? 'greater-equal' : 'less-equal',
    mapping: renderer.logarithmicDepthBuffer ? 'logarithmic' : 'projection',
  };
}

/** Whether the pass starts with depth of an earlier pass, or its own before an interruption. */
function isDepthLoaded({ descriptor, currentPass }: RenderContextData): boolean {
  return descriptor.depthStencilAttachment?.depthLoadOp !== 'clear' || resumedPasses.has(currentPass!);
}

/** Whether an object before `drawn` in three's list writes depth; true if `drawn` is in no list. */
function mayHaveWrittenDepth(
  { _renderLists, lighting }: RendererInternals,
  scene: Scene,
  camera: Camera,
  drawn: Object3D,
): boolean {
  const { bundles, opaque, transparent, transparentDoublePass } =
    _renderLists?.get?.(scene, camera, lighting) ?? {};
  const index = transparent?.findIndex(({ object }) => object === drawn) ?? -1;
  if (!(bundles && opaque && transparent && transparentDoublePass) || index < 0) return true;
  const before = [opaque, transparentDoublePass, transparent.slice(0, index)];
  return (
    bundles.length > 0 || before.some((items) => items.some(({ material }) => material.depthWrite !== false))
  );
}

function checkResumable({ colorAttachments, depthStencilAttachment }: PassDescriptor): void {
  const { depthStoreOp, stencilStoreOp } = depthStencilAttachment ?? {};
  const storeOps = [...colorAttachments.map(({ storeOp }) => storeOp), depthStoreOp, stencilStoreOp];
  if (storeOps.includes('discard')) {
    throw new PassRefusal('lost-samples');
  }
}

/** Returns the texture, with one sample per pixel, that holds the colours of the ended pass. */
function colorOf(backend: Backend, context: RenderContext, descriptor: PassDescriptor): GPUTexture {
  if (context.textures === null) return backend.context.getCurrentTexture();
  const { textures } = context;
  // three names the image `output` if there are several outputs.
  const index = Math.max(
    0,
    textures.findIndex(({ name }) => name === 'output'),
  );
  const { texture, msaaTexture, msaaTextures } = backend.get(textures[index]) as TextureData;
  if (!texture) throw new ThreeInternalsError('backend.get(texture).texture', REVISION);
  if ((msaaTexture || msaaTextures) && !descriptor.colorAttachments[index].resolveTarget) {
    throw new PassRefusal('unresolved-samples');
  }
  if (texture.dimension !== '2d' || context.activeMipmapLevel > 0) {
    throw new PassRefusal('part-of-texture');
  }
  return texture;
}

/**
 * Whether an image that is copied into `color` stays there, and is all that the layer's triangle
 * would draw: no samples are resolved over it, and there are no other outputs.
 */
function isWritable(
  color: GPUTexture,
  { textures, scissor }: RenderContext,
  { descriptor: { colorAttachments } }: RenderContextData,
): boolean {
  return (
    textures !== null &&
    !scissor &&
    colorAttachments.length === 1 &&
    !colorAttachments[0].resolveTarget &&
    color.format === 'rgba16float' &&
    (color.usage & GPUTextureUsage.COPY_DST) !== 0
  );
}

function depthOf(backend: Backend, { depthTexture, depth, stencil }: RenderContext): GPUTexture {
  if (depthTexture === null) return backend.textureUtils.getDepthBuffer(depth, stencil);
  const { texture } = backend.get(depthTexture) as TextureData;
  if (!texture) throw new ThreeInternalsError('backend.get(depthTexture).texture', REVISION);
  return texture;
}

/** Ends the pass, after recording everything that three would still have recorded in it. */
function suspend(backend: Backend, context: RenderContext, data: RenderContextData): void {
  const pass = data.currentPass!;
  // three draws bundles at the end of the pass, where they would cover the splats.
  if (data.renderBundles.length > 0) {
    pass.executeBundles(data.renderBundles);
    data.renderBundles = [];
  }
  if (context.occlusionQueryCount > 0) {
    const queries = backend.getOcclusionData?.(context) ?? data;
    if (queries.lastOcclusionObject?.occlusionTest) {
      pass.endOcclusionQuery();
      queries.occlusionQueryIndex!++;
    }
    queries.lastOcclusionObject = null;
  }
  pass.end();
}

/** Continues the pass, in the state that three expects. */
function resume(context: RenderContext, data: RenderContextData): void {
  const { descriptor, encoder } = data;
  const pass = encoder.beginRenderPass(resumed(descriptor, context));
  if (context.viewport) {
    const { x, y, width, height, minDepth, maxDepth } = context.viewportValue;
    pass.setViewport(x, y, width, height, minDepth, maxDepth);
  }
  if (context.scissor) {
    const { x, y, width, height } = context.scissorValue;
    pass.setScissorRect(x, y, width, height);
  }
  if (data.currentStencilRef !== undefined) pass.setStencilReference(data.currentStencilRef);
  if (data.currentBlendColor && data.currentBlendAlpha !== undefined) {
    pass.setBlendConstant({ ...data.currentBlendColor, a: data.currentBlendAlpha });
  }
  resumedPasses.add(pass);
  data.currentPass = pass;
  // The new pass has no pipeline and no bindings: three must set all again.
  data.currentSets = { attributes: {}, bindingGroups: [], pipeline: null, index: null };
}

/** Returns the descriptor of the same pass, changed to load the pixels drawn so far. */
function resumed(
  { colorAttachments, depthStencilAttachment, timestampWrites, ...rest }: PassDescriptor,
  { depth, stencil }: RenderContext,
): GPURenderPassDescriptor {
  return {
    ...rest,
    colorAttachments: colorAttachments.map((attachment) => ({ ...attachment, loadOp: 'load' as const })),
    depthStencilAttachment: depthStencilAttachment && {
      ...depthStencilAttachment,
      ...(depth && { depthLoadOp: 'load' }),
      ...(stencil && { stencilLoadOp: 'load' }),
    },
    // The first part has written the time of the start; the time in between counts, too.
    ...(timestampWrites && {
      timestampWrites: {
        querySet: timestampWrites.querySet,
        endOfPassWriteIndex: timestampWrites.endOfPassWriteIndex,
      },
    }),
  };
}
