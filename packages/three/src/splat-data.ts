import { InvalidArgumentError, type PackedCloud, type SplatCloud, type SplatEngine } from '@websplatter/core';
import { Box3, Vector3 } from 'three/webgpu';

interface Upload {
  readonly cloud: SplatCloud;
  users: number;
}

/**
 * Splats in memory, and on the GPU of each engine that draws them: uploaded for the first user, freed after the last. The
 * copy in memory stays, so that another renderer, or the next one after a lost device, needs no second download.
 */
export class SplatData {
  /** For messages and labels. */
  readonly name: string;
  readonly packed: PackedCloud;
  /** Of the centres, in the cloud's own space. */
  readonly bounds: Box3;
  /** The same without the outermost splats: where the scene is. */
  readonly robustBounds: Box3;
  readonly #uploads = new Map<SplatEngine, Upload>();

  constructor(packed: PackedCloud, name = 'splats') {
    this.packed = packed;
    this.name = name;
    this.bounds = boxOf(packed.bounds);
    this.robustBounds = boxOf(packed.robustBounds);
  }

  get count(): number {
    return this.packed.count;
  }

  /**
   * The cloud on `engine`, uploaded where it is not there yet. Each call is to be answered by one of `release`.
   *
   * @throws InvalidArgumentError where the splats were packed for another precision; GpuLimitError, DestroyedError.
   */
  acquire(engine: SplatEngine): SplatCloud {
    let upload = this.#uploads.get(engine);
    if (!upload) {
      const { precision } = this.packed.geometry;
      const wanted = engine.accuracy.geometryPrecision;
      if (precision !== wanted) {
        throw new InvalidArgumentError(
          'data',
          `${this.name} was loaded with ${precision} geometry and the renderer draws ${wanted}: give the loader the ` +
            'renderer’s accuracy, loader.setAccuracy(splatEngineOf(renderer).accuracy), before it loads.',
        );
      }
      upload = { cloud: engine.addPacked(this.packed, { name: this.name, source: this.packed }), users: 0 };
      this.#uploads.set(engine, upload);
    }
    upload.users++;
    return upload.cloud;
  }

  /** Gives back what `acquire` gave; the last one frees the GPU's memory. */
  release(engine: SplatEngine): void {
    const upload = this.#uploads.get(engine);
    if (!upload) return;
    upload.users--;
    if (upload.users > 0) return;
    this.#uploads.delete(engine);
    upload.cloud.destroy();
  }
}

function boxOf({ min, max }: PackedCloud['bounds']): Box3 {
  return new Box3(new Vector3(...min), new Vector3(...max));
}
