import { FIRST_PIECE } from '../../data/bricks/brick-files.ts';
import { fetched } from '../../data/errors.ts';
import type { StageDefinition } from '../../gpu/pipelines.ts';
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

/** How scenes of a format are streamed. */
interface Loader {
  /**
   * Whether a source may be a scene of which views need only parts at once. `load` opens it, and finds
   * that out.
   *
   * @param name of the source or of one of its files, with folders.
   */
  readonly mayStream: (name: string, kind: KnownSource['kind']) => boolean;
  readonly load: Load;
}

/** A folder with several scenes is opened by the first row that fits: bricks stream at any size. */
const LOADERS: readonly Loader[] = [
  {
    mayStream: (name, kind) => {
      if (kind === 'stream') return false;
      return (kind === 'files' ? FIRST_PIECE : /\.bricks(?:\.000)?$/i).test(name);
    },
    load: loadBy(
      async () => (await import('../../io/formats/bricks/open-bricks.ts')).openBricks,
      fetchBricks,
    ),
  },
  {
    mayStream: (name) => /\.rad$/i.test(name),
    load: loadBy(async () => (await import('../../io/formats/rad/open-rad.ts')).openRad, fetchLeaves),
  },
  {
    mayStream: (name, kind) =>
      /(?:^|\/)lod-meta\.json$/i.test(name) || (kind === 'blob' && /\.(?:sog|zip)$/i.test(name)),
    load: loadBy(async () => (await import('../../io/formats/sog/open-leaves.ts')).openLeaves, fetchLeaves),
  },
];

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
  const loader = LOADERS.find(({ mayStream }) => names.some((name) => mayStream(name, source.kind)));
  return loader ? loader.load(context, source, options, cloudOptions) : null;
}
