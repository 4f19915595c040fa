import { DestroyedError, InvalidArgumentError } from '../../data/errors.ts';
import { checkKind, wrongArgument } from '../../data/given.ts';
import {
  type BoundCloud,
  type BoundResource,
  type EffectResources,
  type EffectUse,
  structName,
} from './effect.ts';

/**
 * Kind of a resource that an effect's functions read:
 * - `texture`: a 2D texture of colours with a sampler, read by `textureSampleLevel`;
 * - `texels`: a 2D texture of floats without a sampler, read by `textureLoad`; also of formats that
 *   cannot be filtered, such as `rgba32float`;
 * - `depth`: a 2D depth texture, such as a shadow map, read by `textureLoad`;
 * - a read-only storage buffer: an array of numbers, vectors or matrices, such as `array<vec4f>`.
 */
export type EffectResourceType = 'texture' | 'texels' | 'depth' | `array<${string}>`;

/** A texture or buffer for an effect, with what is known about it. */
export interface EffectResource {
  /** On the engine's device. A texture needs the usage TEXTURE_BINDING, a buffer STORAGE. */
  readonly source: GPUTexture | GPUTextureView | GPUBuffer;
  /** Sampler of a `texture`; default: linear filters, coordinates clamped to the edge. */
  readonly sampler?: GPUSampler;
  /**
   * A number that changes whenever the contents do: while it is the same, frames may stay as they are.
   * Default: the contents may change before each frame.
   */
  readonly version?: number;
}

/** A resource as an effect's options hold it. */
export type GivenResource = GPUTexture | GPUTextureView | GPUBuffer | EffectResource;

const TEXTURES: readonly string[] = ['texture', 'texels', 'depth'];
const STORED = /^array<\s*(?:[fiu]32|vec[234](?:[fiu]|<[fiu]32>)|mat[234]x[234](?:f|<f32>))\s*>$/;

/**
 * Declares textures and storage buffers that an effect's functions read, for `defineEffect`. The
 * functions import each by the effect's name and its own: `parameters::windSwayHeights` is the
 * resource `heights` of `wind-sway`, and `parameters::windSwayHeightsSampler` the sampler of a
 * `texture`. Compute stages call them, where `textureSample` does not exist: use `textureSampleLevel`.
 *
 * The engine binds resources and never destroys them; a replaced texture or buffer compiles nothing.
 * A stage may read 16 textures, and as many storage buffers as the device allows
 * (`maxStorageBuffersPerShaderStage`) besides seven of the engine's: one with the default of 8.
 *
 * @param types kind of each resource, by name.
 * @param of returns the resources of a use, from its options; called once per frame. Frames throw
 *   `InvalidArgumentError` for a resource of another kind, usage, format or size. For a resource of
 *   another device, and with `DestroyedError` for one that is destroyed, `whenDrawn` rejects and the next
 *   frame throws, once, when the device has answered; the cloud is drawn without the effect.
 * @throws InvalidArgumentError for a name that is no word of letters and digits, or an unknown kind.
 * @example
 * const painted = defineEffect<{ image: GPUTexture }>({
 *   name: 'painted', label: 'Painted', about: 'Projects an image along z.',
 *   hooks: { color: 'paintColor' },
 *   resources: effectResources({ image: 'texture' }, ({ image }) => ({ image })),
 *   wgsl: `import package::lib::packing::Splat;
 * import parameters::{paintedImage, paintedImageSampler};
 * fn paintColor(color: vec3f, splat: Splat, index: u32, centerView: vec3f) -> vec3f {
 *   return textureSampleLevel(paintedImage, paintedImageSampler, splat.position.xy, 0.0).rgb;
 * }`,
 *   calledFor: () => 'an image is projected onto it',
 * });
 */
export function effectResources<Options, const Types extends Readonly<Record<string, EffectResourceType>>>(
  types: Types,
  of: (options: Options) => { readonly [Name in keyof Types]: GivenResource },
): EffectResources<Options> {
  const entries = Object.entries(types);
  for (const [name, type] of entries) {
    if (!/^[a-z][a-zA-Z0-9]*$/.test(name))
      throw wrongArgument('resources', name, 'names of letters and digits, such as heights');
    if (!TEXTURES.includes(type) && !STORED.test(type))
      throw wrongArgument(
        `resources.${name}`,
        type,
        'texture, texels, depth or an array such as array<vec4f>',
      );
  }
  const textures = entries.filter(([, type]) => !isArray(type)).length;
  return {
    textures,
    storageBuffers: entries.length - textures,
    of,
    declarations: (effect) => entries.flatMap(([name, type]) => declared(resourceName(effect, name), type)),
    on({ effect: { name: effect }, options }, acting, cloud) {
      checkRoom(acting, cloud);
      const { device } = cloud;
      const given = of(options as Options);
      checkKind(`${effect}: resources`, given, 'an object');
      return entries.flatMap(([name, type]) => bound({ device, effect, name, type }, given[name]));
    },
    refusal: (bound, device) => {
      for (const { binding } of bound) {
        const refusal = refusals.get(device)?.get(binding);
        if (refusal) return refusal;
      }
      return null;
    },
    async ask({ effect: { name: effect } }, bound, device) {
      await Promise.all(
        entries.map(([name, type]) => {
          const resource = bound.find((each) => each.name === resourceName(effect, name));
          return resource && askWhetherUsable({ device, effect, name, type }, resource.binding as Bindable);
        }),
      );
    },
  };
}

/** Name in WGSL of a resource of an effect: `windSwayHeights` for `heights` of `wind-sway`. */
function resourceName(effect: string, resource: string): string {
  const [first, ...rest] = structName(`${effect}-${resource}`);
  return first.toLowerCase() + rest.join('');
}

/** Most storage buffers of a stage that applies effects, besides those of the effects. */
export const STAGE_BUFFERS = 7;

/** @throws InvalidArgumentError for effects that together read more than a stage of the device may. */
function checkRoom(acting: readonly EffectUse[], { name, device, timeRange }: BoundCloud): void {
  const sum = (of: (use: EffectUse) => number | undefined) =>
    acting.reduce((total, use) => total + (of(use) ?? 0), 0);
  const selections = Number(acting.some(({ effect }) => effect.takesSelection));
  const own = sum(({ effect }) => effect.resources?.storageBuffers);
  const rows = Number(acting.some(({ effect }) => effect.rows));
  const needs = {
    maxStorageBuffersPerShaderStage: STAGE_BUFFERS + Number(timeRange !== null) + selections + own,
    maxSampledTexturesPerShaderStage: rows + sum(({ effect }) => effect.resources?.textures),
  };
  for (const [limit, need] of Object.entries(needs)) {
    const most = device.limits[limit as keyof typeof needs];
    if (need <= most) continue;
    const what = limit.includes('Textures') ? 'textures' : 'storage buffers';
    const message = `${name}: its effects need ${need} ${what} in one shader stage, of which this device allows ${most} (${limit}). Request the device by requestSplatDevice or with sceneLimits, put several arrays into one, or leave an effect out.`;
    throw new InvalidArgumentError('effects', message);
  }
}

/** Declarations of a resource without their bindings. */
function declared(name: string, type: EffectResourceType): string[] {
  if (isArray(type)) return [`var<storage, read> ${name}: ${type};`];
  if (type === 'depth') return [`var ${name}: texture_depth_2d;`];
  const texture = `var ${name}: texture_2d<f32>;`;
  return type === 'texture' ? [texture, `var ${name}Sampler: sampler;`] : [texture];
}

function isArray(type: EffectResourceType): boolean {
  return type.startsWith('array');
}

/** Bytes from an element of an array to the next: without room for one, a buffer cannot be bound. */
function elementBytes(type: string): number {
  const [, columns = '1', rows] = type.match(/mat(\d)x(\d)/) ?? type.match(/(vec)(\d)/) ?? [];
  const vectors = Number(columns) || 1;
  return vectors * (rows === undefined ? 4 : rows === '2' ? 8 : 16);
}

const SAMPLE_TYPES = { texture: 'float', texels: 'unfilterable-float', depth: 'depth' } as const;

/** A resource of an effect that is bound on a device. */
interface Slot {
  readonly device: GPUDevice;
  /** Name of the effect. */
  readonly effect: string;
  readonly name: string;
  readonly type: EffectResourceType;
}

/** @throws InvalidArgumentError */
function bound(slot: Slot, given: GivenResource): BoundResource[] {
  const { device, effect, type } = slot;
  const { source, sampler, version }: EffectResource = isDescribed(given) ? given : { source: given };
  const name = resourceName(effect, slot.name);
  if (isArray(type)) {
    checkBuffer(slot, source);
    checkBindable(slot, source);
    return [{ name, binding: source, version }];
  }
  if (!isTexture(source) && !isView(source)) throw unfit(slot, 'is no GPUTexture or GPUTextureView');
  if (isTexture(source)) checkTexture(slot, source);
  const view = isTexture(source) ? viewOf(source) : source;
  checkBindable(slot, view);
  const texture = { name, binding: view, version };
  if (type !== 'texture') return [texture];
  return [texture, { name: `${name}Sampler`, binding: sampler ?? samplerOf(device), version: 0 }];
}

function isDescribed(given: GivenResource): given is EffectResource {
  return typeof given === 'object' && given !== null && 'source' in given;
}

function isTexture(source: object): source is GPUTexture {
  return typeof source === 'object' && source !== null && 'createView' in source;
}

function isBuffer(source: object): source is GPUBuffer {
  return typeof source === 'object' && source !== null && 'mapAsync' in source;
}

/** Views have no members of their own. */
function isView(source: object): source is GPUTextureView {
  return typeof source === 'object' && source !== null && 'label' in source && !isBuffer(source);
}

function checkBuffer(slot: Slot, source: object): asserts source is GPUBuffer {
  if (!isBuffer(source)) throw unfit(slot, 'is no GPUBuffer');
  const { usage, size } = source;
  if (!(usage & GPUBufferUsage.STORAGE)) throw unfit(slot, 'lacks the usage GPUBufferUsage.STORAGE');
  const least = elementBytes(slot.type);
  if (size < least) throw unfit(slot, `has ${size} bytes, and an element of ${slot.type} has ${least}`);
  const { maxStorageBufferBindingSize: most } = slot.device.limits;
  if (size > most)
    throw unfit(slot, `has ${size} bytes, of which a shader may bind ${most} (maxStorageBufferBindingSize)`);
}

/** Formats whose texels are floats that every device can filter, besides compressed ones. */
const FILTERED =
  /^(?:(?:r|rg|rgba|bgra)8(?:unorm|snorm)|(?:r|rg|rgba)16float|rgb10a2unorm|rg11b10ufloat|rgb9e5ufloat|bc|etc2|eac|astc)/;
const FLOAT32 = /^(?:r|rg|rgba)32float$/;

function checkTexture(
  slot: Slot,
  { usage, dimension, sampleCount, depthOrArrayLayers, format }: GPUTexture,
): void {
  const { device, type } = slot;
  if (!(usage & GPUTextureUsage.TEXTURE_BINDING))
    throw unfit(slot, 'lacks the usage GPUTextureUsage.TEXTURE_BINDING');
  if (sampleCount > 1) throw unfit(slot, `has ${sampleCount} samples per pixel; resolve them first`);
  if (dimension !== '2d' || depthOrArrayLayers > 1)
    throw unfit(slot, `is ${dimension} with ${depthOrArrayLayers} layers; pass a 2D view of one layer`);
  if (type === 'depth') {
    if (!format.startsWith('depth')) throw unfit(slot, `has the format ${format}; it must hold depth`);
    return;
  }
  if (FILTERED.test(format)) return;
  if (!FLOAT32.test(format)) throw unfit(slot, `has the format ${format}; it must hold floats`);
  if (type === 'texture' && !device.features.has('float32-filterable'))
    throw unfit(
      slot,
      `has the format ${format}, which this device cannot filter; declare it as texels, or use a format of float16`,
    );
}

function unfit({ effect, name }: Slot, problem: string): InvalidArgumentError {
  return new InvalidArgumentError(name, `The effect ${effect}: its resource ${name} ${problem}.`);
}

const views = new WeakMap<GPUTexture, GPUTextureView>();

/** Returns the same view each time: frames compare it with the last one's. */
function viewOf(texture: GPUTexture): GPUTextureView {
  let view = views.get(texture);
  if (!view) {
    // Depth textures may have a stencil, too.
    view = texture.createView({ aspect: texture.format.startsWith('depth') ? 'depth-only' : 'all' });
    views.set(texture, view);
  }
  return view;
}

const samplers = new WeakMap<GPUDevice, GPUSampler>();

function samplerOf(device: GPUDevice): GPUSampler {
  let sampler = samplers.get(device);
  if (!sampler) {
    sampler = device.createSampler({ minFilter: 'linear', magFilter: 'linear', mipmapFilter: 'linear' });
    samplers.set(device, sampler);
  }
  return sampler;
}

type Bindable = GPUBuffer | GPUTextureView;

/** Why a device has refused a resource, or null: while it has not. */
const refusals = new WeakMap<GPUDevice, WeakMap<object, Error | null>>();

/** Binds a new resource once, because resources do not tell their device, nor views their format. */
function checkBindable(slot: Slot, binding: Bindable): void {
  const { device } = slot;
  const known = refusals.get(device) ?? new WeakMap<object, Error | null>();
  refusals.set(device, known);
  if (known.has(binding)) return;
  known.set(binding, null);
  device.pushErrorScope('validation');
  bindAlone(slot, binding);
  const refuse = ({ message }: GPUError) =>
    unfit(
      slot,
      `cannot be bound on the engine's device: ${message.split('\n')[0]} Make it on \`engine.device\``,
    );
  void device.popErrorScope().then((error) => error && known.set(binding, refuse(error)));
}

/** Submits work with the resource alone: only then devices refuse a resource that has been destroyed. */
async function askWhetherUsable(slot: Slot, binding: Bindable): Promise<void> {
  const { device, effect, name } = slot;
  const known = refusals.get(device);
  if (!known || known.get(binding)) return;
  device.pushErrorScope('validation');
  const group = bindAlone(slot, binding);
  const encoder = device.createCommandEncoder({ label: 'websplatter probe of a resource' });
  const pass = encoder.beginComputePass();
  pass.setBindGroup(0, group);
  pass.end();
  device.queue.submit([encoder.finish()]);
  const error = await device.popErrorScope();
  if (!error) return;
  const what = `The resource ${name} of the effect ${effect}`;
  known.set(
    binding,
    new DestroyedError(
      what,
      `the device refused it (${error.message.split('\n')[0]}); clouds are drawn without the effect`,
    ),
  );
}

function bindAlone({ device, type }: Slot, binding: Bindable): GPUBindGroup {
  const kind = isArray(type)
    ? { buffer: { type: 'read-only-storage' as const } }
    : { texture: { sampleType: SAMPLE_TYPES[type as keyof typeof SAMPLE_TYPES] } };
  const layout = device.createBindGroupLayout({
    entries: [{ binding: 0, visibility: GPUShaderStage.COMPUTE, ...kind }],
  });
  const resource = isBuffer(binding) ? { buffer: binding } : binding;
  return device.createBindGroup({ layout, entries: [{ binding: 0, resource }] });
}
