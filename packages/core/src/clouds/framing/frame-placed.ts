import { CodeUnavailableError } from '../../data/errors.ts';
import type { FramingWishes, SceneFraming } from '../../data/framing/scene-framing.ts';
import { buildOfPieces } from '../build-of-geometry.ts';
import type { FramingPlan, FramingResult } from './framing-builder.ts';
import { type PlacedCloud, readSamples } from './read-samples.ts';
import type { SampledSplats } from './sampled-splats.ts';

/**
 * Frames placed clouds, in a worker where one can start. It does not take turns with loads: the
 * first picture of their previews waits for it.
 *
 * @returns null if no splat can be seen.
 * @throws as `readSamples`; WebSplatterError `worker-failed` if the worker dies.
 */
export async function framePlaced(
  placed: readonly PlacedCloud[],
  wishes: FramingWishes,
  signal: AbortSignal | undefined,
): Promise<SceneFraming | null> {
  const { samples, weight } = await readSamples(placed, signal);
  if (samples.every(({ instances }) => instances.length === 0)) return null;
  const { framing } = await buildOfPieces<FramingPlan, FramingResult, SampledSplats>(samples, {
    what: 'framing',
    subject: 'The framing of a scene',
    plan: { wishes, weight },
    // In one piece, since this is the form that bundlers recognise.
    makeWorker: () => new Worker(new URL('./framing-worker.ts', import.meta.url), { type: 'module' }),
    make: async (plan) => new (await loadBuilder()).FramingBuilder(plan, signal),
    signal,
  });
  return framing;
}

/** Pages whose workers start do without it: it is most of the code. */
function loadBuilder(): Promise<typeof import('./framing-builder.ts')> {
  return import('./framing-builder.ts').catch((cause) => {
    throw new CodeUnavailableError('framing', { cause });
  });
}
