import { CHUNK_SPLATS } from '../../data/layout/constants.ts';
import { PermuteParameters } from '../../data/layout/packing-structs.ts';
import { GEOMETRY_WORDS } from '../../data/packing/geometry.ts';
import { boundsSamples } from '../../data/packing/packed-cloud.ts';
import { sampledRows } from '../../data/packing/position-sample.ts';
import type { GeometryPrecision } from '../../data/packing/precision.ts';
import { readWords } from '../../gpu/read-buffer.ts';
import { ingestGather } from '../../stages/gather/gather.ts';
import type { PageRange, Plane } from '../cloud-planes.ts';
import { type DispatchContext, Dispatches } from './dispatches.ts';

/** Geometry of `count` splats or slots. */
export interface SampledGeometry {
  readonly count: number;
  readonly ranges: readonly PageRange[];
  readonly geometry: Plane;
  readonly geometryPrecision: GeometryPrecision;
}

/**
 * Reads a sample of centres for robust bounds. ingest-gather must have been compiled.
 *
 * @returns their stored x, y and z.
 */
export function sampleCentres(context: DispatchContext, sampled: SampledGeometry): Promise<Float32Array[]> {
  return gatherCentres(context, sampled, boundsSamples(sampled.count));
}

/**
 * Reads the same sample of kept rows that a `PositionSample` would keep. ingest-gather must have
 * been compiled.
 *
 * @param dropMask a bit per row: 1 if the row was dropped.
 * @param kept count of kept rows.
 * @returns their x, y and z, as in the file.
 */
export async function samplePositions(
  context: DispatchContext,
  sampled: SampledGeometry,
  dropMask: GPUBuffer,
  kept: number,
): Promise<Float32Array[]> {
  const ranks = sampledRows(kept);
  if (kept === sampled.count) return gatherCentres(context, sampled, ranks);
  return gatherCentres(context, sampled, keptRows(ranks, await readWords(context.device, dropMask)));
}

/** Converts ascending ranks among kept rows, whose bits are 0, into rows. */
function keptRows(ranks: Uint32Array, mask: Uint32Array): Uint32Array<ArrayBuffer> {
  const rows = new Uint32Array(ranks.length);
  let [found, rank] = [0, 0];
  for (let row = 0; found < rows.length; row++) {
    if ((mask[row >>> 5] >>> (row & 31)) & 1) continue;
    if (ranks[found] === rank++) rows[found++] = row;
  }
  return rows;
}

/** Reads x, y and z of the splats or slots at `indices`. */
function gatherCentres(
  context: DispatchContext,
  sampled: SampledGeometry,
  indices: Uint32Array<ArrayBuffer>,
): Promise<Float32Array[]> {
  const parts = [0, 1, 2].map((word) => ({ word, words: 1 }));
  return gather(context, sampled, indices, parts).then((axes) =>
    axes.map(({ buffer }) => new Float32Array(buffer)),
  );
}

/**
 * Reads all words of the splats or slots at `indices`, in this order. ingest-gather must have been
 * compiled.
 */
export async function gatherGeometry(
  context: DispatchContext,
  sampled: Omit<SampledGeometry, 'count'>,
  indices: Uint32Array<ArrayBuffer>,
): Promise<Uint32Array<ArrayBuffer>> {
  const parts = [{ word: 0, words: GEOMETRY_WORDS[sampled.geometryPrecision] }];
  const [words] = await gather(context, sampled, indices, parts);
  return words;
}

/** Reads the given words of the splats or slots at `indices`. Submits before it returns. */
function gather(
  context: DispatchContext,
  { ranges, geometry, geometryPrecision }: Omit<SampledGeometry, 'count'>,
  indices: Uint32Array<ArrayBuffer>,
  parts: readonly { readonly word: number; readonly words: number }[],
): Promise<Uint32Array<ArrayBuffer>[]> {
  const { device, dispatchRow } = context;
  const memory = context.memory.part();
  try {
    const list = memory.createFilledBuffer('ingest samples', indices);
    const dispatches = new Dispatches(context);
    const gathered = parts.map((part) => {
      const usage = GPUBufferUsage.STORAGE | GPUBufferUsage.COPY_SRC;
      const words = memory.createBuffer('ingest sampled words', 4 * part.words * indices.length, usage);
      for (const [page, { start, end }] of ranges.entries()) {
        const parameters = PermuteParameters.pack({
          ...part,
          wordsPerSplat: GEOMETRY_WORDS[geometryPrecision],
          mask: 0xffffffff,
          pageStart: start,
          pageEnd: end,
          count: indices.length,
          dispatchRow,
        });
        const workgroups = Math.ceil(indices.length / CHUNK_SPLATS);
        dispatches.add(ingestGather, parameters, { plane: geometry[page], list, words }, workgroups);
      }
      return words;
    });
    dispatches.submit('ingest samples');
    // Read-backs are submitted at once, so that the buffers can be destroyed now.
    return Promise.all(gathered.map((words) => readWords(device, words)));
  } finally {
    memory.destroyAll();
  }
}
