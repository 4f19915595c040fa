import type { DeviceCase, HardCase, HardCloud } from '../hard-case.ts';
import { amongOrdinary, frontAndOblique, frontOnly } from '../make-cases.ts';
import { logitOf, ordinarySplats, type SplatValues, splatsOf, withRandomSh } from '../make-splats.ts';

const HARD: SplatValues = {
  position: [0.2, -0.3, 1.6],
  logScales: [0.1, -2, -4],
  rotation: [0.7, 0.2, 0.5, -0.4],
  opacityLogit: logitOf(0.7),
  color: [1, 0.4, 0.1],
};

/** Splats of degree 3, which need the largest shaders. */
const directional = (): readonly HardCloud[] => [
  { set: splatsOf(withRandomSh([...ordinarySplats(), HARD], 3, 0.2), { shDegree: 3 }) },
];

type DeviceValues = Pick<DeviceCase, 'name' | 'without' | 'breaks'> & Partial<DeviceCase>;

/** Defaults to degree 0 and one camera, since every device compiles its shaders anew. */
const deviceCase = (values: DeviceValues): DeviceCase => ({
  kind: 'device',
  group: 'device',
  clouds: amongOrdinary([HARD]),
  cameras: frontOnly,
  ...values,
});

export const DEVICE_CASES: readonly HardCase[] = [
  deviceCase({
    name: 'device-default-limits',
    without: [],
    breaks:
      'More storage buffers per stage, or larger bindings, are used than every device has, without asking.',
    clouds: directional,
    cameras: frontAndOblique,
  }),
  deviceCase({
    name: 'device-workgroup-storage-16-kib',
    without: [],
    breaks: 'Nine-bit digits take more workgroup memory per thread than the 16 KiB that every device has.',
    // Depths differ by a factor of about 1000, for which the sort uses its largest digits.
    clouds: amongOrdinary([HARD, { ...HARD, position: [0.01, 0.01, 4.97], logScales: [-6, -7, -8] }]),
  }),
  deviceCase({
    name: 'device-no-timestamp-query',
    without: ['timestamp-query'],
    breaks: 'Timing is taken for granted, and without it there is no image either.',
  }),
  deviceCase({
    name: 'device-no-float32-blendable',
    without: ['float32-blendable'],
    breaks:
      'A float32 target is made although the device cannot blend it, or colours meant for it overflow another.',
    clouds: amongOrdinary([HARD, { ...HARD, position: [-1, 0.8, 1.5], color: [1e6, 0.3, 2e5] }]),
  }),
  deviceCase({
    name: 'device-no-subgroups',
    without: ['subgroups'],
    breaks: 'Scans and sorts rely on subgroups, or on a size of them that this device does not have.',
  }),
  deviceCase({
    name: 'device-no-shader-f16',
    without: ['shader-f16'],
    breaks: 'Shaders declare half precision that the device lacks.',
  }),
  deviceCase({
    name: 'device-no-optional-features',
    without: ['timestamp-query', 'float32-blendable', 'subgroups', 'shader-f16', 'core-features-and-limits'],
    breaks: 'Features are tested one by one, but never all missing at once.',
    clouds: directional,
  }),
];
