import { WebGpuUnavailableError } from '../errors.ts';

/** Where WebGPU is to be had; `navigator.gpu` in a browser. */
export interface DeviceOptions {
  readonly gpu?: GPU;
  /** An adapter that no device has been requested of yet: each gives one. */
  readonly adapter?: GPUAdapter;
  readonly powerPreference?: GPUPowerPreference;
  /** What a renderer that shares the device can use besides: requested where the adapter has it. */
  readonly optionalFeatures?: readonly GPUFeatureName[];
  /** Limits that a renderer that shares the device needs. */
  readonly requiredLimits?: Readonly<Record<string, number>>;
}

/** Used where the adapter has them; nothing needs them. */
const OPTIONAL_FEATURES: readonly GPUFeatureName[] = [
  'timestamp-query',
  'float32-blendable' as GPUFeatureName,
  // Without it some adapters hand out a device of compatibility mode.
  'core-features-and-limits' as GPUFeatureName,
];

/** Limits that decide how large a scene may be: as much as the adapter has. */
const WIDENED_LIMITS = ['maxBufferSize', 'maxStorageBufferBindingSize'] as const;

/**
 * A device with what the engine, and who shares the device, can use of the adapter.
 *
 * @throws WebGpuUnavailableError where there is no WebGPU, no adapter or no device.
 */
export async function requestSplatDevice(options: DeviceOptions = {}): Promise<GPUDevice> {
  const adapter = options.adapter ?? (await requestAdapter(options));
  const wanted = new Set([...OPTIONAL_FEATURES, ...(options.optionalFeatures ?? [])]);
  const requiredFeatures = [...wanted].filter((feature) => adapter.features.has(feature));
  const widened = Object.fromEntries(WIDENED_LIMITS.map((limit) => [limit, adapter.limits[limit]]));
  const requiredLimits = { ...options.requiredLimits, ...widened };
  try {
    return await adapter.requestDevice({ label: 'websplatter', requiredFeatures, requiredLimits });
  } catch (cause) {
    const message = `The WebGPU adapter gave no device: ${(cause as Error).message}`;
    throw new WebGpuUnavailableError(message, { cause });
  }
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
  // The first request after a browser's start has been seen to answer null where the second did not.
  const adapter =
    (await gpu.requestAdapter({ powerPreference })) ??
    (await gpu.requestAdapter({ powerPreference: 'high-performance' })) ??
    (await gpu.requestAdapter());
  if (!adapter) {
    throw new WebGpuUnavailableError(
      'WebGPU is here but found no GPU that it may use: the driver may be blocked, or hardware acceleration turned off.',
    );
  }
  return adapter;
}

/** What a person would call the adapter, e.g. "nvidia hopper" or "google swiftshader". */
export function adapterLabel({ vendor, architecture, device, description }: GPUAdapterInfo): string {
  const name = [vendor, architecture || device].filter(Boolean).join(' ');
  return name || description || 'unknown adapter';
}

/** Whether the adapter draws on the CPU, slowly. */
export function isSoftwareAdapter({ isFallbackAdapter, architecture, description }: GPUAdapterInfo): boolean {
  return (
    isFallbackAdapter || /swiftshader|llvmpipe|lavapipe|basic render/i.test(`${architecture} ${description}`)
  );
}
