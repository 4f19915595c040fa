/** Twin of shaders/stages/repack-sh.wgsl: the host's own packer, which divides in float64. */
export { repackShRest as repackSh } from '../packing/sh-rest.ts';
