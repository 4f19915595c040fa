import type { AccuracySettings, Detail, SplatFormatName } from '@websplatter/core';
import { SYNTHETIC_MAX_SPLATS, SYNTHETIC_MIN_SPLATS, type SyntheticOptions } from '@websplatter/scenes';
import { UsageError } from './input-error.ts';
import {
  AUTO,
  accuracyOptions,
  byDefault,
  type CameraOptions,
  cameraOptions,
  checked,
  flag,
  list,
  parseArguments,
  SHARED,
  text,
} from './options.ts';

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
  const { values, positionals } = parseArguments(args, {
    synthetic: splatCount,
    from: SHARED.from,
    degree: SHARED.degree,
    seed: SHARED.seed,
    camera: text,
    up: SHARED.up,
    size: byDefault('1920x1080', SHARED.size),
    frames: byDefault('100', SHARED.frames),
    orbit: byDefault(
      '15',
      checked('degrees above 0 and up to 360', (found) =>
        Number(found) > 0 && Number(found) <= 360 ? Number(found) : undefined,
      ),
    ),
    accuracy: text,
    set: list,
    detail: SHARED.detail,
    json: flag,
  });
  const { synthetic, degree, seed, camera, up, frames, detail } = values;
  if (positionals.length + Number(synthetic !== undefined) !== 1)
    throw new UsageError('SCENE', 'bench needs one SCENE, or --synthetic N');
  if (synthetic === undefined) {
    const useless = SYNTHETIC_ONLY.find((name) => values[name] !== undefined);
    if (useless) throw new UsageError(`--${useless}`, `--${useless} needs --synthetic N`);
  }
  const isOwnCamera = synthetic !== undefined && camera === undefined && up === undefined;
  const [widthPx, heightPx] = values.size;
  return {
    scene:
      synthetic === undefined
        ? { kind: 'named', name: positionals[0], format: values.from }
        : { kind: 'synthetic', splats: synthetic, shDegree: degree ?? 3, seed: seed ?? 1 },
    cameraOptions: isOwnCamera ? undefined : cameraOptions({ camera: camera ?? AUTO, up }),
    ...{ widthPx, heightPx, frames, orbitDegrees: values.orbit },
    ...accuracyOptions(values.accuracy, values.set),
    ...{ detail, isJson: values.json },
  };
}

const FACTORS: Readonly<Record<string, number>> = { '': 1, k: 1e3, m: 1e6 };

/** A number of splats such as 250000, 250k or 6M. */
const splatCount = checked(
  `a number of splats, ${SYNTHETIC_MIN_SPLATS / 1e3}k to ${SYNTHETIC_MAX_SPLATS / 1e6}M`,
  (found) => {
    const [, digits, unit = ''] = /^(\d+(?:\.\d+)?)([kM]?)$/i.exec(found) ?? [];
    const count = Math.round(Number(digits) * FACTORS[unit.toLowerCase()]);
    return count >= SYNTHETIC_MIN_SPLATS && count <= SYNTHETIC_MAX_SPLATS ? count : undefined;
  },
);
