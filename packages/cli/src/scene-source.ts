import { fileURLToPath } from 'node:url';
import {
  type Harmonics,
  type LoadProgress,
  type ReadLimits,
  readSplats,
  type ShPrecision,
  type SplatSet,
  type SplatSource,
  SplatSourceError,
} from '@websplatter/core';
import { openFile } from '@websplatter/node';
import { builtinScenes } from '@websplatter/scenes';
import { describeSystemError, UsageError } from './input-error.ts';

/** A scene named on the command line, still unread. */
export interface SceneSource {
  /** As given on the command line; messages use it. */
  readonly name: string;
  /** Makes the splats of a built-in scene, or the source to read them from. */
  readonly content: { readonly make: () => SplatSet } | ({ readonly source: SplatSource } & ReadLimits);
}

const BUILTIN_PREFIX = 'builtin:';
/** A file on this machine may be as large as its owner likes. What an address sends has the usual limits. */
const NO_LIMITS: ReadLimits = { maxBytes: Number.POSITIVE_INFINITY, maxSplats: Number.POSITIVE_INFINITY };

/**
 * Resolves `scene`: `builtin:NAME`, the NAME of a built-in scene, a URL (http, https, file) or a path.
 *
 * @throws SplatSourceError if there is no such file; UsageError if there is no such built-in scene.
 */
export async function findScene(scene: string): Promise<SceneSource> {
  const builtinName = scene.startsWith(BUILTIN_PREFIX) ? scene.slice(BUILTIN_PREFIX.length) : scene;
  const builtin = builtinScenes.find(({ name }) => name === builtinName);
  if (builtin) return { name: scene, content: { make: () => builtin.make() } };
  if (scene.startsWith(BUILTIN_PREFIX)) {
    const names = builtinScenes.map(({ name }) => `${BUILTIN_PREFIX}${name}`).join(', ');
    throw new UsageError('SCENE', `there is no scene ${scene}; there are ${names}`);
  }
  if (/^(https?|data):/.test(scene)) {
    if (!URL.canParse(scene)) throw new SplatSourceError(scene, 'it is no valid address');
    return { name: scene, content: { source: new URL(scene) } };
  }
  return { name: scene, content: { source: await openNamed(scene), ...NO_LIMITS } };
}

/** Reads the splats of a scene into memory. */
export async function readScene(
  scene: SceneSource,
  shPrecision: ShPrecision,
  onProgress?: (progress: LoadProgress) => void,
): Promise<SplatSet<Harmonics>> {
  if ('make' in scene.content) return scene.content.make();
  const { source, ...limits } = scene.content;
  return readSplats(source, { ...limits, name: scene.name, shPrecision, onProgress });
}

async function openNamed(scene: string): Promise<SplatSource> {
  try {
    return await openFile(scene.startsWith('file:') ? fileURLToPath(scene) : scene);
  } catch (error) {
    const cause = describeSystemError(error);
    const isFolder = (error as NodeJS.ErrnoException).code === 'EISDIR';
    throw new SplatSourceError(scene, isFolder ? cause : `cannot be read: ${cause}`, undefined, {
      cause: error,
    });
  }
}
