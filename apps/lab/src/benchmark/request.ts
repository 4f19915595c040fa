import {
  type AccuracySettings,
  DEFAULT_ACCURACY,
  InvalidArgumentError,
  isAccuracyTarget,
  resolveAccuracy,
} from '@websplatter/core';
import { splitAccuracy } from '@websplatter/kit/split-accuracy';

/** The benchmark that the address asks for: the same on every device, in a window of any size. */
export interface BenchmarkRequest {
  readonly widthPx: number;
  readonly heightPx: number;
  /** Measured frames. */
  readonly frames: number;
  /** Angle that the camera covers in all of them. */
  readonly orbitDegrees: number;
  readonly accuracy: AccuracySettings;
  /** The settings as the address has them. */
  readonly accuracyLabel: string;
}

/** As `websplatter bench` measures where nothing else is said; names as in the address. */
export const BENCHMARK_DEFAULTS = {
  size: '1920x1080',
  frames: '100',
  orbit: '15',
  accuracy: DEFAULT_ACCURACY,
} as const;

/** No WebGPU device has larger textures. */
const MOST_PX = 32_768;
const MOST_FRAMES = 10_000;

/**
 * Reads `?bench&size=1920x1080&frames=100&orbit=15&accuracy=balanced`. Defaults are the same on all
 * devices, so that their reports can be compared.
 *
 * @throws InvalidArgumentError that names the part that cannot be read.
 */
export function benchmarkRequest(query: URLSearchParams): BenchmarkRequest {
  const accuracyLabel = query.get('accuracy') ?? BENCHMARK_DEFAULTS.accuracy;
  return {
    ...readSize(query.get('size') ?? BENCHMARK_DEFAULTS.size),
    frames: readNumber('frames', query.get('frames') ?? BENCHMARK_DEFAULTS.frames, {
      isInRange: (value) => Number.isInteger(value) && value >= 1 && value <= MOST_FRAMES,
      range: `a whole number from 1 to ${MOST_FRAMES}`,
    }),
    orbitDegrees: readNumber('orbit', query.get('orbit') ?? BENCHMARK_DEFAULTS.orbit, {
      isInRange: (value) => value > 0 && value <= 360,
      range: 'degrees above 0 and up to 360',
    }),
    accuracy: readAccuracy(accuracyLabel),
    accuracyLabel,
  };
}

/** Reads `fast,sortKeyBits:32`: a preset, or none, and changes of it. */
function readAccuracy(text: string): AccuracySettings {
  const { preset, asked } = splitAccuracy(text);
  if (isAccuracyTarget(asked)) {
    const message = `accuracy is ${text}; a benchmark needs settings that are the same on every device, such as accuracy=balanced.`;
    throw new InvalidArgumentError('accuracy', message);
  }
  // Names and values may be wrong: resolveAccuracy checks them.
  return resolveAccuracy({ ...asked, preset });
}

function readSize(text: string): Pick<BenchmarkRequest, 'widthPx' | 'heightPx'> {
  const [widthPx, heightPx] = (/^(\d+)[x×](\d+)$/i.exec(text) ?? []).slice(1).map(Number);
  const isSize = [widthPx, heightPx].every((px) => px >= 1 && px <= MOST_PX);
  if (isSize) return { widthPx, heightPx };
  const message = `size is ${text}; write width and height in pixels, 1 to ${MOST_PX}, such as size=1920x1080.`;
  throw new InvalidArgumentError('size', message);
}

function readNumber(
  name: string,
  text: string,
  { isInRange, range }: { readonly isInRange: (value: number) => boolean; readonly range: string },
): number {
  const value = text.trim() === '' ? Number.NaN : Number(text);
  if (isInRange(value)) return value;
  throw new InvalidArgumentError(name, `${name} is ${text}; it must be ${range}.`);
}
