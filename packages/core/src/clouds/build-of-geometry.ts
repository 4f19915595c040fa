import { callListener } from '../data/listeners.ts';
import { onAbort } from '../data/on-abort.ts';
import { GEOMETRY_WORDS, type PackedGeometry } from '../data/packing/geometry.ts';
import type { PackedCloud } from '../data/packing/packed-cloud.ts';
import { hostedWorker } from '../io/loading/hosted-worker.ts';
import { startWorker, workerStopped } from '../io/loading/start-worker.ts';
import { endWorker } from '../io/loading/try-worker.ts';
import { endTurn, takeTurn } from '../io/loading/worker-turns.ts';
import { fromPostedError } from '../io/posted-error.ts';
import type { BuildPiece, BuildReply, BuildRequest, GeometryBuilder } from './geometry-builder.ts';
import { geometryPieces } from './geometry-pieces.ts';
import type { SplatCloud } from './splat-cloud.ts';

/** Options for building a result from pieces. */
export interface BuildOptions<Plan, Result, Piece extends BuildPiece = PackedGeometry> {
  /** Name of a builder of the worker. */
  readonly what: string;
  readonly makeWorker: () => Worker;
  /** Name of the result, for messages. */
  readonly subject: string;
  readonly plan: Plan;
  /** Makes the builder for this thread, used if no worker can start. */
  readonly make: (plan: Plan) => GeometryBuilder<Result, Piece> | Promise<GeometryBuilder<Result, Piece>>;
  readonly signal?: AbortSignal;
}

type Pieces<Piece> = AsyncIterable<Piece> | Iterable<Piece>;

/**
 * Builds a result from the geometry of `splats`, piece by piece: in a worker, or on this thread if
 * none can start. It queues with loads, so that no more threads run than the machine has.
 *
 * @throws errors of `geometryPieces` and of the builder; WebSplatterError `worker-failed` if the
 *   worker dies; the signal's reason.
 */
export async function buildOfGeometry<Plan, Result extends object>(
  splats: SplatCloud | PackedCloud,
  options: BuildOptions<Plan, Result> & {
    /** Called with the processed share of the splats, 0…1. */
    readonly onProgress?: (part: number) => void;
  },
): Promise<Result> {
  const { signal, onProgress } = options;
  signal?.throwIfAborted();
  // Spare workers of loads can only read files.
  endWorker(await takeTurn(signal));
  try {
    let taken = 0;
    return await buildOfPieces(geometryPieces(splats), options, ({ words, precision }) => {
      taken += words.length / GEOMETRY_WORDS[precision];
      callListener(onProgress, taken / splats.count);
    });
  } finally {
    endTurn(null);
  }
}

/**
 * Builds a result from pieces without queuing: in a worker, or on this thread if none can start.
 *
 * @param onTaken called after each processed piece.
 * @throws errors of the pieces and of the builder; WebSplatterError `worker-failed` if the worker
 *   dies; the signal's reason.
 */
export async function buildOfPieces<Plan, Result extends object, Piece extends BuildPiece>(
  pieces: Pieces<Piece>,
  options: BuildOptions<Plan, Result, Piece>,
  onTaken?: (piece: Piece) => void,
): Promise<Result> {
  const { plan, make, makeWorker, signal } = options;
  signal?.throwIfAborted();
  let worker: Worker | null = null;
  try {
    worker = await startWorker(async () => hostedWorker() ?? makeWorker, signal);
    const builder = worker ? await remoteBuilder(worker, options) : await make(plan);
    for await (const piece of pieces) {
      await builder.add(piece);
      onTaken?.(piece);
    }
    return await builder.finish();
  } finally {
    endWorker(worker);
  }
}

/** A builder that runs in a worker. */
async function remoteBuilder<Plan, Result extends object, Piece extends BuildPiece>(
  worker: Worker,
  { what, subject, plan, signal }: BuildOptions<Plan, Result, Piece>,
): Promise<GeometryBuilder<Result, Piece>> {
  const ask = (request: BuildRequest, transfer: Transferable[] = []) => {
    signal?.throwIfAborted();
    let ignoreSignal = () => {};
    return new Promise<object | null>((resolve, reject) => {
      ignoreSignal = onAbort(signal, () => reject(signal!.reason));
      const fail = (event: Partial<ErrorEvent>) => reject(workerStopped(subject, 'worker', event));
      worker.onerror = fail;
      worker.onmessageerror = fail;
      worker.onmessage = ({ data }: MessageEvent<BuildReply>) => {
        if (data.kind === 'built') resolve(data.result);
        else if (data.kind === 'taken') resolve(null);
        else if (data.kind === 'error') reject(fromPostedError(data.error));
      };
      worker.postMessage(request, transfer);
    }).finally(() => ignoreSignal());
  };
  await ask({ build: 'begin', what, plan });
  return {
    add: async (piece: Piece) => {
      // The worker gets a copy: transferring would detach the words of a cloud in memory.
      const words = piece.words.slice();
      await ask({ build: 'piece', piece: { ...piece, words } }, [words.buffer]);
    },
    finish: async () => (await ask({ build: 'end' })) as Result,
  };
}
