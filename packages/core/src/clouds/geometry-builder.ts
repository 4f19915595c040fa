import type { PackedGeometry } from '../data/packing/geometry.ts';
import type { PostedError } from '../io/loading/load-messages.ts';
import { toPostedError } from '../io/loading/load-messages.ts';

/** Words of splats, with everything that decodes them. */
export interface BuildPiece {
  readonly words: Uint32Array;
}

/** Makes something of the geometry of a cloud, which comes piece by piece in storage order. */
export interface GeometryBuilder<Result = object, Piece extends BuildPiece = PackedGeometry> {
  add(piece: Piece): Promise<void>;
  finish(): Promise<Result>;
}

/** Page to worker: builder, splats in pieces, their end. Each message waits for an answer. */
export type BuildRequest =
  | { readonly build: 'begin'; readonly what: string; readonly plan: unknown }
  | { readonly build: 'piece'; readonly piece: BuildPiece }
  | { readonly build: 'end' };

/** Worker to page. */
export type BuildReply =
  /** The worker's script is running. */
  | { readonly kind: 'ready' }
  /** The worker has taken the last message, and waits for more. */
  | { readonly kind: 'taken' }
  | { readonly kind: 'built'; readonly result: object }
  | { readonly kind: 'error'; readonly error: PostedError };

/** The part of a worker's global scope that is used; a MessagePort has it too. */
export interface BuildPort {
  onmessage: ((event: MessageEvent<BuildRequest>) => void) | null;
  postMessage(reply: BuildReply, transfer: Transferable[]): void;
}

/** Builders of a worker, by name. */
export type GeometryBuilders = Readonly<Record<string, (plan: never) => GeometryBuilder<object, never>>>;

/** Builds the things that the page asks for. */
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
