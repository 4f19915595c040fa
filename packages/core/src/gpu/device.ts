import { WebGpuUnavailableError } from '../data/errors.ts';
import { given } from '../data/given.ts';

/** How to request a device. */
export interface DeviceOptions {
  /** Default `navigator.gpu`. */
  readonly gpu?: GPU;
  /** An adapter that has not given a device yet: each gives only one. */
  readonly adapter?: GPUAdapter;
  readonly powerPreference?: GPUPowerPreference;
  /** Whether to request all stable features of the adapter: for renderers that share the device. */
  readonly allFeatures?: boolean;
  /** Limits that a renderer that shares the device needs. */
  readonly requiredLimits?: Readonly<Record<string, number>>;
}

/** Features used if the adapter has them; nothing depends on them. */
const OPTIONAL_FEATURES: readonly GPUFeatureName[] = [
  'timestamp-query',
  'float32-blendable' as GPUFeatureName,
  'bgra8unorm-storage',
  'subgroups',
  // Without it some adapters give a compatibility-mode device.
  'core-features-and-limits' as GPUFeatureName,
];

/** Names of features outside of the WebGPU specification. */
const EXPERIMENTAL = /^(chromium|dawn)-/;

/**
 * Limits on the size of a scene or of sorted blocks, and on the effects of moving scenes; requested at
 * the adapter's maximum.
 */
const WIDENED_LIMITS = [
  'maxBufferSize',
  'maxStorageBufferBindingSize',
  'maxComputeWorkgroupStorageSize',
  'maxComputeInvocationsPerWorkgroup',
  'maxComputeWorkgroupSizeX',
  'maxStorageBuffersPerShaderStage',
] as const;

/**
 * Returns the adapter's maximum of each limit that bounds scenes and their effects, by name.
 *
 * @example
 * const adapter = await navigator.gpu.requestAdapter();
 * const device = await adapter?.requestDevice({ requiredLimits: sceneLimits(adapter) });
 */
export function sceneLimits({ limits }: Pick<GPUAdapter, 'limits'>): Record<string, number> {
  return Object.fromEntries(WIDENED_LIMITS.map((limit) => [limit, limits[limit]]));
}

/**
 * Requests a device with every feature and limit of the adapter that the engine, or a renderer
 * sharing the device, can use.
 *
 * @throws WebGpuUnavailableError if there is no WebGPU, no adapter or no device.
 * @example
 * const device = await requestSplatDevice({ powerPreference: 'high-performance' });
 * const engine = await SplatEngine.create({ device });
 */
export async function requestSplatDevice(options: DeviceOptions = {}): Promise<GPUDevice> {
  const asked = given(options).adapter;
  if (asked !== undefined) given(asked, { requestDevice: 'a function' }, 'adapter');
  const adapter = asked ?? (await requestAdapter(options));
  const isWanted = (feature: GPUFeatureName) =>
    options.allFeatures ? !EXPERIMENTAL.test(feature) : OPTIONAL_FEATURES.includes(feature);
  const requiredFeatures = ([...adapter.features] as GPUFeatureName[]).filter(isWanted);
  const requiredLimits = { ...options.requiredLimits, ...sceneLimits(adapter) };
  try {
    return await adapter.requestDevice({ label: 'websplatter', requiredFeatures, requiredLimits });
  } catch (cause) {
    const message = `The WebGPU adapter gave no device: ${(cause as Error).message}`;
    throw new WebGpuUnavailableError(message, { cause });
  }
}

/**
 * @throws WebGpuUnavailableError for a device of the compatibility mode whose vertex shaders may not read
 *   the order and the records of splats. Browsers without that mode lack the limit.
 */
export function checkDevice({ limits: { maxStorageBuffersInVertexStage: most = 2 } }: GPUDevice): void {
  if (most < 2)
    throw new WebGpuUnavailableError(
      `The device is in WebGPU’s compatibility mode: maxStorageBuffersInVertexStage is ${most}, splats need 2. Request a core device.`,
    );
}

async function requestAdapter({
  gpu = globalThis.navigator?.gpu,
  powerPreference,
}: DeviceOptions): Promise<GPUAdapter> {
  if (!gpu) {
    throw new WebGpuUnavailableError(
      'WebGPU is not available here. It needs a recent Chrome, Edge, Safari 26 or Firefox, and a page served over ' +
        'https or from localhost; in Node, pass `gpu` from @websplatter/node.',
    );
  }
  // The first request after a browser's start returned null when the second did not.
  const adapter =
    (await gpu.requestAdapter({ powerPreference })) ??
    (await gpu.requestAdapter({ powerPreference: 'high-performance' })) ??
    (await gpu.requestAdapter());
  if (!adapter) {
    throw new WebGpuUnavailableError(
      'WebGPU found no GPU that it may use: the driver may be blocked, or hardware acceleration may be off.',
    );
  }
  return adapter;
}

/**
 * Returns a human-readable name of the adapter, e.g. "nvidia hopper" or "google swiftshader". wgpu
 * names vendors and devices by number, and mostly describes the adapter besides; Firefox names
 * nothing.
 *
 * @example
 * const label = adapterLabel(engine.device.adapterInfo);
 */
export function adapterLabel(info: GPUAdapterInfo): string {
  const { vendor, architecture, device, description, isFallbackAdapter } = given(info, {}, 'info');
  if (/^\d+$/.test(vendor)) return description || `GPU ${device} of vendor ${vendor}`;
  const name = [vendor, architecture || device].filter(Boolean).join(' ');
  const kind = isFallbackAdapter ? 'software renderer' : 'GPU';
  return name || description || `${kind} that the browser does not name`;
}

/**
 * Whether the adapter is a (slow) software renderer on the CPU.
 *
 * @example
 * if (isSoftwareAdapter(engine.device.adapterInfo)) console.warn('No GPU: frames take seconds.');
 */
export function isSoftwareAdapter(info: GPUAdapterInfo): boolean {
  const { isFallbackAdapter, architecture, description } = given(info, {}, 'info');
  return (
    isFallbackAdapter || /swiftshader|llvmpipe|lavapipe|basic render/i.test(`${architecture} ${description}`)
  );
}

/**
 * Most threads of a narrow subgroup, and the workgroup size of stages without barriers on devices
 * with narrow subgroups.
 */
export const NARROW_SUBGROUP = 8;

/**
 * Whether few threads of the device run in lockstep, as on drivers that run on a CPU, so that
 * barriers within a workgroup take long. False if the browser does not report subgroup sizes.
 */
export function hasNarrowSubgroups({ adapterInfo }: Pick<GPUDevice, 'adapterInfo'>): boolean {
  const { subgroupMaxSize } = adapterInfo;
  return subgroupMaxSize > 0 && subgroupMaxSize <= NARROW_SUBGROUP;
}

/** Numbers of threads that may run in lockstep, powers of two. */
export interface SubgroupSizes {
  readonly min: number;
  readonly max: number;
}

/** A device on which sorts may rank keys by ballots of subgroups. */
export interface BallotDevice extends SubgroupSizes {
  /** Most threads of a workgroup. */
  readonly workgroupThreads: number;
}

/**
 * The device if sorts are faster on it when they rank keys by ballots; otherwise null. Measured to
 * be faster on NVIDIA's GPUs only (evidence/frame-times-by-size.json).
 */
export function fasterBallots(device: GPUDevice): BallotDevice | null {
  return device.adapterInfo.vendor === 'nvidia' ? ballotDeviceOf(device) : null;
}

/** The device if it can rank keys by ballots; null without subgroups of known sizes. */
export function ballotDeviceOf({
  features,
  adapterInfo,
  limits,
}: Pick<GPUDevice, 'features' | 'adapterInfo' | 'limits'>): BallotDevice | null {
  const { subgroupMinSize: min, subgroupMaxSize: max } = adapterInfo;
  const { maxComputeInvocationsPerWorkgroup, maxComputeWorkgroupSizeX } = limits;
  if (!features.has('subgroups') || !(min > 0 && max >= min && max <= 128)) return null;
  return {
    min,
    max,
    workgroupThreads: Math.min(maxComputeInvocationsPerWorkgroup, maxComputeWorkgroupSizeX),
  };
}
