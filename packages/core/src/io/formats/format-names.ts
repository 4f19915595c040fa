import { checkOneOf } from '../../data/packing/check-precision.ts';

/**
 * Names of the formats that are read, for the option `format`: those of `SPLAT_FORMATS`, without
 * the code that knows these.
 */
const FORMAT_NAMES = [
  'compressed-ply',
  'ply',
  'ply-points',
  'spz',
  'sog',
  'gltf',
  'rad',
  'splat',
  'ksplat',
  'bricks',
  'zip',
  'gzip',
] as const;

/** Name of a format that is read, as the option `format` takes it. */
export type SplatFormatName = (typeof FORMAT_NAMES)[number];

/** @throws InvalidArgumentError 'format' for anything but undefined and a name of a format. */
export function checkFormat(format: string | undefined): void {
  checkOneOf('format', format, FORMAT_NAMES);
}
