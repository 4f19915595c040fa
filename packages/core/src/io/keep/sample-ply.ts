import { given, wrongArgument } from '../../data/given.ts';
import { openPlyRows, type PlyRows, type RowRun } from '../formats/ply/ply-rows.ts';
import { knownSource } from '../sources/known-source.ts';
import { blobRanges } from '../sources/range-source.ts';

/** Options of `samplePly`. */
export interface SamplePlyOptions {
  /** Most splats of the sample. Default: 200,000. */
  readonly splats?: number;
  readonly signal?: AbortSignal;
}

const SAMPLE_SPLATS = 200_000;
/** Rows per read. In Chromium, a sample of 200,000 rows took half as long with runs of 256 as with 64. */
const RUN_ROWS = 256;

/**
 * Makes a smaller PLY from runs of up to 256 rows at even distances: a quick preview of a scene
 * that takes long to read. Only the sampled rows are read. If one splat in n is kept, its scale
 * grows by √n, so that the covered area stays the same.
 *
 * Measured with `reference`: a picture of 128 × 128 pixels with one in 64 splats of the built-in
 * still life. Against all splats it has 18.9 dB, 6.3 dB with unchanged scales, and 17.8 dB with ∛n.
 *
 * @returns the file itself if it has no more splats than requested.
 *
 * Rejects with SplatFileError for anything but a binary PLY of splats whose rows have one length
 * ('unknown-format', 'bad-header', 'bad-property', 'truncated'). Rejects with SplatSourceError if
 * the file cannot be read, InvalidArgumentError for a number below 1, and the signal's reason.
 *
 * @example
 * const sample = await engine.load(await samplePly(file));
 * view.render({ camera, clouds: [{ cloud: sample }], widthPx, heightPx });
 * const cloud = await engine.load(await keepBricks(file)); // takes longer
 */
export async function samplePly(file: Blob, options: SamplePlyOptions = {}): Promise<Blob> {
  const { splats = SAMPLE_SPLATS, signal } = given(options);
  if (!(splats >= 1)) throw wrongArgument('splats', splats, 'a number of at least 1');
  const { name } = knownSource(file);
  const rows = await openPlyRows(file, name, signal);
  if (rows.count <= splats) return file;
  const sample = rows.fileOf(sampledRuns(rows.count, splats));
  const bytes = await blobRanges(sample, name).read(0, sample.size, signal);
  growRows(bytes, rows, Math.floor(splats));
  return new File([bytes], name);
}

/** Enlarges the splats of a sample, whose rows end at the end of the file. */
function growRows(
  { buffer, length }: Uint8Array<ArrayBuffer>,
  { count, strideBytes, isLittleEndian, scaleOffsets, filterOffset }: PlyRows,
  sampled: number,
): void {
  const view = new DataView(buffer);
  const growth = Math.log(count / sampled) / 2;
  for (let row = length - sampled * strideBytes; row < length; row += strideBytes) {
    for (const offset of scaleOffsets) {
      const logScale = view.getFloat32(row + offset, isLittleEndian);
      view.setFloat32(row + offset, logScale + growth, isLittleEndian);
    }
    if (filterOffset === undefined) continue;
    const filter = view.getFloat32(row + filterOffset, isLittleEndian);
    view.setFloat32(row + filterOffset, filter * Math.exp(growth), isLittleEndian);
  }
}

/** Runs at even distances that have `sampled` of `count` rows in total. */
export function sampledRuns(count: number, sampled: number): RowRun[] {
  const most = Math.floor(sampled);
  const runs = Math.ceil(most / RUN_ROWS);
  const taken = (run: number) => Math.floor((run * most) / runs);
  const left = (run: number) => Math.floor((run * (count - most)) / runs);
  return Array.from({ length: runs }, (_, i) => [taken(i) + left(i), taken(i + 1) - taken(i)] as const);
}
