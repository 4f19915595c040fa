// Proves: the layer and the host's depth are kept as long as frames need them, and then freed.
import { expect, test, vi } from 'vitest';
import { internAccuracy } from '../../data/accuracy/accuracy.ts';
import { GpuMemory } from '../../gpu/gpu-memory.ts';
import type { FramePlan } from '../plan/frame-plan.ts';
import { type PartContext, SharedMemory } from './frame-part.ts';
import { Layer } from './layer.ts';

vi.stubGlobal('GPUBufferUsage', { COPY_DST: 8, UNIFORM: 64, STORAGE: 128 });
vi.stubGlobal('GPUTextureUsage', {
  COPY_SRC: 1,
  TEXTURE_BINDING: 4,
  STORAGE_BINDING: 8,
  RENDER_ATTACHMENT: 16,
});

test('the depth of the host stays when the layer changes, and goes once nothing tests it', () => {
  const freed: string[] = [];
  const made = ({ label }: { label: string }) => ({ destroy: () => freed.push(label) });
  const device = {
    limits: { maxBufferSize: 1024, maxStorageBufferBindingSize: 1024 },
    createBuffer: made,
    createTexture: ({
      label,
      size,
      format,
      usage,
    }: {
      label: string;
      size: object;
      format: string;
      usage: number;
    }) => ({
      ...made({ label }),
      ...size,
      format,
      usage,
    }),
  } as unknown as GPUDevice;
  const shared = new SharedMemory();
  const layer = new Layer({ memory: new GpuMemory(device), shared } as PartContext);
  const accuracy = internAccuracy({ preset: 'balanced', rasterizer: 'quads', resolutionScale: 1 });
  /** What a frame of this width frees. */
  const freedBy = (widthPx: number, depth: object | null) => {
    const shape = { accuracy, rasterizer: 'quads', depth, output: { kind: 'image' } };
    const change = layer.fit({ layer: { widthPx, heightPx: 8 }, shape } as FramePlan);
    change?.free();
    change?.make();
    return freed.splice(0);
  };
  expect(freedBy(8, { layerFormat: null })).toEqual([]);
  const { hostDepth } = shared.resources;
  expect(hostDepth).toBeDefined();
  expect(freedBy(16, { layerFormat: null })).toEqual(['splat layer']);
  expect(shared.resources.hostDepth).toBe(hostDepth);
  expect(freedBy(16, null)).toEqual(['frame hostDepth']);
  expect(shared.resources.hostDepth).toBeNull();
});
