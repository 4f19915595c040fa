import { ACCUMULATE_CASES } from './groups/accumulate.ts';
import { CAMERA_CASES } from './groups/camera.ts';
import { COLOUR_CASES } from './groups/colour.ts';
import { COUNTS_CASES } from './groups/counts.ts';
import { DEPTH_CASES } from './groups/depth.ts';
import { DEVICE_CASES } from './groups/device.ts';
import { FRAMING_CASES } from './groups/framing.ts';
import { INPUT_CASES } from './groups/input.ts';
import { OPACITY_CASES } from './groups/opacity.ts';
import { PALETTE_CASES } from './groups/palette.ts';
import { PLACEMENT_CASES } from './groups/placement.ts';
import { ROTATION_CASES } from './groups/rotation.ts';
import { SCALE_CASES } from './groups/scale.ts';
import { SORT_CASES } from './groups/sort.ts';
import { TILES_CASES } from './groups/tiles.ts';
import { WORLD_CASES } from './groups/world.ts';
import type { HardCase } from './hard-case.ts';

/** Every hard case, group by group in the order of `HARD_CASE_GROUPS`. */
export const HARD_CASES: readonly HardCase[] = [
  ...SCALE_CASES,
  ...ROTATION_CASES,
  ...OPACITY_CASES,
  ...INPUT_CASES,
  ...DEPTH_CASES,
  ...CAMERA_CASES,
  ...WORLD_CASES,
  ...PLACEMENT_CASES,
  ...COLOUR_CASES,
  ...PALETTE_CASES,
  ...ACCUMULATE_CASES,
  ...TILES_CASES,
  ...COUNTS_CASES,
  ...SORT_CASES,
  ...FRAMING_CASES,
  ...DEVICE_CASES,
];
