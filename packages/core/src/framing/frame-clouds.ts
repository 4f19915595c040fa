import { buildOfPieces } from '../clouds/build-of-geometry.ts';
import { checkMatrix } from '../data/camera/camera.ts';
import { fetched } from '../data/errors.ts';
import { CLOUD, checkKind, given, wrongArgument } from '../data/given.ts';
import { checkInstances, worldMatrices } from '../frame/plan/cloud-instances.ts';
import type { CloudInstance } from '../frame/plan/frame-request.ts';
import type { FramingPlan, FramingResult } from './framing-builder.ts';
import { checkFramingOptions, type FramingOptions, framingWishes } from './framing-wishes.ts';
import { type PlacedCloud, readSamples } from './read-samples.ts';
import type { SampledSplats } from './samples.ts';
import type { FramingWishes, SceneFraming } from './scene-framing.ts';

/** Options of `frameScene`. */
export interface FrameSceneOptions extends FramingOptions {
  /** Calls the work off. */
  readonly signal?: AbortSignal;
}

/** See `frameScene`. */
export async function frameClouds(
  clouds: readonly CloudInstance[],
  options: FrameSceneOptions,
): Promise<SceneFraming | null> {
  const plan = planFraming(clouds, options);
  options.signal?.throwIfAborted();
  return plan && framePlaced(plan.placed, plan.wishes, options.signal);
}

/**
 * Returns the clouds to frame, and the wishes; null if no cloud is drawn.
 *
 * @throws InvalidArgumentError naming the argument, DestroyedError, GpuLimitError.
 */
export function planFraming(
  clouds: readonly CloudInstance[],
  options: FrameSceneOptions,
): { readonly placed: readonly PlacedCloud[]; readonly wishes: FramingWishes } | null {
  checkFraming(clouds, given(options));
  const placed = clouds.map(placedCloud).filter(({ opacities }) => opacities.some((opacity) => opacity > 0));
  if (placed.length === 0) return null;
  const parts = placed.map(({ cloud, matrices }) => ({ facts: cloud.facts, matrix: matrices[0] }));
  return { placed, wishes: framingWishes(parts, options) };
}

function checkFraming(clouds: readonly CloudInstance[], options: FrameSceneOptions): void {
  checkFramingOptions(options);
  checkKind('clouds', clouds, 'a list');
  for (const instance of clouds) {
    const { cloud, modelMatrix, instances, opacity = 1 } = given(instance, {}, 'clouds');
    given(cloud, CLOUD, 'cloud').checkUsable();
    if (modelMatrix) checkMatrix('modelMatrix', modelMatrix, cloud.name);
    if (instances) checkInstances(instances, cloud);
    if (!(typeof opacity === 'number' && opacity >= 0 && opacity <= 1))
      throw wrongArgument('opacity', opacity, 'a number, 0…1', cloud.name);
  }
}

function placedCloud({ cloud, modelMatrix, instances, opacity = 1 }: CloudInstance): PlacedCloud {
  const matrices = worldMatrices({
    modelMatrix: modelMatrix ?? undefined,
    instances: instances ?? undefined,
  });
  const opacities = matrices.map((_, i) => opacity * (instances?.opacities?.[i] ?? 1));
  return { cloud, matrices, opacities };
}

/**
 * Frames placed clouds, in a worker where one can start. It does not take turns with loads: the
 * first picture of their previews waits for it.
 *
 * @returns null if no splat can be seen.
 * @throws as `readSamples`; WebSplatterError `worker-failed` if the worker dies.
 */
async function framePlaced(
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
  return fetched('framing', import('./framing-builder.ts'));
}
