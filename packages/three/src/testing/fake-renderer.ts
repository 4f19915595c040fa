import { Object3D, PerspectiveCamera, Scene, type WebGPURenderer } from 'three/webgpu';

export const scene = new Scene();
export const camera = new PerspectiveCamera();
export const drawn = new Object3D();

/** Records calls and their arguments, in order. */
function recorder<Name extends string>(calls: unknown[][], ...names: Name[]) {
  return Object.fromEntries(
    names.map((name) => [name, (...args: unknown[]) => void calls.push([name, ...args])]),
  ) as Record<Name, (...args: unknown[]) => void>;
}

export function gpuTexture(label: string) {
  return { label, dimension: '2d', depthOrArrayLayers: 1 } as GPUTexture;
}

/** The parts of a renderer that the bridge reads, in the middle of a pass into a render target. */
export function fakeRenderer() {
  const calls: unknown[][] = [];
  const passMethods = [
    'end',
    'executeBundles',
    'endOcclusionQuery',
    'setViewport',
    'setScissorRect',
    'setStencilReference',
    'setBlendConstant',
  ] as const;
  const oldPass = recorder(calls, ...passMethods);
  const newPass = recorder(calls, ...passMethods);
  const target = { name: 'target' };
  const colorTexture = { name: 'output' };
  const depthTexture = {};
  const context: Record<string, unknown> = {
    renderTarget: target,
    textures: [{ name: 'normal' }, colorTexture],
    depthTexture,
    depth: true,
    stencil: false,
    width: 100,
    height: 80,
    viewport: false,
    viewportValue: { x: 10, y: 20, width: 30, height: 40, minDepth: 0, maxDepth: 1 },
    scissor: false,
    scissorValue: { x: 1, y: 2, width: 3, height: 4 },
    activeCubeFace: 0,
    activeMipmapLevel: 0,
    occlusionQueryCount: 0,
  };
  const attachment = { view: 'view', loadOp: 'clear', storeOp: 'store' };
  const data: Record<string, unknown> = {
    currentPass: oldPass,
    encoder: {
      beginRenderPass: (descriptor: unknown) => {
        calls.push(['beginRenderPass', descriptor]);
        return newPass;
      },
    },
    descriptor: {
      label: 'pass',
      colorAttachments: [attachment, { ...attachment }],
      depthStencilAttachment: { view: 'depth view', depthLoadOp: 'clear', depthStoreOp: 'store' },
    },
    currentSets: { pipeline: 'something' },
    renderBundles: [],
  };
  const kept = new Map<unknown, unknown>([
    [context, data],
    [colorTexture, { texture: gpuTexture('color') }],
    [depthTexture, { texture: gpuTexture('depth') }],
  ]);
  const backend: Record<string, unknown> = {
    isWebGPUBackend: true,
    get: (key: unknown) => kept.get(key) ?? {},
    context: { getCurrentTexture: () => gpuTexture('canvas') },
    textureUtils: { getDepthBuffer: () => gpuTexture('depth buffer') },
  };
  const canvasTarget = { name: 'canvas' };
  const list = {
    bundles: [] as object[],
    opaque: [] as object[],
    transparentDoublePass: [] as object[],
    transparent: [{ object: drawn, material: {} }] as object[],
  };
  const lighting = {};
  const fields: Record<string, unknown> = {
    _currentRenderContext: context,
    _compilationPromises: null,
    _renderLists: {
      get: (...keys: unknown[]) => (keys.every((key, i) => key === [scene, camera, lighting][i]) ? list : {}),
    },
    lighting,
    backend,
    getCanvasTarget: () => canvasTarget,
    getOutputRenderTarget: () => null,
    reversedDepthBuffer: false,
    logarithmicDepthBuffer: false,
  };
  const renderer = fields as unknown as WebGPURenderer;
  return {
    renderer,
    fields,
    backend,
    context,
    data,
    calls,
    kept,
    list,
    colorTexture,
    target,
    canvasTarget,
    oldPass,
    newPass,
  };
}
