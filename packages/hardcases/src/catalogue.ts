import { OPACITY_CASES } from './groups/opacity.ts';
import { ROTATION_CASES } from './groups/rotation.ts';
import { SCALE_CASES } from './groups/scale.ts';
import type { HardCase } from './hard-case.ts';

/** Every hard case, group by group in the order of `HARD_CASE_GROUPS`. */
export const HARD_CASES: readonly HardCase[] = [...SCALE_CASES, ...ROTATION_CASES, ...OPACITY_CASES];
