import {
  InvalidArgumentError,
  type PackedCloud,
  type SplatCloud,
  type SplatSet,
  SplatSourceError,
} from '@websplatter/core';
import { EDITED, flushEdits, followEdits, SplatEdits } from '@websplatter/core/own-data';
import type { Box3, Vector3 } from 'three/webgpu';
import type { DataEdits } from '../cloud/data-edits.ts';
import { ChangeAnnouncer, takeBounds, tellObjects } from '../cloud/shown-data.ts';
import type { SplatData } from '../cloud/splat-data.ts';

/**
 * Returns the edits of data by rows of its file or arrays: the same object for the same data. All
 * objects with these data show the edits, on all renderers, also after a lost device. Changes
 * request frames by themselves.
 *
 * @throws SplatSourceError for a preview; InvalidArgumentError for a morph, for data with a skeleton, and
 *   for splats that the GPU makes.
 * @example
 * const data = await new SplatLoader().loadAsync('/garden.ply');
 * scene.add(new SplatCloudObject(data));
 * editsOf(data).set({ first: 0, count: 100 }, { colors: [1, 0.5, 0], opacities: [0.5] });
 */
export function editsOf(data: SplatData): SplatEdits {
  if (data.isPreview) throw new SplatSourceError(data.name, 'it is still loading: edit it once it is whole.');
  data.edits ??= new EditedData(data);
  if (data.edits instanceof EditedData) return data.edits.edits;
  throw new InvalidArgumentError('data', `${data.name} ${data.edits.what}; edit its splats before that.`);
}

class EditedData implements DataEdits {
  readonly what = 'has edits';
  readonly edits: SplatEdits;
  readonly uneditedBounds: Box3;
  readonly #data: SplatData;
  readonly #announcer: ChangeAnnouncer;

  constructor(data: SplatData) {
    this.#data = data;
    this.#announcer = new ChangeAnnouncer(data, (clouds) => {
      for (const cloud of clouds) {
        flushEdits(cloud);
        takeBounds(data, cloud);
      }
    });
    this.edits = new SplatEdits(data.set ? rowsOf(data.set) : undefined);
    this.uneditedBounds = data.bounds.clone();
    this.edits.follow({ rowsChanged: () => this.#announcer.announce() });
    for (const { cloud } of data.places) void this.#followOnce(cloud);
  }

  get version(): number {
    return this.edits.version;
  }

  async #followOnce(cloud: SplatCloud | Promise<SplatCloud>): Promise<void> {
    // If the load fails, callers of `acquire` receive the error.
    const there = await Promise.resolve(cloud).catch(() => null);
    if (!there) return;
    try {
      await this.follow(there);
    } catch (error) {
      tellObjects(this.#data, error);
    }
  }

  async follow(cloud: SplatCloud, packed?: PackedCloud): Promise<void> {
    await followEdits(cloud, this.edits, packed);
    if (this.edits.version > 0) this.#announcer.announce();
  }

  flush(cloud: SplatCloud): void {
    flushEdits(cloud);
  }

  move(row: number, center: Vector3): void {
    if (this.edits.maskOf(row) & EDITED.positions) center.fromArray(this.edits.valuesOf(row, 'positions'));
  }
}

/** Rows from the first to the last of a set. */
function rowsOf({ fileIndices }: SplatSet): number {
  return fileIndices.reduce((rows, row) => Math.max(rows, row + 1), 0);
}
