// Proves: an orbit makes no object on the GPU after its first round.
import { createTestDevice, gpuTest } from '@websplatter/node/gpu-test';
import { beforeAll, describe, expect, vi } from 'vitest';
import type { SplatCloud } from '../clouds/splat-cloud.ts';
import { SplatEngine } from '../create-engine.ts';
import { type Camera, perspectiveCamera } from '../data/camera/camera.ts';
import { countedDevice, type MakingCalls } from '../testing/counted-device.ts';
import { randomSplats } from '../testing/random-splats.ts';

/** Number of shader texts made. */
let linked = 0;
vi.mock('../gpu/shaders/link-shader.ts', async (original) => {
  const module = await original<typeof import('../gpu/shaders/link-shader.ts')>();
  const linkShader: typeof module.linkShader = (...args) => {
    linked++;
    return module.linkShader(...args);
  };
  return { ...module, linkShader };
});

const SIZE = { widthPx: 32, heightPx: 32 };
/**
 * Frames of a round. A view that chooses between rasterisers has compared them after more than a
 * hundred, and is at rest.
 */
const FRAMES = { quads: 80, tiles: 80, auto: 200 };
/** Time of a round, ms: a view must give back room by the clock, not by this machine's speed. */
const ROUND_MS = 16_700;

let counted: ReturnType<typeof countedDevice>;
beforeAll(async () => {
  counted = countedDevice(await createTestDevice());
});

/**
 * A round about the origin, nearer on one side, where depths differ in more bits. All splats are in
 * sight everywhere: an `auto` view compares both rasterisers again when many come and go.
 *
 * @param round share of the round that has been gone, 0 to 1.
 */
function orbit(round: number): Camera {
  const angle = 2 * Math.PI * round;
  const distance = 4 + 1.8 * Math.cos(angle);
  return perspectiveCamera({
    position: [distance * Math.sin(angle), 0.4, distance * Math.cos(angle)],
    target: [0, 0, 0],
    fovYDegrees: 90,
    aspect: 1,
    near: 0.01,
  });
}

interface Drawn {
  /** Draws a frame and waits for the GPU. */
  draw(camera: Camera): Promise<void>;
  /** Resolves when shaders are there. */
  ready(): Promise<void>;
}

type Kind = 'SplatView' | 'EmbeddedView';

function viewOf(kind: Kind, engine: SplatEngine, cloud: SplatCloud): Drawn {
  const { device } = counted;
  const request = { clouds: [{ cloud }], ...SIZE };
  if (kind === 'SplatView') {
    const view = engine.createView();
    return {
      draw: async (camera) => {
        view.render({ ...request, camera });
        await view.whenDrawn();
        await device.queue.onSubmittedWorkDone();
      },
      ready: () => view.whenDrawn(),
    };
  }
  const view = engine.createEmbeddedView();
  const size = [SIZE.widthPx, SIZE.heightPx];
  const usage = GPUTextureUsage.RENDER_ATTACHMENT | GPUTextureUsage.TEXTURE_BINDING;
  const pass = {
    color: device.createTexture({ size, usage, format: 'rgba16float' }),
    depth: device.createTexture({ size, usage, format: 'depth24plus' }),
    xPx: 0,
    yPx: 0,
  };
  const depth = { mapping: 'projection', compare: 'less-equal' } as const;
  const draw = async (camera: Camera) => {
    if (!view.prepare({ ...request, camera, depth })) return;
    const encoder = device.createCommandEncoder();
    view.draw(encoder, pass);
    device.queue.submit([encoder.finish()]);
    await device.queue.onSubmittedWorkDone();
  };
  return {
    draw,
    ready: async () => {
      if (view.shape) return;
      await new Promise<void>((resolve) => {
        view.onReady = resolve;
      });
    },
  };
}

describe.each(['SplatView', 'EmbeddedView'] as const)('frames of an orbit in a %s', (kind) => {
  for (const rasterizer of ['quads', 'tiles', 'auto'] as const) {
    gpuTest(`by ${rasterizer} make nothing after the first round`, async () => {
      const engine = await SplatEngine.create({
        device: counted.device,
        accuracy: { preset: 'balanced', rasterizer },
      });
      const cloud = engine.add(randomSplats({ count: 500, shDegree: 1 }));
      const view = viewOf(kind, engine, cloud);
      const frames = FRAMES[rasterizer];
      let passedMs = 0;
      const now = performance.now.bind(performance);
      const beganMs = now();
      // Time on this machine counts for so little that a round lasts as long on a busy one, and
      // still tells frames apart.
      const clock = vi
        .spyOn(performance, 'now')
        .mockImplementation(() => passedMs + (now() - beganMs) / 1000);
      await view.draw(orbit(0));
      await view.ready();
      const made: Partial<MakingCalls & { linked: number }>[] = [];
      for (let round = 0; round < 2; round++) {
        const before = { ...counted.calls, linked };
        for (let frame = 0; frame < frames; frame++) {
          passedMs += ROUND_MS / frames;
          await view.draw(orbit(frame / frames));
        }
        made.push(difference({ ...counted.calls, linked }, before));
      }
      clock.mockRestore();
      // Keys became wider; their memory is kept.
      expect(made[0].createBuffer).toBeGreaterThan(0);
      expect(made[1]).toEqual({});
      engine.destroy();
    });
  }
});

/** The entries that differ, and by how much. */
function difference<Counts extends Record<string, number>>(after: Counts, before: Counts): Partial<Counts> {
  const entries = Object.entries(after).map(([name, count]) => [name, count - before[name]] as const);
  return Object.fromEntries(entries.filter(([, count]) => count !== 0)) as Partial<Counts>;
}
