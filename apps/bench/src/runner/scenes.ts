import { existsSync } from 'node:fs';
import { writeFile } from 'node:fs/promises';
import { basename, join } from 'node:path';
import { readSplats } from '@websplatter/core';
import { openFile } from '@websplatter/node';
import { type SceneCamera, syntheticCamera, syntheticPly } from '@websplatter/scenes';
import { BenchError } from './bench-error.ts';
import { camerasAround, readCameras, viewsAround } from './cameras.ts';
import type { BenchOptions } from './options.ts';

/** A scene to measure. */
export interface BenchScene {
  readonly name: string;
  readonly plyFile: string;
  readonly splats: number;
  readonly shDegree: number;
  readonly cameras: readonly SceneCamera[];
}

/**
 * Writes the synthetic scenes into `folder`; returns the paths of all scenes' files.
 *
 * @throws BenchError for numbers of splats that cannot be made.
 */
export async function sceneFiles({ scenes, synthetic }: BenchOptions, folder: string): Promise<string[]> {
  const written = [];
  for (const splats of synthetic) {
    const file = join(folder, `synthetic-${splats}.ply`);
    await writeFile(file, synthesize(splats));
    await writeFile(camerasFileOf(file), JSON.stringify(viewsAround(syntheticCamera)));
    written.push(file);
  }
  return [...scenes, ...written];
}

function synthesize(splats: number): ReturnType<typeof syntheticPly> {
  try {
    return syntheticPly({ splats });
  } catch (error) {
    throw new BenchError(`--synthetic: ${(error as Error).message}`);
  }
}

/**
 * Reads a scene and takes its cameras from `camerasFile`, else from the file beside it, else from its bounds.
 *
 * @throws BenchError if a file cannot be read.
 */
export async function readScene(plyFile: string, camerasFile: string | null): Promise<BenchScene> {
  const name = basename(plyFile).replace(/\.ply$/, '');
  const set = await readPly(plyFile);
  const ownCameras = camerasFileOf(plyFile);
  const file = camerasFile ?? (existsSync(ownCameras) ? ownCameras : null);
  const cameras = file ? await readCameras(file) : camerasAround(set);
  return { name, plyFile, splats: set.count, shDegree: set.harmonics.degree, cameras };
}

async function readPly(file: string) {
  try {
    return await readSplats(await openFile(file), { name: file });
  } catch (error) {
    throw new BenchError(`${file}: ${(error as Error).message}`);
  }
}

function camerasFileOf(plyFile: string): string {
  return plyFile.replace(/\.ply$/, '.cameras.json');
}
