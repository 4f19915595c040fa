import {
  DestroyedError,
  GEOMETRY_WORDS,
  GpuLimitError,
  type LastingSource,
  loadSplats,
  type PackedCloud,
  type SourceOptions,
  type SplatCloud,
  SplatSourceError,
} from '@websplatter/core';
import { SplatSelection } from '@websplatter/core/effects';
import { type Box3, type Sphere, Vector3 } from 'three/webgpu';
import type { DataEdits, PlacedData } from './data-edits.ts';

/** Splats that are copied to the CPU and tested at once, too few to block the page. */
const PIECE_SPLATS = 1 << 16;

/**
 * Selects the splats with centres in `volume`: see `SplatData.rowsIn`. Reads the cloud on
 * the first engine that has it, with `user` as a further user; else `otherwise`, with `edits`
 * applied.
 */
export async function rowsIn(
  volume: Box3 | Sphere,
  user: object,
  { places, edits }: Pick<PlacedData, 'places' | 'edits'>,
  otherwise: PackedCloud | LastingSource | null,
  sourceOptions: SourceOptions,
): Promise<SplatSelection> {
  for (const { cloud, users } of places) {
    if (cloud instanceof Promise) continue;
    if (cloud.isPreview)
      throw new SplatSourceError(cloud.name, 'it is still loading: its rows are not known yet.');
    if (cloud.stream)
      throw new SplatSourceError(
        cloud.name,
        'only parts of it are there: seek rows in another format of the scene.',
      );
    users.set(user, null);
    // The last frame may lack edits.
    edits?.flush(cloud);
    return rowsOnGpu(cloud, volume);
  }
  if (otherwise === null)
    throw new DestroyedError('These splats', 'the engine that held them has freed them');
  const isPacked = typeof otherwise === 'object' && 'geometry' in otherwise;
  const packed = isPacked ? otherwise : await loadSplats(otherwise, sourceOptions);
  const rows = new SplatSelection();
  const { words, precision } = packed.geometry;
  addRows(rows, packed, 0, words, GEOMETRY_WORDS[precision], volume, edits);
  return rows;
}

/** Reads centres back piece by piece. The caller keeps the cloud alive. */
async function rowsOnGpu(cloud: SplatCloud, volume: Box3 | Sphere): Promise<SplatSelection> {
  const { device, name } = cloud;
  const size = 4 * GEOMETRY_WORDS.f32 * Math.min(PIECE_SPLATS, cloud.count);
  const usage = GPUBufferUsage.COPY_DST | GPUBufferUsage.MAP_READ;
  device.pushErrorScope('out-of-memory');
  const staging = device.createBuffer({ label: `${name} centres`, size, usage });
  const lacking = device.popErrorScope();
  // Positions are the same in planes of all precisions, and other planes may take their place while
  // one piece is tested.
  const planes = () => cloud.pagesFor({ geometryPrecision: 'packed', shPrecision: 'u8' });
  const rows = new SplatSelection();
  try {
    // A lost device does not answer; the read-back rejects instead.
    const cause = await lacking.catch(() => null);
    if (cause) {
      const message = `Finding splats of ${name} needs ${size} bytes that the GPU lacks. Show less.`;
      throw new GpuLimitError('memory', size, 0, message, { cause });
    }
    let first = 0;
    for (const [page, { splatCount }] of planes().pages.entries()) {
      for (let at = 0; at < splatCount; at += PIECE_SPLATS) {
        const { pages, geometryPrecision } = planes();
        const stride = GEOMETRY_WORDS[geometryPrecision];
        const bytes = 4 * stride * Math.min(PIECE_SPLATS, splatCount - at);
        const encoder = device.createCommandEncoder({ label: 'read centres' });
        encoder.copyBufferToBuffer(pages[page].geometry, 4 * stride * at, staging, 0, bytes);
        device.queue.submit([encoder.finish()]);
        await staging.mapAsync(GPUMapMode.READ, 0, bytes).catch((cause: Error) => {
          throw new DestroyedError(`The cloud ${name}`, cause.message);
        });
        const words = new Uint32Array(staging.getMappedRange(0, bytes));
        addRows(rows, cloud, first + at, words, stride, volume);
        staging.unmap();
      }
      first += splatCount;
    }
  } finally {
    staging.destroy();
  }
  return rows;
}

/** Adds the rows of splats from `first` on, of geometry `words`, whose centre is in `volume`. */
function addRows(
  rows: SplatSelection,
  { origin, fileIndices }: Pick<SplatCloud, 'origin' | 'fileIndices'>,
  first: number,
  words: Uint32Array,
  stride: number,
  volume: Box3 | Sphere,
  edits: DataEdits | null = null,
): void {
  // A splat of any precision begins with its position in float32.
  const values = new Float32Array(words.buffer, words.byteOffset, words.length);
  const middle = new Vector3(...origin);
  const center = new Vector3();
  const found: number[] = [];
  for (let i = 0; i < words.length / stride; i++) {
    const row = fileIndices[first + i];
    center.fromArray(values, stride * i).add(middle);
    edits?.move(row, center, first + i);
    if (volume.containsPoint(center)) found.push(row);
  }
  rows.add(found);
}
