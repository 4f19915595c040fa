export { type FoundFile, findFile } from './found-file.ts';
export { createNodeGpu, type NodeGpu, type NodeGpuOptions } from './node-gpu.ts';
export { openFile, openStdin, streamFile } from './open-file.ts';
export { threadPort } from './thread.ts';
