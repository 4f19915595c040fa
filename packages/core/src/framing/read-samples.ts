import { flushFeatures, writerOf } from '../clouds/cloud-feature.ts';
import type { DispatchContext } from '../clouds/ingest/dispatches.ts';
import { gatherGeometry } from '../clouds/ingest/sample-centres.ts';
import { MEMORY_ADVICE, type SplatCloud } from '../clouds/splat-cloud.ts';
import type { CoarseSplats, SplatSpan } from '../clouds/stream/cloud-stream.ts';
import { SplatSourceError } from '../data/errors.ts';
import { CHUNK_SPLATS } from '../data/layout/constants.ts';
import { logScalesOf } from '../data/packing/chunks.ts';
import { GEOMETRY_WORDS } from '../data/packing/geometry.ts';
import { Pipelines } from '../gpu/pipelines.ts';
import { ingestGather } from '../stages/gather/gather.ts';
import type { SampledSplats } from './samples.ts';
import { type ChosenSplats, MOST_SAMPLES, pickWords, shareSamples } from './samples.ts';

/** A cloud with its instances in the world. */
export interface PlacedCloud {
  readonly cloud: SplatCloud;
  /**
   * Per instance: a matrix from cloud to world, 16 numbers, column-major; and a factor of opacity.
   */
  readonly matrices: readonly ArrayLike<number>[];
  readonly opacities: readonly number[];
}

/**
 * Reads at most `most` splats over all instances of all clouds, spread evenly in storage order.
 * Streamed scenes give a coarse approximation of the whole scene.
 *
 * @throws DestroyedError if a cloud, its engine or its device ends first; GpuLimitError if the
 *   device lacks memory; SplatSourceError for a preview whose splats are being reordered, and for a
 *   streamed scene that cannot be read; the signal's reason.
 */
export async function readSamples(
  placed: readonly PlacedCloud[],
  signal: AbortSignal | undefined,
  most = MOST_SAMPLES,
): Promise<{ readonly samples: readonly SampledSplats[]; readonly weight: number }> {
  const ready = await Promise.all(placed.map((each) => prepared(each, signal)));
  signal?.throwIfAborted();
  // From here on without yielding, because splats may move whenever this thread yields.
  const counts = ready.map(({ cloud, coarse, matrices }) => ({
    splats: coarse ? coarse.count : cloud.count,
    instances: matrices.length,
  }));
  const { chosen, weight } = shareSamples(counts, most);
  const samples = await Promise.all(ready.map((each, i) => readCloud(each, chosen[i])));
  signal?.throwIfAborted();
  return { samples, weight };
}

interface ReadyCloud extends PlacedCloud {
  readonly context: DispatchContext;
  /** Null if all splats are on the GPU. */
  readonly coarse: CoarseSplats | null;
}

async function prepared(placed: PlacedCloud, signal: AbortSignal | undefined): Promise<ReadyCloud> {
  const { cloud } = placed;
  const { device } = cloud;
  await cloud.uploaded;
  cloud.checkUsable();
  const pipelines = new Pipelines(device);
  const [coarse] = await Promise.all([cloud.stream?.coarse(signal), pipelines.prepare([ingestGather])]).catch(
    (error) => {
      cloud.checkUsable();
      throw error;
    },
  );
  cloud.checkUsable();
  const dispatchRow = device.limits.maxComputeWorkgroupsPerDimension;
  const context = { device, pipelines, memory: cloud.planes.place.memory, dispatchRow };
  return { ...placed, context, coarse: coarse ?? null };
}

async function readCloud(ready: ReadyCloud, { splats, instances }: ChosenSplats): Promise<SampledSplats> {
  const { cloud, coarse, matrices, opacities } = ready;
  cloud.checkUsable();
  if (cloud.isPreview && cloud.isHeld)
    throw new SplatSourceError(
      cloud.name,
      'its splats are being put in order: frame the preview that comes next, or the loaded cloud.',
    );
  // Edits since the last frame may not be uploaded yet.
  flushFeatures(cloud);
  // Splats that the GPU makes keep their slots, so this may yield for them.
  const writer = writerOf(cloud);
  const made = writer?.readChunks ? await writer.readChunks() : null;
  const spans = coarse?.spans() ?? [
    { first: 0, count: cloud.count, chunks: made ?? new Float32Array(cloud.chunks) },
  ];
  const { slots, logScales } = locate(splats, spans);
  const { precision, words } = coarse?.words
    ? { precision: coarse.precision, words: pickWords(coarse.words, GEOMETRY_WORDS[coarse.precision], slots) }
    : await gathered(ready, slots);
  return {
    precision,
    words,
    logScales,
    instances,
    origin: cloud.origin,
    matrices: Float64Array.from(matrices.flatMap((matrix) => Array.from(matrix))),
    opacities: Float64Array.from(opacities),
  };
}

/** Slots of splats, which are given in ascending order, and their log scale ranges. */
function locate(
  splats: Uint32Array,
  spans: readonly SplatSpan[],
): Pick<SampledSplats, 'logScales'> & { readonly slots: Uint32Array<ArrayBuffer> } {
  const slots = new Uint32Array(splats.length);
  const logScales = new Float32Array(2 * splats.length);
  let start = 0;
  let span = 0;
  for (const [i, splat] of splats.entries()) {
    while (splat - start >= spans[span].count) start += spans[span++].count;
    const { first, chunks } = spans[span];
    const { min, step } = logScalesOf(chunks, Math.floor((splat - start) / CHUNK_SPLATS));
    slots[i] = first + splat - start;
    logScales[2 * i] = min;
    logScales[2 * i + 1] = step;
  }
  return { slots, logScales };
}

/** Reads the packed geometry of splats if the cloud holds it, else `f32`. */
async function gathered(
  { cloud, context }: ReadyCloud,
  slots: Uint32Array<ArrayBuffer>,
): Promise<Pick<SampledSplats, 'precision' | 'words'>> {
  const { planes } = cloud;
  const precision = planes.geometryPlane('packed') ? 'packed' : 'f32';
  if (slots.length === 0) return { precision, words: new Uint32Array(0) };
  const sampled = {
    ranges: planes.ranges,
    geometry: planes.geometryPlane(precision)!,
    geometryPrecision: precision,
  } as const;
  const { result, checked } = context.memory.guard(`The framing of ${cloud.name}`, MEMORY_ADVICE, () => {
    const reading = gatherGeometry(context, sampled, slots);
    // Awaited only if the allocation succeeded.
    reading.catch(() => {});
    return reading;
  });
  await checked;
  return { precision, words: await result };
}
