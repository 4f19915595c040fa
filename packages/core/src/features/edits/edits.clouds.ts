import { type CloudFeature, flushFeatures, writerOf } from '../../clouds/cloud-feature.ts';
import { isGeometryAsFine, type Plane } from '../../clouds/cloud-planes.ts';
import type { TouchedSplats } from '../../clouds/levels/touched-links.ts';
import type { SplatCloud } from '../../clouds/splat-cloud.ts';
import { InvalidArgumentError, SplatSourceError } from '../../data/errors.ts';
import { CLOUD, given } from '../../data/given.ts';
import { CHUNK_WORDS } from '../../data/layout/chunk-words.ts';
import { CHUNK_SPLATS } from '../../data/layout/constants.ts';
import { emptyBounds } from '../../data/packing/center-bounds.ts';
import { chunkCountOf, logScalesOf, setLogScales } from '../../data/packing/chunks.ts';
import { GEOMETRY_WORDS, type PackedGeometry } from '../../data/packing/geometry.ts';
import { checkPacked, type PackedCloud, robustBounds } from '../../data/packing/packed-cloud.ts';
import type { GeometryPrecision } from '../../data/packing/precision.ts';
import { readWords } from '../../gpu/read-buffer.ts';
import {
  type EditedGeometry,
  editedGeometry,
  editedLogScales,
  editedPosition,
  isSameRange,
  packEdited,
} from './edited-geometry.data.ts';
import { EDITED, type EditsFollower, type RowRange, type SplatEdits } from './splat-edits.data.ts';

/**
 * Gaps of at most this many unchanged splats are uploaded too, because each upload has a fixed
 * cost.
 */
const MOST_GAP_SPLATS = 32;
/** Splats per read-back: 4 MiB at most. */
const PIECE_SPLATS = 1 << 16;
/** Splats sampled for robust bounds after an edit, few enough for every frame. */
const BOUNDS_SAMPLES = 4096;

/**
 * Applies `edits`, present and future ones, to a cloud from its next frame on. Changed splats are
 * uploaded before a frame in ranges of successive splats, 32 bytes each (64 as `f32`). Bounds,
 * order, picks and rays are updated too. The first edit of a cloud reads its geometry back and
 * keeps it in memory, 32 or 64 bytes per splat. Precisions made later are edited too.
 *
 * Edited splats keep their place in storage order: if they move far apart, chunks get large bounds
 * and frames cull less. `packed` geometry stores sizes in 65,536 steps of a range that 256 splats
 * share. A size outside of the range uploads that chunk with a wider one.
 *
 * @param splats the splats as they were uploaded, if available. Nothing is read back then, and the
 *   edits apply before this returns.
 * @returns when the edits apply.
 * @throws SplatSourceError for a preview; InvalidArgumentError if the cloud follows other edits;
 *   DestroyedError if the cloud or the device ends first; GpuLimitError if the device lacks memory
 *   for reading back.
 * @example
 * const cloud = await engine.load('/garden.ply');
 * const edits = new SplatEdits();
 * await followEdits(cloud, edits);
 * edits.set({ first: 0, count: 100 }, { colors: [1, 0.5, 0] });
 * view.render({ camera, clouds: [{ cloud }], widthPx, heightPx });
 */
export async function followEdits(cloud: SplatCloud, edits: SplatEdits, splats?: PackedCloud): Promise<void> {
  given(cloud, CLOUD, 'cloud');
  given(edits, { follow: 'a function' }, 'edits');
  if (splats) checkPacked(splats);
  let geometry = splats?.geometry ?? null;
  for (;;) {
    checkFree(cloud, edits);
    if (writerOf(cloud)) return;
    // Finer planes may have been made since `geometry` was read.
    if (geometry && isGeometryAsFine(geometry.precision, cloud.planes.held.geometry[0])) break;
    geometry = await geometryOf(cloud);
  }
  cloud.addFeature(new CloudEditor(cloud, edits, geometry));
}

/**
 * Uploads the edits of `cloud` now instead of before its next frame, and updates its bounds. Does
 * nothing if the cloud has no edits.
 *
 * @example
 * const edits = new SplatEdits();
 * await followEdits(cloud, edits);
 * edits.set([0], { positions: [0, 10, 0] });
 * flushEdits(cloud);
 * const top = cloud.bounds.max[1]; // with the moved splat
 */
export function flushEdits(cloud: SplatCloud): void {
  flushFeatures(given(cloud, CLOUD, 'cloud'));
}

function checkFree(cloud: SplatCloud, edits: SplatEdits): void {
  cloud.checkUsable();
  const { name, isPreview, pool } = cloud;
  const writer = writerOf(cloud);
  if (pool)
    throw new SplatSourceError(name, 'only parts of it are there: convert it to another format to edit it.');
  if (isPreview) throw new SplatSourceError(name, 'it is still loading: edit it once it is whole.');
  const isEdited = writer instanceof CloudEditor;
  if (!writer || (isEdited && writer.edits === edits)) return;
  const message = isEdited
    ? `${name} follows other edits already; edit those.`
    : `${name} follows ${writer.name}; edit its splats before that.`;
  throw new InvalidArgumentError('edits', message);
}

/** Reads the finest geometry of a cloud back; null if other planes replaced it meanwhile. */
async function geometryOf(cloud: SplatCloud): Promise<PackedGeometry | null> {
  await cloud.uploaded;
  const { planes } = cloud;
  const { held } = planes;
  const [precision] = held.geometry;
  const isThere = () => planes.held === held && !cloud.isDestroyed;
  const words = await readPlane(cloud, planes.geometryPlane(precision)!, precision, isThere);
  return words && { precision, words, chunks: new Float32Array(cloud.chunks) };
}

/** Reads a plane back, piece by piece; null if the plane has been freed meanwhile. */
async function readPlane(
  { device, count, planes }: SplatCloud,
  plane: Plane,
  precision: GeometryPrecision,
  isThere: () => boolean,
): Promise<Uint32Array | null> {
  const stride = GEOMETRY_WORDS[precision];
  const words = new Uint32Array(count * stride);
  for (const [page, { start, end }] of planes.ranges.entries()) {
    for (let from = start; from < end; from += PIECE_SPLATS) {
      if (!isThere()) return null;
      const wordCount = stride * Math.min(PIECE_SPLATS, end - from);
      words.set(await readWords(device, plane[page], wordCount, stride * (from - start)), stride * from);
    }
  }
  return isThere() ? words : null;
}

function hasBit(bits: Uint32Array, splat: number): boolean {
  return ((bits[splat >>> 5] >>> splat) & 1) === 1;
}

/** Returns whether the bit changed. */
function setBit(bits: Uint32Array, splat: number, isSet: boolean): boolean {
  if (hasBit(bits, splat) === isSet) return false;
  bits[splat >>> 5] ^= 1 << splat;
  return true;
}

/** Writes the edits of one cloud to its planes. */
class CloudEditor implements CloudFeature, EditsFollower {
  readonly edits: SplatEdits;
  readonly name = 'edits';
  readonly touched: TouchedSplats;
  readonly #cloud: SplatCloud;
  readonly #unfollow: () => void;
  /** Splat index by row in the file; the cloud's count for rows that the cloud lacks. */
  readonly #splatOf: Uint32Array;
  /** A bit per splat: whether the next flush writes it. */
  readonly #dirty: Uint32Array;
  /**
   * A bit per splat: whether its levels may show an edit of it. The bit stays when the edit is
   * undone.
   */
  readonly #inLevels: Uint32Array;
  /** Bits of `EDITED` that changed since the last flush; null if there is nothing to write. */
  #changed: number | null = null;
  /** Whether shaders for anisotropic splats are being compiled. */
  #isStretching = false;
  #splats: EditedGeometry;

  constructor(cloud: SplatCloud, edits: SplatEdits, geometry: PackedGeometry) {
    const { origin, fileIndices, count } = cloud;
    this.edits = edits;
    this.#cloud = cloud;
    this.#splats = editedGeometry(geometry, origin, fileIndices, edits);
    let rows = 0;
    for (const row of fileIndices) if (row >= rows) rows = row + 1;
    this.#splatOf = new Uint32Array(rows).fill(count);
    for (let i = 0; i < count; i++) this.#splatOf[fileIndices[i]] = i;
    const noBits = () => new Uint32Array(Math.ceil(count / 32));
    this.#dirty = noBits();
    this.#inLevels = noBits();
    this.touched = { edited: noBits(), hidden: noBits(), count: 0, version: 0 };
    this.#unfollow = edits.follow(this);
    this.#markEdited(true);
  }

  rowsChanged(rows: RowRange | Uint32Array, changed: number): void {
    this.#changed = (this.#changed ?? 0) | changed;
    if (rows instanceof Uint32Array) for (const row of rows) this.#mark(row, true);
    else {
      const end = Math.min(rows.first + rows.count, this.#splatOf.length);
      for (let row = rows.first; row < end; row++) this.#mark(row, true);
    }
  }

  beginLevels(): void {
    this.flush();
    const { touched } = this;
    for (let word = 0; word < this.#inLevels.length; word++) this.#inLevels[word] |= touched.edited[word];
    touched.edited.fill(0);
    touched.hidden.fill(0);
    touched.count = 0;
    touched.version++;
  }

  flush(): void {
    const changed = this.#changed;
    const cloud = this.#cloud;
    // Buffers that failed to allocate, or are freed, must not be written.
    if (changed === null || !cloud.isUploaded || cloud.isDestroyed) return;
    this.#changed = null;
    const { edits } = this;
    if (edits.hasUnevenScales && cloud.facts.isIsotropic) this.#stretch();
    if (changed & (EDITED.positions | EDITED.scales)) this.#bound(changed);
    for (const [page, { start, end }] of cloud.planes.ranges.entries())
      for (const [from, to] of this.#runs(start, end)) this.#write(page, start, from, to);
    this.#dirty.fill(0);
    cloud.markChanged();
  }

  async rebase(precision: GeometryPrecision, plane: Plane): Promise<() => void> {
    const { origin, fileIndices } = this.#cloud;
    const words = await readPlane(this.#cloud, plane, precision, () => !this.#cloud.isDestroyed);
    return () => {
      if (!words) return;
      const geometry = { precision, words, chunks: new Float32Array(this.#cloud.uploadedChunks) };
      this.#splats = editedGeometry(geometry, origin, fileIndices, this.edits);
      this.#markEdited(false);
    };
  }

  end(): void {
    this.#unfollow();
  }

  /** @param isNew whether the levels may lack the edits of the row. */
  #mark(row: number, isNew: boolean): void {
    const splat = this.#splatOf[row];
    if (!(splat < this.#cloud.count)) return;
    this.#dirty[splat >>> 5] |= 1 << splat;
    if (!isNew) return;
    const mask = this.edits.maskOf(row);
    const isEdited = mask !== 0 || hasBit(this.#inLevels, splat);
    const { edited, hidden } = this.touched;
    const changesCount = setBit(edited, splat, isEdited);
    if (changesCount) this.touched.count += isEdited ? 1 : -1;
    if (setBit(hidden, splat, (mask & EDITED.hidden) !== 0) || changesCount) this.touched.version++;
  }

  #markEdited(areNew: boolean): void {
    for (const [row] of this.#splatOf.entries()) {
      const mask = this.edits.maskOf(row);
      if (mask === 0) continue;
      this.#changed = (this.#changed ?? 0) | mask;
      this.#mark(row, areNew);
    }
  }

  /**
   * Runs of dirty splats from `start` to `end`. Short gaps are included, because a second upload
   * costs more.
   */
  #runs(start: number, end: number): [from: number, to: number][] {
    const runs: [from: number, to: number][] = [];
    for (let splat = start; splat < end; splat++) {
      // A word without dirty splats is skipped.
      if (splat % 32 === 0 && this.#dirty[splat >>> 5] === 0) {
        splat += 31;
        continue;
      }
      if (!hasBit(this.#dirty, splat)) continue;
      const last = runs.at(-1);
      if (last && splat - last[1] <= MOST_GAP_SPLATS) last[1] = splat + 1;
      else runs.push([splat, splat + 1]);
    }
    return runs;
  }

  #write(page: number, pageStart: number, from: number, to: number): void {
    const { planes, chunks } = this.#cloud;
    for (const precision of planes.held.geometry) {
      const words = packEdited(this.#splats, from, to, precision, new Float32Array(chunks));
      const at = 4 * GEOMETRY_WORDS[precision] * (from - pageStart);
      this.#upload(planes.geometryPlane(precision)![page], at, words);
    }
  }

  #upload(buffer: GPUBuffer, at: number, words: Uint32Array<ArrayBuffer> | Float32Array<ArrayBuffer>): void {
    const { device } = this.#cloud;
    device.queue.writeBuffer(buffer, at, words);
    this.#cloud.countWritten(words.byteLength);
  }

  /**
   * Recomputes the bounds of chunks with moved or resized splats; marks chunks whose packed log
   * scales change as dirty.
   */
  #bound(changed: number): void {
    const cloud = this.#cloud;
    const { planes, count } = cloud;
    const { minPosition, maxPosition, count: stride } = CHUNK_WORDS;
    // A copy, because data about chunks is cached by their buffer.
    const chunks = new Float32Array(cloud.chunks.slice(0));
    const position = new Float32Array(3);
    for (const [page, { start, end }] of planes.ranges.entries()) {
      const first = start / CHUNK_SPLATS;
      const last = first + chunkCountOf(end - start);
      let run: [from: number, to: number] | null = null;
      const upload = () => {
        if (!run) return;
        const words = chunks.subarray(stride * run[0], stride * run[1]);
        this.#upload(planes.chunksPlane[page], 4 * stride * (run[0] - first), words);
        run = null;
      };
      for (let chunk = first; chunk < last; chunk++) {
        const words = this.#dirty.subarray((chunk * CHUNK_SPLATS) / 32, ((chunk + 1) * CHUNK_SPLATS) / 32);
        if (words.every((word) => word === 0)) {
          upload();
          continue;
        }
        const { min, max } = emptyBounds();
        const endOfChunk = Math.min(count, (chunk + 1) * CHUNK_SPLATS);
        for (let i = chunk * CHUNK_SPLATS; i < endOfChunk; i++) {
          editedPosition(this.#splats, i, position);
          for (let axis = 0; axis < 3; axis++) {
            if (position[axis] < min[axis]) min[axis] = position[axis];
            if (position[axis] > max[axis]) max[axis] = position[axis];
          }
        }
        const at = chunk * stride;
        chunks.set(min, at + minPosition);
        chunks.set(max, at + maxPosition);
        const range = changed & EDITED.scales ? editedLogScales(this.#splats, chunk) : null;
        if (range && !isSameRange(range, logScalesOf(chunks, chunk))) {
          setLogScales(chunks, chunk, range);
          if (planes.geometryPlane('packed')) words.fill(0xffffffff);
        }
        run ??= [chunk, chunk];
        run[1] = chunk + 1;
      }
      upload();
    }
    const robust = changed & EDITED.positions ? this.#robustBounds() : cloud.robustBounds;
    cloud.moveChunks(chunks.buffer, robust);
  }

  #robustBounds() {
    const { count, origin } = this.#cloud;
    const step = Math.ceil(count / BOUNDS_SAMPLES);
    const samples = Math.ceil(count / step);
    const axes = [0, 1, 2].map(() => new Float32Array(samples));
    const position = new Float32Array(3);
    for (let i = 0; i < samples; i++) {
      editedPosition(this.#splats, i * step, position);
      for (let axis = 0; axis < 3; axis++) axes[axis][i] = position[axis];
    }
    return robustBounds(axes, origin);
  }

  /**
   * Marks the splats as anisotropic once their shaders are compiled, so that views can go on
   * drawing meanwhile.
   */
  #stretch(): void {
    if (this.#isStretching) return;
    const stretching = this.#cloud.stretch();
    this.#isStretching = stretching !== null;
    void stretching?.then(() => {
      this.#isStretching = false;
      this.edits.announceFrames();
    });
  }
}
