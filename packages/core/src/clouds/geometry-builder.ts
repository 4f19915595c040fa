import type { GeometryPiece } from './geometry-pieces.ts';

/** Words of splats, and the data to decode them. */
export interface BuildPiece {
  readonly words: Uint32Array;
}

/** Builds a result from the geometry of a cloud, which arrives piece by piece in storage order. */
export interface GeometryBuilder<Result = object, Piece extends BuildPiece = GeometryPiece> {
  add(piece: Piece): Promise<void>;
  finish(): Promise<Result>;
}

type AnyBuilder = GeometryBuilder<object, never>;

/** Builders that a worker offers, by name. */
export type GeometryBuilders = Readonly<Record<string, (plan: never) => AnyBuilder | Promise<AnyBuilder>>>;

/** Tasks of a worker that builds one result: first `begin`, then `add` for each piece, then `finish`. */
export function builderTasks(builders: GeometryBuilders) {
  let builder: AnyBuilder;
  return {
    begin: async ({ what, plan }: { readonly what: string; readonly plan: unknown }) => {
      builder = await builders[what](plan as never);
    },
    add: (piece: BuildPiece) => builder.add(piece as never),
    finish: () => builder.finish(),
  };
}
