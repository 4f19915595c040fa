import { existsSync, openAsBlob } from 'node:fs';
import { writeFile } from 'node:fs/promises';
import { basename, join } from 'node:path';
import { perspectiveCamera, readSplats } from '@websplatter/core';
import { renderReference } from '@websplatter/core/reference';
import { type SceneCamera, syntheticCamera, syntheticPly } from '@websplatter/scenes';
import { BenchError } from './bench-error.ts';
import { camerasAround, readCameras, viewsAround } from './cameras.ts';
import type { BenchOptions } from './options.ts';

/** A scene, and what a picture of it must be. */
export interface BenchScene {
  readonly name: string;
  readonly plyFile: string;
  readonly splats: number;
  readonly shDegree: number;
  readonly cameras: readonly SceneCamera[];
  /** Premultiplied RGBA in float64 by each camera, at the pictures' size; none where no pictures are taken. */
  readonly references: readonly Float64Array[];
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
 * Reads a scene, takes its cameras from the options' file, the file beside it or its bounds, and draws its references.
 *
 * @throws BenchError if a file cannot be read.
 */
export async function readScene(
  plyFile: string,
  { camerasFile, pictureSize, takesPictures }: BenchOptions,
): Promise<BenchScene> {
  const name = basename(plyFile).replace(/\.ply$/, '');
  const set = await readPly(plyFile);
  const ownCameras = camerasFileOf(plyFile);
  const file = camerasFile ?? (existsSync(ownCameras) ? ownCameras : null);
  const cameras = file ? await readCameras(file) : camerasAround(set);
  const aspect = pictureSize.widthPx / pictureSize.heightPx;
  const references = (takesPictures ? cameras : []).map((camera) => {
    const { data } = renderReference({
      clouds: [{ set }],
      camera: perspectiveCamera({ ...camera, aspect }),
      ...pictureSize,
    });
    return data;
  });
  return { name, plyFile, splats: set.count, shDegree: set.harmonics.degree, cameras, references };
}

async function readPly(file: string) {
  try {
    return await readSplats(await openAsBlob(file), { name: file, shPrecision: 'f32' });
  } catch (error) {
    throw new BenchError(`${file}: ${(error as Error).message}`);
  }
}

function camerasFileOf(plyFile: string): string {
  return plyFile.replace(/\.ply$/, '.cameras.json');
}
