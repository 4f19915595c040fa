// All knowledge of where three keeps the textures and buffers that nodes read, and which of them
// compute shaders cannot read.
import { InvalidArgumentError } from '@websplatter/core';
import type { EffectResource, EffectResourceType } from '@websplatter/core/effects';
import {
  type BufferAttribute,
  IntType,
  LinearFilter,
  LinearMipmapLinearFilter,
  LinearMipmapNearestFilter,
  MirroredRepeatWrapping,
  NearestMipmapLinearFilter,
  REVISION,
  RepeatWrapping,
  type Texture,
  UnsignedIntType,
  type WebGPURenderer,
} from 'three/webgpu';
import { ThreeInternalsError } from '../errors.ts';
import { deviceOf } from '../renderer/three-bridge.ts';

/** A node that reads a texture or a storage buffer. */
export interface ResourceNode {
  /** What it reads now: materials may replace it. */
  readonly value: unknown;
  readonly isStorageTextureNode?: boolean;
  readonly isAtomic?: boolean;
  readonly structTypeNode?: object | null;
}

/** A texture or buffer that the shader of nodes reads. */
export interface NodeResource {
  readonly type: EffectResourceType;
  readonly node: ResourceNode;
}

/** Properties by which three tells kinds of textures. */
interface TextureKinds {
  readonly isVideoTexture?: boolean;
  readonly isVideoFrameTexture?: boolean;
  readonly isDepthTexture?: boolean;
  readonly isArrayTexture?: boolean;
  readonly isDataArrayTexture?: boolean;
  readonly isRenderTargetTexture?: boolean;
  readonly isFramebufferTexture?: boolean;
  readonly isStorageTexture?: boolean;
  readonly isExternalTexture?: boolean;
}

/** Textures that compute shaders of splats cannot read, and what to do. */
const REFUSED: readonly (readonly [
  is: (texture: Texture & TextureKinds, kind: string) => unknown,
  what: string,
  remedy: string,
])[] = [
  [(_, kind) => kind.startsWith('cube'), 'a cube texture', 'take an equirectangular one with equirectUV()'],
  [
    (texture, kind) => kind === 'texture3D' || texture.isArrayTexture || texture.isDataArrayTexture,
    'a texture with layers',
    'put its layers side by side in a 2D texture',
  ],
  [
    (texture) => texture.isVideoTexture || texture.isVideoFrameTexture,
    'a video texture',
    'draw the video into a CanvasTexture, or render it into a RenderTarget',
  ],
  [
    (texture) => texture.isDepthTexture,
    'a depth texture, which may have several samples per pixel',
    'render the depth into the colours of a RenderTarget',
  ],
  [
    ({ type }) => type === IntType || type === UnsignedIntType,
    'a texture of integers',
    'use floats, or a storage buffer',
  ],
];

/**
 * Checks that splats can read a texture.
 *
 * @param kind three's type of the node's input.
 * @throws InvalidArgumentError
 */
export function checkTexture({ value, isStorageTextureNode }: ResourceNode, kind: string): void {
  const texture = value as Texture;
  if (isStorageTextureNode)
    throw refusal(
      'storageTexture()',
      'read it by texture(map, uv), and write it in compute() of the renderer',
    );
  for (const [is, what, remedy] of REFUSED)
    if (is(texture, kind)) throw refusal(texture.name ? `${what}, "${texture.name}"` : what, remedy);
}

/** Returns the error for nodes that splats cannot have. */
export function refusal(used: string, remedy: string): InvalidArgumentError {
  const message = `The nodes of splatNode() use ${used}; ${remedy}.`;
  return new InvalidArgumentError('nodes', message);
}

/** The parts of a renderer that hold what it has uploaded. */
interface ResourceRenderer {
  readonly backend: { get(of: object): { readonly texture?: GPUTexture; readonly buffer?: GPUBuffer } };
  readonly _attributes?: { update?(attribute: object, type: number): void };
  readonly info: { readonly compute: { readonly calls: number } };
}

/** three's number for attributes that are storage buffers. */
const STORAGE_ATTRIBUTE = 3;

/**
 * Returns the texture or buffer on the GPU that a node reads, uploaded as three does for meshes: while
 * an image is loading, its texture is a black pixel.
 *
 * @throws ThreeInternalsError if three has changed.
 */
export function gpuResourceOf(renderer: object, { type, node: { value } }: NodeResource): EffectResource {
  const internals = renderer as ResourceRenderer;
  if (type === 'texture' || type === 'texels') {
    const texture = value as Texture & TextureKinds;
    (renderer as WebGPURenderer).initTexture(texture);
    const { texture: source } = internals.backend.get(texture);
    if (!source) throw new ThreeInternalsError('backend.get(texture).texture', REVISION);
    const isWrittenByGpu =
      texture.isRenderTargetTexture ||
      texture.isFramebufferTexture ||
      texture.isStorageTexture ||
      texture.isExternalTexture;
    const sampler = samplerFor(deviceOf(renderer as WebGPURenderer).device, texture);
    return { source, sampler, ...(!isWrittenByGpu && { version: texture.version }) };
  }
  const attribute = value as BufferAttribute;
  if (typeof internals._attributes?.update !== 'function')
    throw new ThreeInternalsError('renderer._attributes.update', REVISION);
  internals._attributes.update(attribute, STORAGE_ATTRIBUTE);
  const { buffer } = internals.backend.get(attribute);
  if (!buffer) throw new ThreeInternalsError('backend.get(attribute).buffer', REVISION);
  // Any of three's compute passes may have written it; both numbers only grow.
  return { source: buffer, version: attribute.version + internals.info.compute.calls };
}

const samplers = new WeakMap<GPUDevice, Map<string, GPUSampler>>();

/** Returns the sampler that three's texture asks for. */
function samplerFor(device: GPUDevice, { wrapS, wrapT, magFilter, minFilter }: Texture): GPUSampler {
  const known = samplers.get(device) ?? new Map<string, GPUSampler>();
  samplers.set(device, known);
  const key = [wrapS, wrapT, magFilter, minFilter].join(' ');
  let sampler = known.get(key);
  if (!sampler) {
    const filter = (...linear: number[]) => (linear.includes(minFilter) ? 'linear' : 'nearest');
    sampler = device.createSampler({
      addressModeU: addressMode(wrapS),
      addressModeV: addressMode(wrapT),
      magFilter: magFilter === LinearFilter ? 'linear' : 'nearest',
      minFilter: filter(LinearFilter, LinearMipmapNearestFilter, LinearMipmapLinearFilter),
      mipmapFilter: filter(NearestMipmapLinearFilter, LinearMipmapLinearFilter),
    });
    known.set(key, sampler);
  }
  return sampler;
}

function addressMode(wrapping: number): GPUAddressMode {
  if (wrapping === RepeatWrapping) return 'repeat';
  return wrapping === MirroredRepeatWrapping ? 'mirror-repeat' : 'clamp-to-edge';
}
