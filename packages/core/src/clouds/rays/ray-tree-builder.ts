import { CHUNK_SPLATS } from '../../data/layout/constants.ts';
import { GEOMETRY_WORDS } from '../../data/packing/geometry.ts';
import { Turns } from '../../data/turns.ts';
import type { GeometryBuilder, GeometryBuilders } from '../geometry-builder.ts';
import type { GeometryPiece } from '../geometry-pieces.ts';
import { arrangeBlobs, type RayBlobs } from './arrange-blobs.ts';
import { BlobCollector } from './ray-blobs.ts';

/** Longest time for which the calling thread is blocked. */
const MAX_BUSY_MS = 5;

export interface RayPlan {
  /** Most blobs per chunk. */
  readonly shares: Uint16Array;
}

/** Makes the blobs that rays are tested against. Yields to the event loop as it works. */
export class RayTreeBuilder implements GeometryBuilder<RayBlobs> {
  readonly #shares: Uint16Array;
  readonly #turns: Turns;
  readonly #collector: BlobCollector;
  #chunk = 0;

  constructor({ shares }: RayPlan, signal?: AbortSignal) {
    this.#shares = shares;
    this.#turns = new Turns(signal, MAX_BUSY_MS);
    this.#collector = new BlobCollector(shares.reduce((sum, share) => sum + share, 0));
  }

  async add(piece: GeometryPiece): Promise<void> {
    const end = piece.words.length / GEOMETRY_WORDS[piece.precision];
    for (let from = 0; from < end; from += CHUNK_SPLATS) {
      await this.#turns.give();
      const share = this.#shares[this.#chunk++];
      this.#collector.add(piece, from, Math.min(end, from + CHUNK_SPLATS), share);
    }
  }

  /** @throws the signal's reason. */
  finish(): Promise<RayBlobs> {
    return arrangeBlobs(this.#collector.blobs, this.#turns);
  }
}

export const RAY_BUILDERS: GeometryBuilders = { rays: (plan: RayPlan) => new RayTreeBuilder(plan) };
