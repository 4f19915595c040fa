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
  /** What to read it from. */
  readonly source: SplatSource;
  readonly limits: ReadLimits;
  /** Whether y is up, whatever is usual in files of its format. */
  readonly isBuiltin: boolean;
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
  if (builtin) {
    const source = await openFile(fileURLToPath(builtin.url));
    return { name: scene, source, limits: NO_LIMITS, isBuiltin: true };
  }
  if (scene.startsWith(BUILTIN_PREFIX)) {
    const names = builtinScenes.map(({ name }) => `${BUILTIN_PREFIX}${name}`).join(', ');
    throw new UsageError('SCENE', `there is no scene ${scene}; there are ${names}`);
  }
  if (/^(https?|data):/.test(scene)) {
    if (!URL.canParse(scene)) throw new SplatSourceError(scene, 'it is no valid address');
    return { name: scene, source: new URL(scene), limits: {}, isBuiltin: false };
  }
  return { name: scene, source: await openNamed(scene), limits: NO_LIMITS, isBuiltin: false };
}

/** Reads the splats of a scene into memory. */
export function readScene(
  { name, source, limits }: SceneSource,
  shPrecision: ShPrecision,
  onProgress?: (progress: LoadProgress) => void,
): Promise<SplatSet<Harmonics>> {
  return readSplats(source, { ...limits, name, shPrecision, onProgress });
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
