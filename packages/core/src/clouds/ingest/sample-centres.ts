import { CHUNK_SPLATS } from '../../data/layout/constants.ts';
import { PermuteParameters } from '../../data/layout/packing-structs.ts';
import { GEOMETRY_WORDS } from '../../data/packing/geometry.ts';
import { sampledRows } from '../../data/packing/origin.ts';
import { boundsSamples } from '../../data/packing/packed-cloud.ts';
import type { GeometryPrecision } from '../../data/packing/precision.ts';
import { readWords } from '../../gpu/read-buffer.ts';
import { ingestGather } from '../../gpu/stages/ingest-gather.ts';
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
 * Reads the centres of the splats that robust bounds are taken from. ingest-gather must have been
 * compiled.
 *
 * @returns their stored x, y and z.
 */
export function sampleCentres(context: DispatchContext, sampled: SampledGeometry): Promise<Float32Array[]> {
  return gatherCentres(context, sampled, boundsSamples(sampled.count));
}

/**
 * Reads the positions of rows that the origin is taken from. ingest-gather must have been compiled.
 *
 * @param dropMask a bit for each row that was dropped.
 * @returns x, y and z of the sampled rows that were kept, as in the file.
 */
export async function sampleForOrigin(
  context: DispatchContext,
  sampled: SampledGeometry,
  dropMask: GPUBuffer,
): Promise<Float32Array[]> {
  const rows = sampledRows(sampled.count);
  const masks = { ranges: [{ start: 0, end: dropMask.size / 4 }], plane: [dropMask], wordsPerSplat: 1 };
  const maskIndices = rows.map((row) => row >>> 5);
  const [axes, [words]] = await Promise.all([
    gatherCentres(context, sampled, rows),
    gather(context, masks, maskIndices, 1),
  ]);
  const isKept = (i: number) => ((words[i] >>> (rows[i] & 31)) & 1) === 0;
  return axes.map((values) => values.filter((_, i) => isKept(i)));
}

async function gatherCentres(
  context: DispatchContext,
  { ranges, geometry, geometryPrecision }: Omit<SampledGeometry, 'count'>,
  indices: Uint32Array<ArrayBuffer>,
): Promise<Float32Array[]> {
  const wordsPerSplat = GEOMETRY_WORDS[geometryPrecision];
  const axes = await gather(context, { ranges, plane: geometry, wordsPerSplat }, indices, 3);
  return axes.map(({ buffer }) => new Float32Array(buffer));
}

/** Reads the first words of the splats that `indices` names, each word of all of them together. */
function gather(
  context: DispatchContext,
  { ranges, plane, wordsPerSplat }: { ranges: readonly PageRange[]; plane: Plane; wordsPerSplat: number },
  indices: Uint32Array<ArrayBuffer>,
  wordCount: number,
): Promise<Uint32Array<ArrayBuffer>[]> {
  const { device, dispatchRow } = context;
  const memory = context.memory.part();
  try {
    const list = memory.createFilledBuffer('ingest samples', indices);
    const dispatches = new Dispatches(context);
    const gathered = Array.from({ length: wordCount }, (_, word) => {
      const usage = GPUBufferUsage.STORAGE | GPUBufferUsage.COPY_SRC;
      const words = memory.createBuffer('ingest sampled words', 4 * indices.length, usage);
      for (const [page, { start, end }] of ranges.entries()) {
        const parameters = PermuteParameters.pack({
          word,
          words: 1,
          wordsPerSplat,
          mask: 0xffffffff,
          pageStart: start,
          pageEnd: end,
          count: indices.length,
          dispatchRow,
        });
        const workgroups = Math.ceil(indices.length / CHUNK_SPLATS);
        dispatches.add(ingestGather, parameters, { plane: plane[page], list, words }, workgroups);
      }
      return words;
    });
    dispatches.submit('ingest samples');
    // Asked for at once, so that nothing is held while the answer is awaited.
    return Promise.all(gathered.map((words) => readWords(device, words)));
  } finally {
    memory.destroyAll();
  }
}
