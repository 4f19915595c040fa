import type { DeviceCase, HardCase } from '../hard-case.ts';
import { frontAndOblique } from '../make-cases.ts';
import { logitOf, ordinarySplats, type SplatValues, splatsOf, withRandomSh } from '../make-splats.ts';

const HARD: SplatValues = {
  position: [0.2, -0.3, 1.6],
  logScales: [0.1, -2, -4],
  rotation: [0.7, 0.2, 0.5, -0.4],
  opacityLogit: logitOf(0.7),
  color: [1, 0.4, 0.1],
};

const deviceCase = (
  name: string,
  without: readonly string[],
  breaks: string,
  bounds?: DeviceCase['bounds'],
): DeviceCase => ({
  kind: 'device',
  group: 'device',
  name,
  without,
  breaks,
  clouds: () => [{ set: splatsOf(withRandomSh([...ordinarySplats(), HARD], 3, 0.2), { shDegree: 3 }) }],
  cameras: frontAndOblique,
  bounds,
});

export const DEVICE_CASES: readonly HardCase[] = [
  deviceCase(
    'device-default-limits',
    [],
    'More storage buffers per stage, or larger bindings, are used than every device has, without asking for them.',
  ),
  deviceCase(
    'device-workgroup-storage-16-kib',
    [],
    // Depths here differ by more than a factor of two, for which the sort takes its largest digits.
    'Nine-bit digits take more workgroup memory per thread than the 16 KiB that every device has.',
  ),
  deviceCase(
    'device-no-timestamp-query',
    ['timestamp-query'],
    'Timing is taken for granted, and without it there is no picture either.',
  ),
  deviceCase(
    'device-no-float32-blendable',
    ['float32-blendable'],
    'A float32 target is made although the device cannot blend it.',
  ),
  deviceCase(
    'device-no-subgroups',
    ['subgroups'],
    'Scans and sorts rely on subgroups, or on a size of them that this device does not have.',
  ),
  deviceCase('device-no-shader-f16', ['shader-f16'], 'Shaders declare half precision that the device lacks.'),
  deviceCase(
    'device-no-optional-features',
    ['timestamp-query', 'float32-blendable', 'subgroups', 'shader-f16', 'core-features-and-limits'],
    'Features are tested one by one, but never all missing at once.',
  ),
];
