import type { PackedGeometry } from '../data/packing/geometry.ts';
import { type PostedError, toPostedError } from '../io/posted-error.ts';

/** Words of splats, and the data to decode them. */
export interface BuildPiece {
  readonly words: Uint32Array;
}

/** Builds a result from the geometry of a cloud, which arrives piece by piece in storage order. */
export interface GeometryBuilder<Result = object, Piece extends BuildPiece = PackedGeometry> {
  add(piece: Piece): Promise<void>;
  finish(): Promise<Result>;
}

/**
 * Messages from page to worker: the builder, splats in pieces, their end. Each waits for its reply.
 */
export type BuildRequest =
  | { readonly build: 'begin'; readonly what: string; readonly plan: unknown }
  | { readonly build: 'piece'; readonly piece: BuildPiece }
  | { readonly build: 'end' };

/** Messages from worker to page. */
export type BuildReply =
  /** The worker's script runs. */
  | { readonly kind: 'ready' }
  /** The worker has processed the last message. */
  | { readonly kind: 'taken' }
  | { readonly kind: 'built'; readonly result: object }
  | { readonly kind: 'error'; readonly error: PostedError };

/** The used part of a worker's global scope; a MessagePort has it too. */
export interface BuildPort {
  onmessage: ((event: MessageEvent<BuildRequest>) => void) | null;
  postMessage(reply: BuildReply, transfer: Transferable[]): void;
}

/** Builders that a worker offers, by name. */
export type GeometryBuilders = Readonly<Record<string, (plan: never) => GeometryBuilder<object, never>>>;

/** Serves build requests from the page. */
export function serveBuilder(port: BuildPort, builders: GeometryBuilders): void {
  let builder: GeometryBuilder<object, never>;
  const answer = async (request: BuildRequest) => {
    if (request.build === 'begin') builder = builders[request.what](request.plan as never);
    else if (request.build === 'piece') await builder.add(request.piece as never);
    else {
      const result = await builder.finish();
      const buffers = Object.values(result).flatMap((value) =>
        ArrayBuffer.isView(value) ? [value.buffer as ArrayBuffer] : [],
      );
      port.postMessage({ kind: 'built', result }, buffers);
      return;
    }
    port.postMessage({ kind: 'taken' }, []);
  };
  port.onmessage = ({ data }) => {
    answer(data).catch((error) => port.postMessage({ kind: 'error', error: toPostedError(error) }, []));
  };
  port.postMessage({ kind: 'ready' }, []);
}
