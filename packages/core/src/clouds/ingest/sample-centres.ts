import { CHUNK_SPLATS } from '../../data/layout/constants.ts';
import { PermuteParameters } from '../../data/layout/packing-structs.ts';
import { GEOMETRY_WORDS } from '../../data/packing/geometry.ts';
import { boundsSamples } from '../../data/packing/packed-cloud.ts';
import type { GeometryPrecision } from '../../data/packing/precision.ts';
import { readWords } from '../../gpu/read-buffer.ts';
import { ingestGather } from '../../gpu/stages/ingest-gather.ts';
import type { PageRange, Plane } from '../cloud-planes.ts';
import type { ArrangeContext } from './arrange-planes.ts';
import { Dispatches } from './dispatches.ts';

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
export function sampleCentres(
  { device, memory, pipelines, dispatchRow }: ArrangeContext,
  { count, ranges, geometry, geometryPrecision }: SampledGeometry,
): Promise<Float32Array[]> {
  const indices = boundsSamples(count);
  const list = memory.createFilledBuffer('ingest samples', indices);
  const axes: GPUBuffer[] = [];
  try {
    const dispatches = new Dispatches(device, pipelines, memory, dispatchRow);
    for (let word = 0; word < 3; word++) {
      const usage = GPUBufferUsage.STORAGE | GPUBufferUsage.COPY_SRC;
      const words = memory.createBuffer('ingest sampled words', 4 * indices.length, usage);
      axes.push(words);
      for (const [page, { start, end }] of ranges.entries()) {
        const parameters = PermuteParameters.pack({
          word,
          words: 1,
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
    }
    const encoder = device.createCommandEncoder({ label: 'ingest samples' });
    axes.push(dispatches.record(encoder, 'ingest samples'));
    device.queue.submit([encoder.finish()]);
    // Asked for at once, so that nothing is held while the answer is awaited.
    const reading = Promise.all(axes.slice(0, 3).map((axis) => readWords(device, axis)));
    return reading.then((words) => words.map(({ buffer }) => new Float32Array(buffer)));
  } finally {
    for (const buffer of [list, ...axes]) memory.destroy(buffer);
  }
}
