import { type CloudFeature, writerOf } from '../../clouds/cloud-feature.ts';
import { CloudPlanes, type Plane } from '../../clouds/cloud-planes.ts';
import { Dispatches } from '../../clouds/ingest/dispatches.ts';
import { MEMORY_ADVICE, type SplatCloud } from '../../clouds/splat-cloud.ts';
import { InvalidArgumentError, SplatSourceError } from '../../data/errors.ts';
import { CLOUD, given } from '../../data/given.ts';
import { CHUNK_SPLATS } from '../../data/layout/constants.ts';
import { MorphParameters } from '../../data/layout/packing-structs.ts';
import type { OwnShPrecision } from '../../data/packing/precision.ts';
import { Pipelines, type StageDefinition } from '../../gpu/pipelines.ts';
import { type RepackShVariant, repackGeometry, repackSh } from '../../stages/repack/repack.ts';
import { morphGeometry, morphSh } from './morph.stages.ts';
import type { SplatMorph } from './splat-morph.data.ts';

/**
 * Draws a cloud as `morph` defines it, from its next frame on. A change of `morph.amount` rewrites
 * the cloud's planes on the GPU before the next frame and uploads nothing; order, later picks and
 * later rays are updated. The planes of both sets are held besides the cloud's own, so the cloud
 * takes three times the memory.
 *
 * The bounds of the cloud and of its chunks enclose both sets and do not change. If splats stored
 * side by side move far apart, frames cull less. The cloud has no levels of detail, so frames draw
 * it in full, and it cannot be edited.
 *
 * @param cloud made from `morph.packed`, by `engine.addPacked`.
 * @returns when the cloud follows the morph. Until then, views keep their image if the amount is
 *   not 0.
 * @throws InvalidArgumentError if the cloud has other splats than the morph, or has edits;
 *   SplatSourceError if it has levels of detail; DestroyedError if the cloud or the engine ends
 *   first; GpuLimitError if the device lacks memory.
 * @example
 * const morph = new SplatMorph(await readSplats('/calm.ply'), await readSplats('/smiling.ply'), engine.accuracy);
 * const face = engine.addPacked(morph.packed);
 * await followMorph(face, morph);
 * requestAnimationFrame(function loop(timeMs) {
 *   morph.amount = 0.5 - 0.5 * Math.cos(timeMs / 1000);
 *   view.render({ camera, clouds: [{ cloud: face }], widthPx, heightPx });
 *   requestAnimationFrame(loop);
 * });
 */
export async function followMorph(cloud: SplatCloud, morph: SplatMorph): Promise<void> {
  given(cloud, CLOUD, 'cloud');
  given(morph, { packed: 'an object', amount: 'a number' }, 'morph');
  cloud.checkUsable();
  const { name } = cloud;
  const writer = writerOf(cloud);
  if (cloud.fileIndices !== morph.packed.fileIndices)
    throw new InvalidArgumentError(
      'cloud',
      `${name} has other splats than the morph; make it by engine.addPacked(morph.packed).`,
    );
  if (writer instanceof CloudMorph) return writer.ready;
  if (writer) throw new InvalidArgumentError('cloud', `${name} follows ${writer.name}, so it cannot morph.`);
  if (cloud.levels)
    throw new SplatSourceError(
      name,
      'it has levels of detail, which cannot morph: call followMorph as soon as it is added.',
    );
  const following = new CloudMorph(cloud, morph);
  cloud.addFeature(following);
  if (morph.amount > 0) cloud.holdImage(following.ready);
  await following.ready;
}

/** A stage that writes planes. */
interface Step {
  readonly stage: StageDefinition;
  /** Planes by binding name; undefined for planes that the cloud does not hold. */
  readonly planes: () => Readonly<Record<string, Plane | undefined>>;
}

/** Writes the planes of one cloud as its morph defines them. */
class CloudMorph implements CloudFeature {
  readonly name = 'a morph';
  readonly lacksLevels = 'it morphs, so it has no levels of detail.';
  readonly ready: Promise<void>;
  readonly #cloud: SplatCloud;
  readonly #morph: SplatMorph;
  readonly #pipelines: Pipelines;
  /** The planes of the first and the second set. */
  readonly #states: readonly CloudPlanes[];
  readonly #steps: readonly Step[];
  #isReady = false;
  /** The amount last written to the cloud's planes. */
  #written = 0;

  constructor(cloud: SplatCloud, morph: SplatMorph) {
    const { device, name, planes } = cloud;
    const { memory } = planes.place;
    this.#cloud = cloud;
    this.#morph = morph;
    this.#pipelines = new Pipelines(device);
    const { result, checked } = memory.guard(`The morph of ${name}`, MEMORY_ADVICE, () => {
      const first = CloudPlanes.upload(memory, device.limits, morph.packed, `${name} (first)`);
      try {
        const second = { ...morph.packed, ...morph.second };
        return [first, CloudPlanes.upload(memory, device.limits, second, `${name} (second)`)];
      } catch (error) {
        first.destroy();
        throw error;
      }
    });
    this.#states = result;
    for (const { bytes } of result) cloud.countWritten(bytes);
    this.#steps = this.#stepsOf(morph);
    this.ready = this.#prepare(checked);
  }

  async #prepare(checked: Promise<void> | null): Promise<void> {
    const cloud = this.#cloud;
    const { geometry, harmonics } = this.#morph.packed;
    // The cloud's own precision stays held: coarser planes are packed from it.
    const lease = cloud.hold({ geometryPrecision: geometry.precision, shPrecision: harmonics.precision });
    try {
      const compiled = this.#pipelines.prepare(this.#steps.map(({ stage }) => stage));
      await Promise.all([checked, cloud.uploaded, compiled, lease.met]);
      cloud.checkUsable();
      this.#isReady = true;
    } catch (error) {
      cloud.checkUsable();
      this.end();
      lease.release();
      cloud.removeFeature(this);
      throw error;
    }
  }

  flush(): void {
    const { amount } = this.#morph;
    const cloud = this.#cloud;
    if (amount === this.#written || !this.#isReady || cloud.isDestroyed) return;
    this.#written = amount;
    const { device, planes } = cloud;
    const dispatchRow = device.limits.maxComputeWorkgroupsPerDimension;
    const { memory } = planes.place;
    const dispatches = new Dispatches({ device, pipelines: this.#pipelines, memory, dispatchRow });
    for (const step of this.#steps) {
      const bound = Object.entries({ ...step.planes(), chunks: planes.chunksPlane });
      if (bound.some(([, plane]) => !plane)) continue;
      for (const [page, { start, end }] of planes.ranges.entries()) {
        const splatCount = end - start;
        // The stages that repack read only the first two parameters.
        const parameters = MorphParameters.pack({ splatCount, dispatchRow, amount });
        const bindings = Object.fromEntries(bound.map(([name, plane]) => [name, plane![page]]));
        dispatches.add(step.stage, parameters, bindings, Math.ceil(splatCount / CHUNK_SPLATS));
      }
    }
    dispatches.submit('morph');
    cloud.markChanged();
  }

  async rebase(): Promise<() => void> {
    return () => {
      this.#written = Number.NaN;
    };
  }

  end(): void {
    for (const planes of this.#states) planes.destroy();
  }

  /** Coarser planes come last: they are packed from the planes written before. */
  #stepsOf({ packed: { geometry, harmonics } }: SplatMorph): Step[] {
    const [first, second] = this.#states;
    const { planes } = this.#cloud;
    const { degree } = harmonics;
    const { precision: ownGeometry } = geometry;
    const own = harmonics.precision as OwnShPrecision;
    const steps: Step[] = [
      {
        stage: morphGeometry(ownGeometry),
        planes: () => ({
          first: first.geometryPlane(ownGeometry),
          second: second.geometryPlane(ownGeometry),
          morphed: planes.geometryPlane(ownGeometry),
        }),
      },
    ];
    if (ownGeometry === 'f32')
      steps.push({
        stage: repackGeometry,
        planes: () => ({ finer: planes.geometryPlane('f32'), coarser: planes.geometryPlane('packed') }),
      });
    if (degree === 0) return steps;
    steps.push({
      stage: morphSh(degree, own),
      planes: () => ({
        first: first.shPlane(own),
        second: second.shPlane(own),
        morphed: planes.shPlane(own),
      }),
    });
    for (const to of COARSER_SH[own])
      steps.push({
        stage: repackSh({ degree, from: own as RepackShVariant['from'], to }),
        planes: () => ({ finer: planes.shPlane(own), coarser: planes.shPlane(to) }),
      });
    return steps;
  }
}

/** Coarser precisions that harmonics can be repacked to, by the precision that they are stored in. */
const COARSER_SH: Readonly<Record<OwnShPrecision, readonly RepackShVariant['to'][]>> = {
  f32: ['f16', 'u8'],
  f16: ['u8'],
  u8: [],
};
