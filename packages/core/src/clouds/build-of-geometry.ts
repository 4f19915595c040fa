import { wrongArgument } from '../data/given.ts';
import { callListener } from '../data/listeners.ts';
import { GEOMETRY_WORDS } from '../data/packing/geometry.ts';
import type { PackedCloud } from '../data/packing/packed-cloud.ts';
import { endWorker, hostedWorker, startWorker, workerStopped } from '../io/loading/start-worker.ts';
import { endTurn, takeTurn } from '../io/loading/worker-turns.ts';
import { Remote } from '../io/remote.ts';
import { type BuildPiece, builderTasks, type GeometryBuilder } from './geometry-builder.ts';
import { type GeometryPiece, geometryPieces } from './geometry-pieces.ts';
import type { SplatCloud } from './splat-cloud.ts';

/** Options for building a result from pieces. */
export interface BuildOptions<Plan, Result, Piece extends BuildPiece = GeometryPiece> {
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

/** @throws InvalidArgumentError 'time' unless it is a finite number or undefined. */
export function checkTime(time: number | undefined): void {
  if (time !== undefined && !Number.isFinite(time)) throw wrongArgument('time', time, 'a finite number');
}

type Pieces<Piece> = AsyncIterable<Piece> | Iterable<Piece>;

/**
 * Builds a result from the geometry of `splats`, piece by piece: in a worker, or on this thread if
 * none can start. It queues with loads, so that no more threads run than the machine has.
 *
 * @throws errors of `geometryPieces` and of the builder; WebSplatterError `worker-failed` if the worker
 *   dies; the signal's reason.
 */
export async function buildOfGeometry<Plan, Result extends object>(
  splats: SplatCloud | PackedCloud,
  options: BuildOptions<Plan, Result> & {
    /** Time at which the splats of a moving cloud are read; default its first. */
    readonly time?: number;
    /** Called with the processed share of the splats, 0…1. */
    readonly onProgress?: (part: number) => void;
  },
): Promise<Result> {
  const { time, signal, onProgress } = options;
  signal?.throwIfAborted();
  // Spare workers of loads can only read files.
  endWorker(await takeTurn(signal));
  try {
    let taken = 0;
    return await buildOfPieces(geometryPieces(splats, time), options, ({ words, precision }) => {
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
  { what, makeWorker, subject, plan, make, signal }: BuildOptions<Plan, Result, Piece>,
  onTaken?: (piece: Piece) => void,
): Promise<Result> {
  signal?.throwIfAborted();
  const tasks = builderTasks({ [what]: make });
  const start = (ending: AbortSignal) => startWorker(async () => hostedWorker() ?? makeWorker, ending);
  const remote = new Remote<typeof tasks>(start, {
    failure: (event) => workerStopped(subject, 'worker', event),
    here: async () => tasks,
  });
  try {
    await remote.call('begin', { what, plan }, { signal });
    for await (const piece of pieces) {
      // Copied, because transferring would detach the words of a cloud in memory.
      const words = piece.words.slice();
      await remote.call('add', { ...piece, words }, { signal, transfer: [words.buffer] });
      onTaken?.(piece);
    }
    return (await remote.call('finish', undefined, { signal })) as Result;
  } finally {
    remote.end();
  }
}
