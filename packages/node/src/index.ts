export { createNodeGpu, type NodeGpu, type NodeGpuOptions } from './node-gpu.ts';
