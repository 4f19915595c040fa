import { fetched } from '../../data/errors.ts';
import type { StageDefinition } from '../../gpu/pipelines.ts';
import { SPLAT_FORMATS, type SplatFormatName } from '../../io/formats/formats.ts';
import type { KnownSource } from '../../io/sources/known-source.ts';
import type { ReadOptions } from '../../io/sources/splat-source.ts';
import type { SplatCloud, SplatCloudOptions } from '../splat-cloud.ts';
import type { StreamContext, StreamOptions } from './stream-budget.ts';

type OpenOptions = Omit<ReadOptions, 'onProgress'>;
type CloudOptions = Pick<SplatCloudOptions, 'onDestroyed'>;

/** Opens a scene of a format. Null if the source is to be loaded as a whole. */
type Open<Scene> = (source: KnownSource, options: OpenOptions) => Promise<Scene | null>;
/** Makes a cloud that has the parts of a scene that views need. */
type Stream<Scene> = (
  context: StreamContext,
  scene: Scene,
  options: StreamOptions,
  cloudOptions: CloudOptions,
) => Promise<SplatCloud>;

/** How a scene is streamed, and stages that every such scene needs. */
interface Streamer<Scene> {
  readonly stream: Stream<Scene>;
  readonly firstStages: readonly StageDefinition[];
}

type Load = (
  context: StreamContext,
  source: KnownSource,
  options: StreamOptions & OpenOptions,
  cloudOptions: CloudOptions,
) => Promise<SplatCloud | null>;

function loadBy<Scene extends { end(): void }>(
  fetchOpen: () => Promise<Open<Scene>>,
  fetchStream: () => Promise<Streamer<Scene>>,
): Load {
  return async (context, source, options, cloudOptions) => {
    const [open, { stream, firstStages }] = await fetched(
      'streaming',
      Promise.all([fetchOpen(), fetchStream()]),
    );
    // They take longer to compile than a small scene to open. If that fails, the pool reports it.
    context.pipelines.prepare(firstStages).catch(() => {});
    const scene = await open(source, options);
    if (!scene) return null;
    try {
      return await stream(context, scene, options, cloudOptions);
    } catch (error) {
      scene.end();
      throw error;
    }
  };
}

const fetchLeaves = async () => {
  const { streamLeaves: stream, FIRST_STAGES: firstStages } = await import('../leaves/stream-leaves.ts');
  return { stream, firstStages };
};
const fetchBricks = async () => {
  const { streamBricks: stream, FIRST_STAGES: firstStages } = await import('../bricks/brick-parts.ts');
  return { stream, firstStages };
};

/** Loads a scene that streams, by format; each has a row with `mayStream` in `io/formats/formats.ts`. */
const LOADERS: Partial<Record<SplatFormatName, Load>> = {
  sog: loadBy(async () => (await import('../../io/formats/sog/open-leaves.ts')).openLeaves, fetchLeaves),
  rad: loadBy(async () => (await import('../../io/formats/rad/open-rad.ts')).openRad, fetchLeaves),
  bricks: loadBy(
    async () => (await import('../../io/formats/bricks/open-bricks.ts')).openBricks,
    fetchBricks,
  ),
};

/**
 * Makes a cloud of a scene whose parts are read as views need them.
 *
 * @returns null if the names of the source tell that it is no such scene, and a promise of null if its
 *   first bytes do: load it as a whole.
 * @throws CodeUnavailableError, InvalidArgumentError for a budget that is too small, and the errors of
 *   the format. Nothing is left allocated then.
 */
export function loadStreamed(
  context: StreamContext,
  source: KnownSource,
  options: StreamOptions & OpenOptions,
  cloudOptions: CloudOptions,
): ReturnType<Load> | null {
  const names = source.kind === 'files' ? source.paths : source.fileNames;
  // In a folder with several scenes, the format that streams scenes of any size comes first.
  const format = SPLAT_FORMATS.findLast(({ mayStream }) =>
    names.some((name) => mayStream?.(name, source.kind)),
  );
  const load = format && LOADERS[format.name as SplatFormatName];
  return load ? load(context, source, options, cloudOptions) : null;
}
