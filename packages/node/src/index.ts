export { createNodeGpu, type NodeGpu, type NodeGpuOptions } from './node-gpu.ts';
export { openFile } from './open-file.ts';
