import { fileURLToPath } from 'node:url';
import {
  type Harmonics,
  type LoadProgress,
  type ReadLimits,
  readSplats,
  type ShPrecision,
  type SplatFormatName,
  type SplatSet,
  type SplatSource,
  SplatSourceError,
} from '@websplatter/core';
import { formatByName } from '@websplatter/core/formats';
import { openFrames } from '@websplatter/core/frames';
import { readSplatPieces } from '@websplatter/core/write';
import { openFile, openStdin } from '@websplatter/node';
import { builtinScenes } from '@websplatter/scenes';
import { describeSystemError, UsageError } from './input-error.ts';
import { STDIO } from './output-place.ts';

/** A scene named on the command line, still unread. */
export interface SceneSource {
  /** As given on the command line; messages use it. */
  readonly name: string;
  /** The source to read. */
  readonly source: SplatSource;
  readonly limits: ReadLimits;
  /** Format that the command line says it has; undefined: found by first bytes and names. */
  readonly format?: SplatFormatName;
  /** Files that are read, as far as known; one that refers to others is first. `-`: standard input. */
  readonly files: ReadonlySet<string>;
  /** Whether it is a built-in scene. These have y up, even in formats that usually have y down. */
  readonly isBuiltin: boolean;
}

const BUILTIN_PREFIX = 'builtin:';
/** Files on this machine may have any size. Data from an address has the usual limits. */
const NO_LIMITS: ReadLimits = { maxBytes: Number.POSITIVE_INFINITY, maxSplats: Number.POSITIVE_INFINITY };

/**
 * Resolves `scene`: `builtin:NAME`, the NAME of a built-in scene, a URL (http, https, file), a
 * path, or `-` for standard input.
 *
 * @param format see `SceneSource`.
 * @param timeS of a file of frames, the time of the frame to be read; by default the first is.
 * @throws SplatSourceError if there is no such file; UsageError if there is no such built-in scene;
 *   SplatFileError for a wrong file of frames.
 */
export async function findScene(
  scene: string,
  format?: SplatFormatName,
  timeS?: number,
): Promise<SceneSource> {
  const found = await findSource(scene);
  if (timeS === undefined || !isFrames(scene, format)) return { ...found, format };
  const { frames, framesPerS } = await openFrames(found.source, { ...found.limits, name: scene });
  // As `SplatSequence.seek`, but for rounding.
  const frame = Math.floor(timeS * framesPerS + 1e-6);
  return { ...found, source: frames[Math.max(0, Math.min(frames.length - 1, frame))] };
}

/** Whether a scene is a file of frames, by its name or by what the command line says. */
export function isFrames(scene: string, format?: SplatFormatName): boolean {
  return (format ?? formatByName(scene.split(/[?#]/, 1)[0])?.name) === 'frames';
}

async function findSource(scene: string): Promise<SceneSource> {
  const builtinName = scene.startsWith(BUILTIN_PREFIX) ? scene.slice(BUILTIN_PREFIX.length) : scene;
  const builtin = builtinScenes.find(({ name }) => name === builtinName);
  if (builtin) {
    return { name: scene, ...(await openNamed(fileURLToPath(builtin.url))), isBuiltin: true };
  }
  if (scene.startsWith(BUILTIN_PREFIX)) {
    const names = builtinScenes.map(({ name }) => `${BUILTIN_PREFIX}${name}`).join(', ');
    throw new UsageError('SCENE', `there is no scene ${scene}; there are ${names}`);
  }
  if (/^(https?|data):/.test(scene)) {
    if (!URL.canParse(scene)) throw new SplatSourceError(scene, 'it is no valid address');
    return { name: scene, source: new URL(scene), limits: {}, files: new Set(), isBuiltin: false };
  }
  if (scene === STDIO) {
    return { name: scene, source: openStdin(), limits: NO_LIMITS, files: new Set([STDIO]), isBuiltin: false };
  }
  return { name: scene, ...(await openNamed(scene)), isBuiltin: false };
}

/** Reads the splats of a scene into memory. */
export function readScene(
  { name, source, limits, format }: SceneSource,
  shPrecision: ShPrecision,
  onProgress?: (progress: LoadProgress) => void,
): Promise<SplatSet<Harmonics>> {
  return readSplats(source, { ...limits, format, name, shPrecision, onProgress });
}

/** Reads the splats of a scene, and hands them on piece by piece; see `readSplatPieces`. */
export function readScenePieces(
  { name, source, limits, format }: SceneSource,
  shPrecision: ShPrecision,
  onPiece: (piece: SplatSet<Harmonics>) => Promise<void>,
  onProgress?: (progress: LoadProgress) => void,
): Promise<void> {
  return readSplatPieces(source, { ...limits, format, name, shPrecision, onProgress }, onPiece);
}

async function openNamed(scene: string): Promise<Pick<SceneSource, 'source' | 'limits' | 'files'>> {
  const files = new Set<string>();
  try {
    const path = scene.startsWith('file:') ? fileURLToPath(scene) : scene;
    return { source: await openFile(path, (file) => files.add(file)), limits: NO_LIMITS, files };
  } catch (error) {
    if (error instanceof SplatSourceError) throw error;
    const cause = describeSystemError(error);
    const isFolder = (error as NodeJS.ErrnoException).code === 'EISDIR';
    throw new SplatSourceError(scene, isFolder ? cause : `cannot be read: ${cause}`, undefined, {
      cause: error,
    });
  }
}
