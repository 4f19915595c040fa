import { type CloudFeature, writerOf } from '../../clouds/cloud-feature.ts';
import type { CloudLease } from '../../clouds/cloud-leases.ts';
import { chunksOf, type Plane, uploadPlane, wordsOf } from '../../clouds/cloud-planes.ts';
import { createGeometry } from '../../clouds/create-plane.ts';
import { Dispatches } from '../../clouds/ingest/dispatches.ts';
import { MEMORY_ADVICE, type SplatCloud } from '../../clouds/splat-cloud.ts';
import { InvalidArgumentError, SplatSourceError } from '../../data/errors.ts';
import { CLOUD, given } from '../../data/given.ts';
import { CHUNK_WORDS } from '../../data/layout/chunk-words.ts';
import { CHUNK_SPLATS } from '../../data/layout/constants.ts';
import { SkinParameters } from '../../data/layout/packing-structs.ts';
import { identity4, linearPart, transform3, translated4, type Vec3 } from '../../data/math/mat4.ts';
import { principalAxes } from '../../data/math/principal-axes.ts';
import { chunkCountOf, logScalesOf, setLogScales } from '../../data/packing/chunks.ts';
import { clampLogScale, logScaleRange } from '../../data/packing/log-scale.ts';
import { type Bounds, movedBounds } from '../../data/packing/packed-cloud.ts';
import type { GeometryPrecision } from '../../data/packing/precision.ts';
import { Pipelines } from '../../gpu/pipelines.ts';
import { repackGeometry } from '../../stages/repack/repack.ts';
import { skinGeometry } from './skin.stages.ts';
import { JOINTS_PER_ROW, type SplatSkin } from './splat-skin.data.ts';

/** Floats of a joint's matrix on the GPU: three rows. */
const JOINT_FLOATS = 12;
/**
 * Room below the log scales of a chunk: a mean of joints that are turned apart flattens splats. Packed
 * splats get no thinner than an eighth of what any of their joints makes of them.
 */
const BLEND_ROOM = Math.log(8);
/** Room for the rounding of float32, as a part of the largest coordinate. */
const ROUNDING = 2e-6;

/**
 * Draws a cloud as the joints of `skin` move it, from its next frame on: by linear blend skinning, with
 * positions and covariances exactly as the mean of up to four affine matrices moves them. A change of
 * the pose rewrites the cloud's geometry on the GPU before the next frame; it uploads the joints'
 * matrices and 32 bytes for every 256 splats. Order, bounds, later picks and later rays are updated. The
 * geometry at rest is held besides the cloud's own: 32 bytes per splat, or 64 as `f32`, and 8 for its
 * joints.
 *
 * Colours that depend on the view stay in the directions that they were trained in: they do not turn
 * with the joints. The cloud has no levels of detail, so frames draw it in full, and it cannot be
 * edited.
 *
 * @returns when the cloud follows the skin. Until then, views keep their image if the joints are not at
 *   rest.
 * @throws InvalidArgumentError if the skin lacks rows of the cloud, or if the cloud follows edits, a morph
 *   or another skin; SplatSourceError for a preview, a streamed or a moving scene, and if the cloud has
 *   levels of detail; DestroyedError if the cloud or the engine ends first; GpuLimitError if the device
 *   lacks memory.
 * @example
 * const cloud = await engine.load('/robot.ply');
 * const skin = new SplatSkin({ indices, weights }, 3);
 * await followSkin(cloud, skin);
 * skin.setPose(matrices);
 * view.render({ camera, clouds: [{ cloud }], widthPx, heightPx });
 */
export async function followSkin(cloud: SplatCloud, skin: SplatSkin): Promise<void> {
  given(cloud, CLOUD, 'cloud');
  given(skin, { setPose: 'a function', words: 'a typed array' }, 'skin');
  cloud.checkUsable();
  const { name } = cloud;
  const writer = writerOf(cloud);
  if (writer instanceof CloudSkin && writer.skin === skin) return writer.ready;
  checkFree(cloud);
  const rows = cloud.fileIndices.reduce((rows, row) => Math.max(rows, row + 1), 0);
  if (rows > skin.rowCount) {
    const message = `${name} has ${rows} rows and the skin ${skin.rowCount}; it needs joints and weights for each row.`;
    throw new InvalidArgumentError('skin', message);
  }
  const following = new CloudSkin(cloud, skin);
  cloud.addFeature(following);
  if (skin.version > 0) cloud.holdImage(following.ready);
  await following.ready;
}

function checkFree(cloud: SplatCloud): void {
  const { name, pool, isPreview, timeRange, levels } = cloud;
  const writer = writerOf(cloud);
  if (pool) throw new SplatSourceError(name, 'only parts of it are there: convert it to another format.');
  if (isPreview) throw new SplatSourceError(name, 'it is still loading: give it a skin once it is whole.');
  if (timeRange)
    throw new SplatSourceError(name, 'its splats move by themselves: freeze them at a time by `splatsAt`.');
  if (levels)
    throw new SplatSourceError(
      name,
      'it has levels of detail, which joints cannot move: call followSkin as soon as it is added.',
    );
  if (writer)
    throw new InvalidArgumentError('cloud', `${name} follows ${writer.name}, so it cannot follow this skin.`);
}

/** Planes of the pose at rest. */
interface Rest {
  readonly precision: GeometryPrecision;
  readonly geometry: Plane;
}

/** Writes the geometry of one cloud as its skin poses it. */
class CloudSkin implements CloudFeature {
  readonly name = 'a skin';
  readonly lacksLevels = 'joints move it, so it has no levels of detail.';
  readonly skin: SplatSkin;
  readonly ready: Promise<void>;
  readonly #cloud: SplatCloud;
  readonly #pipelines: Pipelines;
  readonly #robustBounds: Bounds;
  /** Joints that move splats of each chunk. */
  readonly #jointsOf: readonly (readonly number[])[];
  /** Planes that do not change: joints and weights, and the chunks at rest. */
  #influences: Plane = [];
  #chunks: Plane = [];
  #joints: GPUBuffer | null = null;
  #rest: Rest | null = null;
  #lease: CloudLease | null = null;
  #hasEnded = false;
  /** Version of the pose in the cloud's planes; null if they have to be written. */
  #written: number | null = 0;

  constructor(cloud: SplatCloud, skin: SplatSkin) {
    this.skin = skin;
    this.#cloud = cloud;
    this.#pipelines = new Pipelines(cloud.device);
    this.#robustBounds = cloud.robustBounds;
    const influences = influencesOf(cloud, skin);
    this.#jointsOf = Array.from({ length: chunkCountOf(cloud.count) }, (_, chunk) =>
      jointsIn(influences.subarray(2 * CHUNK_SPLATS * chunk, 2 * CHUNK_SPLATS * (chunk + 1))),
    );
    this.ready = this.#prepare(influences);
  }

  async #prepare(influences: Uint32Array): Promise<void> {
    const cloud = this.#cloud;
    try {
      await cloud.uploaded;
      cloud.checkUsable();
      const { held } = cloud.planes;
      const precision = held.geometry[0];
      // The finest geometry stays held: coarser planes are packed from it.
      this.#lease = cloud.hold({ geometryPrecision: precision, shPrecision: held.sh[0] });
      await Promise.all([this.#lease.met, this.#compile(precision)]);
      cloud.checkUsable();
      const { place } = cloud.planes;
      const { memory } = place;
      const { checked } = memory.guard(`The skin of ${cloud.name}`, MEMORY_ADVICE, () => {
        this.#joints = memory.createBuffer(
          `${cloud.name} joints`,
          4 * JOINT_FLOATS * this.skin.jointCount,
          GPUBufferUsage.STORAGE | GPUBufferUsage.COPY_DST,
        );
        this.#influences = uploadPlane(place, 'influences', wordsOf(influences, 2));
        this.#chunks = uploadPlane(place, 'chunks at rest', chunksOf(cloud.uploadedChunks));
        this.#rest = this.#restOf(precision, cloud.planes.geometryPlane(precision)!);
      });
      await checked;
      // Joints turn balls to ellipsoids, which need other shaders.
      if (cloud.facts.isIsotropic) await cloud.stretch();
      cloud.checkUsable();
      cloud.countWritten(influences.byteLength + this.#cloud.uploadedChunks.byteLength);
    } catch (error) {
      this.#lease?.release();
      this.#free();
      cloud.checkUsable();
      this.#hasEnded = true;
      cloud.removeFeature(this);
      throw error;
    }
  }

  async #compile(precision: GeometryPrecision): Promise<void> {
    await this.#pipelines.prepare([
      skinGeometry(precision),
      ...(precision === 'f32' ? [repackGeometry] : []),
    ]);
  }

  /** Copies geometry at rest. */
  #restOf(precision: GeometryPrecision, plane: Plane): Rest {
    const { device, planes } = this.#cloud;
    const geometry = createGeometry(planes.place, precision);
    const encoder = device.createCommandEncoder({ label: 'pose at rest' });
    for (const [page, buffer] of plane.entries())
      encoder.copyBufferToBuffer(buffer, 0, geometry[page], 0, buffer.size);
    device.queue.submit([encoder.finish()]);
    return { precision, geometry };
  }

  flush(): void {
    const { skin } = this;
    const rest = this.#rest;
    if (!rest || this.#hasEnded) return;
    skin.beforeFrame?.();
    if (this.#written === skin.version) return;
    const cloud = this.#cloud;
    const { device, planes } = cloud;
    const own = planes.geometryPlane(rest.precision);
    if (!own) return;
    this.#written = skin.version;
    const isAtRest = skin.pose.every((value, at) => value === IDENTITY[at % 16]);
    this.#bound(isAtRest ? null : skin.pose);
    const rows = jointRows(skin.pose, cloud.origin);
    device.queue.writeBuffer(this.#joints!, 0, Float32Array.from(rows));
    cloud.countWritten(4 * rows.length);
    const dispatchRow = device.limits.maxComputeWorkgroupsPerDimension;
    const { memory } = planes.place;
    const dispatches = new Dispatches({ device, pipelines: this.#pipelines, memory, dispatchRow });
    const packed = rest.precision === 'f32' ? planes.geometryPlane('packed') : undefined;
    for (const [page, { start, end }] of planes.ranges.entries()) {
      const splatCount = end - start;
      const parameters = SkinParameters.pack({ splatCount, dispatchRow });
      const workgroups = Math.ceil(splatCount / CHUNK_SPLATS);
      const chunks = planes.chunksPlane[page];
      const bindings = {
        rest: rest.geometry[page],
        skinned: own[page],
        influences: this.#influences[page],
        joints: this.#joints!,
        restChunks: this.#chunks[page],
        chunks,
      };
      if (!isAtRest) dispatches.add(skinGeometry(rest.precision), parameters, bindings, workgroups);
      if (packed)
        dispatches.add(
          repackGeometry,
          parameters,
          { finer: own[page], coarser: packed[page], chunks },
          workgroups,
        );
    }
    dispatches.submit('skin', (encoder) => {
      if (!isAtRest) return;
      for (const [page, buffer] of rest.geometry.entries())
        encoder.copyBufferToBuffer(buffer, 0, own[page], 0, buffer.size);
    });
    cloud.markChanged();
  }

  /** Finer geometry takes the place of the geometry at rest. */
  async rebase(precision: GeometryPrecision, plane: Plane): Promise<() => void> {
    await this.#compile(precision);
    const rest = this.#hasEnded ? null : this.#restOf(precision, plane);
    return () => {
      const cloud = this.#cloud;
      if (!rest) return;
      if (this.#rest) cloud.planes.free(this.#rest.geometry);
      this.#rest = rest;
      this.#written = null;
      const lease = cloud.hold({ geometryPrecision: precision, shPrecision: cloud.planes.held.sh[0] });
      // The planes are there already: only the end of the cloud rejects this, which frames report.
      lease.met.catch(() => {});
      this.#lease?.release();
      this.#lease = lease;
    };
  }

  end(): void {
    if (this.#hasEnded) return;
    this.#hasEnded = true;
    this.#free();
  }

  #free(): void {
    const { planes } = this.#cloud;
    for (const plane of [this.#influences, this.#chunks, this.#rest?.geometry ?? []]) planes.free(plane);
    if (this.#joints) planes.place.memory.destroy(this.#joints);
    this.#influences = this.#chunks = [];
    this.#rest = this.#joints = null;
  }

  /**
   * Bounds the posed chunks: a mean of moved points lies within the boxes of the chunk as each of its
   * joints moves it. Null: the pose at rest.
   */
  #bound(pose: Float64Array | null): void {
    const cloud = this.#cloud;
    const { device, planes, origin } = cloud;
    const rest = new Float32Array(this.#cloud.uploadedChunks);
    const chunks = rest.slice();
    let robust = this.#robustBounds;
    if (pose) {
      const joints = Array.from({ length: this.skin.jointCount }, (_, joint) =>
        boundedJoint(pose.subarray(16 * joint, 16 * (joint + 1)), origin),
      );
      robust = this.#boundChunks(rest, chunks, joints);
    }
    for (const [page, { start, end }] of planes.ranges.entries()) {
      const first = (CHUNK_WORDS.count * start) / CHUNK_SPLATS;
      const words = chunks.subarray(first, first + CHUNK_WORDS.count * chunkCountOf(end - start));
      device.queue.writeBuffer(planes.chunksPlane[page], 0, words);
      cloud.countWritten(words.byteLength);
    }
    cloud.moveChunks(pose ? chunks.buffer : cloud.uploadedChunks, robust);
  }

  /** Bounds the chunks of a pose; returns its robust bounds. */
  #boundChunks(rest: Float32Array, chunks: Float32Array, joints: readonly BoundedJoint[]): Bounds {
    const { origin, bounds } = this.#cloud;
    const { minPosition, maxPosition, count: stride } = CHUNK_WORDS;
    const robust = emptyBox();
    const [low, high] = [this.#robustBounds.min, this.#robustBounds.max].map((corner) =>
      corner.map((value, axis) => value - origin[axis]),
    );
    const [own, inner] = [new Float64Array(6), new Float64Array(6)];
    for (const [chunk, moving] of this.#jointsOf.entries()) {
      const at = chunk * stride;
      let isInner = true;
      let isWithin = true;
      for (let axis = 0; axis < 3; axis++) {
        const min = rest[at + minPosition + axis];
        const max = rest[at + maxPosition + axis];
        own[axis] = min;
        own[3 + axis] = max;
        inner[axis] = Math.max(min, low[axis]);
        inner[3 + axis] = Math.min(max, high[axis]);
        isInner &&= inner[axis] <= inner[3 + axis];
        isWithin &&= inner[axis] === min && inner[3 + axis] === max;
      }
      const posed = posedBox(own, moving, joints);
      for (let axis = 0; axis < 3; axis++) {
        chunks[at + minPosition + axis] = posed[axis];
        chunks[at + maxPosition + axis] = posed[3 + axis];
      }
      // Most chunks are within the robust bounds as a whole.
      if (isInner) widen(robust, isWithin ? posed : posedBox(inner, moving, joints));
      const range = logScalesOf(rest, chunk);
      let [smallest, largest] = [Number.POSITIVE_INFINITY, 0];
      for (const joint of moving) {
        smallest = Math.min(smallest, joints[joint].smallest);
        largest = Math.max(largest, joints[joint].largest);
      }
      const room = moving.length > 1 ? BLEND_ROOM : 0;
      const from = clampLogScale(range.min + Math.log(smallest) - room);
      const to = clampLogScale(range.min + 65535 * range.step + Math.log(largest));
      setLogScales(chunks, chunk, logScaleRange(from, Math.max(from, to)));
    }
    if (robust[0] > robust[3]) return bounds;
    const [minX, minY, minZ, maxX, maxY, maxZ] = robust;
    return movedBounds({ min: [minX, minY, minZ], max: [maxX, maxY, maxZ] }, origin);
  }
}

/** The smallest corner of a box, then the largest. */
type Box = Float64Array;

function emptyBox(): Box {
  return new Float64Array(6).fill(Number.POSITIVE_INFINITY, 0, 3).fill(Number.NEGATIVE_INFINITY, 3);
}

function widen(box: Box, other: Box): void {
  for (let axis = 0; axis < 3; axis++) {
    box[axis] = Math.min(box[axis], other[axis]);
    box[3 + axis] = Math.max(box[3 + axis], other[3 + axis]);
  }
}

/** Returns a box around `box` as each of the joints moves it. */
function posedBox(box: Box, moving: readonly number[], joints: readonly BoundedJoint[]): Box {
  const posed = emptyBox();
  const [x, y, z] = [(box[0] + box[3]) / 2, (box[1] + box[4]) / 2, (box[2] + box[5]) / 2];
  const [halfX, halfY, halfZ] = [box[3] - x, box[4] - y, box[5] - z];
  for (const joint of moving) {
    const { linear, translation } = joints[joint];
    for (let axis = 0; axis < 3; axis++) {
      const [a, b, c] = [linear[axis], linear[3 + axis], linear[6 + axis]];
      const shift = translation[axis];
      const middle = a * x + b * y + c * z + shift;
      const half = Math.abs(a) * halfX + Math.abs(b) * halfY + Math.abs(c) * halfZ;
      const size = half + Math.abs(a * x) + Math.abs(b * y) + Math.abs(c * z) + Math.abs(shift);
      const reach = half + ROUNDING * size;
      if (middle - reach < posed[axis]) posed[axis] = middle - reach;
      if (middle + reach > posed[3 + axis]) posed[3 + axis] = middle + reach;
    }
  }
  return posed;
}

const IDENTITY = /* @__PURE__ */ identity4();

/** A joint's matrix about the cloud's origin, and its smallest and largest stretch. */
interface BoundedJoint {
  readonly linear: readonly number[];
  readonly translation: readonly number[];
  readonly smallest: number;
  readonly largest: number;
}

function boundedJoint(matrix: ArrayLike<number>, origin: Vec3): BoundedJoint {
  const linear = linearPart(matrix);
  const squared = new Float64Array(9);
  for (let row = 0; row < 3; row++)
    for (let column = 0; column < 3; column++)
      for (let k = 0; k < 3; k++) squared[3 * row + column] += linear[3 * row + k] * linear[3 * column + k];
  const axes = principalAxes(squared, 3);
  const stretches = [0, 3, 6].map((at) => Math.hypot(...transform3(linear, axes.subarray(at, at + 3))));
  return {
    linear,
    translation: translationAbout(matrix, origin),
    smallest: Math.min(...stretches),
    largest: Math.max(...stretches),
  };
}

/** Translation of positions that are relative to the origin, before and after. */
function translationAbout(matrix: ArrayLike<number>, origin: Vec3): number[] {
  const about = translated4(matrix, origin);
  return origin.map((value, axis) => about[12 + axis] - value);
}

/** Rows of the matrices about the origin, as the shader reads them. */
function jointRows(pose: Float64Array, origin: Vec3): number[] {
  const rows: number[] = [];
  for (let at = 0; at < pose.length; at += 16) {
    const translation = translationAbout(pose.subarray(at, at + 16), origin);
    for (let row = 0; row < 3; row++)
      rows.push(pose[at + row], pose[at + 4 + row], pose[at + 8 + row], translation[row]);
  }
  return rows;
}

/** Joints and weights of the cloud's splats, in storage order. */
function influencesOf({ fileIndices }: SplatCloud, { words }: SplatSkin): Uint32Array {
  const influences = new Uint32Array(2 * fileIndices.length);
  for (const [i, row] of fileIndices.entries()) {
    influences[2 * i] = words[2 * row];
    influences[2 * i + 1] = words[2 * row + 1];
  }
  return influences;
}

function jointsIn(influences: Uint32Array): number[] {
  const joints = new Set<number>();
  for (let at = 0; at < influences.length; at += 2)
    for (let k = 0; k < JOINTS_PER_ROW; k++)
      if ((influences[at + 1] >>> (8 * k)) & 255) joints.add((influences[at] >>> (8 * k)) & 255);
  return [...joints];
}
