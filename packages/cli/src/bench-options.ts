import type { AccuracySettings, Detail, SplatFormatName } from '@websplatter/core';
import { SYNTHETIC_MAX_SPLATS, SYNTHETIC_MIN_SPLATS, type SyntheticOptions } from '@websplatter/scenes';
import { type CameraOptions, parseCameraOptions } from './camera-options.ts';
import { UsageError, wrongValue } from './input-error.ts';
import {
  parseAccuracy,
  parseDegree,
  parseDetail,
  parseFormat,
  parseFrames,
  parseSeed,
  parseSize,
  parseStrictly,
} from './render-options.ts';

/** Arguments of `websplatter bench`. */
export interface BenchOptions {
  readonly scene:
    | {
        readonly kind: 'named';
        readonly name: string;
        /** Undefined: found by first bytes and names. */
        readonly format: SplatFormatName | undefined;
      }
    | ({ readonly kind: 'synthetic' } & Required<SyntheticOptions>);
  /** Undefined: a synthetic scene's own camera. */
  readonly cameraOptions: CameraOptions | undefined;
  readonly widthPx: number;
  readonly heightPx: number;
  /** Measured frames. */
  readonly frames: number;
  /** Angle that the camera covers in all of them. */
  readonly orbitDegrees: number;
  readonly accuracy: AccuracySettings;
  /** The settings as the user wrote them. */
  readonly accuracyLabel: string;
  readonly detail: Detail;
  readonly isJson: boolean;
}

/** Options that only synthetic scenes have. */
const SYNTHETIC_ONLY = ['degree', 'seed'] as const;

/** @throws UsageError or InvalidArgumentError that names the argument. */
export function parseBenchArguments(args: readonly string[]): BenchOptions {
  const { values, positionals } = parseStrictly(args, {
    synthetic: { type: 'string' },
    from: { type: 'string' },
    degree: { type: 'string' },
    seed: { type: 'string' },
    camera: { type: 'string' },
    up: { type: 'string' },
    size: { type: 'string', default: '1920x1080' },
    frames: { type: 'string', default: '100' },
    orbit: { type: 'string', default: '15' },
    accuracy: { type: 'string' },
    set: { type: 'string', multiple: true, default: [] },
    detail: { type: 'string', default: 'full' },
    json: { type: 'boolean', default: false },
  });
  const { synthetic } = values;
  if (positionals.length + Number(synthetic !== undefined) !== 1)
    throw new UsageError('SCENE', 'bench needs one SCENE, or --synthetic N');
  if (synthetic === undefined) {
    const useless = SYNTHETIC_ONLY.find((name) => values[name] !== undefined);
    if (useless) throw new UsageError(`--${useless}`, `--${useless} needs --synthetic N`);
  }
  const isOwnCamera = synthetic !== undefined && values.camera === undefined && values.up === undefined;
  const [widthPx, heightPx] = parseSize(values.size);
  return {
    scene:
      synthetic === undefined
        ? { kind: 'named', name: positionals[0], format: parseFormat(values.from) }
        : {
            kind: 'synthetic',
            splats: parseCount(synthetic),
            shDegree: parseDegree('--degree', values.degree ?? '3'),
            seed: parseSeed(values.seed ?? '1'),
          },
    cameraOptions: isOwnCamera ? undefined : parseCameraOptions(values),
    widthPx,
    heightPx,
    frames: parseFrames(values.frames),
    orbitDegrees: parseOrbit(values.orbit),
    ...parseAccuracy(values.accuracy, values.set),
    detail: parseDetail(values.detail),
    isJson: values.json,
  };
}

const FACTORS: Readonly<Record<string, number>> = { '': 1, k: 1e3, m: 1e6 };

/** Parses a number of splats such as 250000, 250k or 6M. */
function parseCount(text: string): number {
  const [, digits, unit] = /^(\d+(?:\.\d+)?)([kM]?)$/i.exec(text) ?? [];
  const count = digits === undefined ? Number.NaN : Math.round(Number(digits) * FACTORS[unit.toLowerCase()]);
  if (count >= SYNTHETIC_MIN_SPLATS && count <= SYNTHETIC_MAX_SPLATS) return count;
  const range = `${SYNTHETIC_MIN_SPLATS / 1e3}k to ${SYNTHETIC_MAX_SPLATS / 1e6}M`;
  throw wrongValue('--synthetic', text, `a number of splats, ${range}`);
}

function parseOrbit(text: string): number {
  const degrees = text.trim() === '' ? Number.NaN : Number(text);
  if (!(degrees > 0 && degrees <= 360)) throw wrongValue('--orbit', text, 'degrees above 0 and up to 360');
  return degrees;
}
