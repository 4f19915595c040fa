import { CHUNK_SPLATS } from '../../data/layout/constants.ts';
import { GEOMETRY_WORDS } from '../../data/packing/geometry.ts';
import { Turns } from '../../data/turns.ts';
import type { GeometryBuilder, GeometryBuilders } from '../geometry-builder.ts';
import type { GeometryPiece } from '../geometry-pieces.ts';
import { ColliderGrid } from './collider-grid.ts';
import type { ColliderPlan } from './collider-plan.ts';
import { surfaceOf, type Triangles, withoutIslands } from './collider-surface.ts';

/** Makes a collider of splats that arrive in pieces. Yields to the event loop as it works. */
export class ColliderBuilder implements GeometryBuilder<Triangles> {
  readonly #plan: ColliderPlan;
  readonly #grid: ColliderGrid;
  readonly #turns: Turns;

  constructor(plan: ColliderPlan, signal?: AbortSignal) {
    this.#plan = plan;
    this.#grid = new ColliderGrid(plan.grid);
    this.#turns = new Turns(signal);
  }

  async add(piece: GeometryPiece): Promise<void> {
    const count = piece.words.length / GEOMETRY_WORDS[piece.precision];
    for (let from = 0; from < count; from += CHUNK_SPLATS) {
      await this.#turns.give();
      this.#grid.add(piece, from, Math.min(count, from + CHUNK_SPLATS));
    }
  }

  /** @throws InvalidArgumentError if there are too many triangles; the signal's reason. */
  async finish(): Promise<Triangles> {
    const { solidAt, origin, fewestTriangles } = this.#plan;
    return withoutIslands(await surfaceOf(this.#grid, solidAt, origin, this.#turns), fewestTriangles);
  }
}

export const COLLIDER_BUILDERS: GeometryBuilders = {
  collider: (plan: ColliderPlan) => new ColliderBuilder(plan),
};
