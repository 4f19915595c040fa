/** Reference of repack-sh: the host's own packer, which divides in float64. */
export { repackHarmonics as repackSh } from '../data/packing/repack-harmonics.ts';
