/** A resource that a shader declares in group 0. */
export interface ShaderBinding {
  readonly name: string;
  readonly entry: Omit<GPUBindGroupLayoutEntry, 'visibility'>;
}

const DECLARATION = /@binding\((\d+)\)\s*var(?:<([^>]*)>)?\s*(\w+)\s*:\s*(\w+)(?:<(\w+))?/g;

const BUFFER_TYPES: Readonly<Record<string, GPUBufferBindingType>> = {
  uniform: 'uniform',
  'storage,read': 'read-only-storage',
  'storage,read_write': 'storage',
};

/** Lists the resources that linked WGSL declares; textures as the engine's shaders use them. */
export function shaderBindings(wgsl: string): ShaderBinding[] {
  return Array.from(wgsl.matchAll(DECLARATION), ([, binding, space, name, type, parameter]) => ({
    name,
    entry: { binding: Number(binding), ...(space ? bufferOf(space) : textureOf(type, parameter)) },
  }));
}

function bufferOf(space: string): Pick<GPUBindGroupLayoutEntry, 'buffer'> {
  return { buffer: { type: BUFFER_TYPES[space.replace(/\s/g, '')] } };
}

function textureOf(
  type: string,
  format: string,
): Pick<GPUBindGroupLayoutEntry, 'texture' | 'storageTexture'> {
  if (type.startsWith('texture_storage'))
    return { storageTexture: { access: 'write-only', format: format as GPUTextureFormat } };
  const sampleType = type.startsWith('texture_depth') ? 'depth' : 'unfilterable-float';
  return { texture: { sampleType, multisampled: type.includes('multisampled') } };
}
