import { existsSync } from 'node:fs';
import { readdir, stat, writeFile } from 'node:fs/promises';
import { basename, join } from 'node:path';
import { readSplats } from '@websplatter/core';
import { formatByName, isLeadingFile } from '@websplatter/core/formats';
import { openFile } from '@websplatter/node';
import { type SceneCamera, syntheticCamera, syntheticPly } from '@websplatter/scenes';
import { BenchError } from './bench-error.ts';
import { camerasAround, readCameras, viewsAround } from './cameras.ts';

/** A scene to measure: one file. */
export interface BenchScene {
  /** The file's name; a PLY's without its extension. */
  readonly name: string;
  readonly file: string;
  readonly fileBytes: number;
  readonly format: SceneFormat;
  readonly splats: number;
  readonly shDegree: number;
  readonly cameras: readonly SceneCamera[];
}

/** Format of a file, as its reader says. */
export interface SceneFormat {
  /** One of `SPLAT_FORMATS`. */
  readonly name: string;
  /** Such as its version; empty where there is only one. */
  readonly variant: string;
}

/**
 * Writes the synthetic scenes into `folder`; returns paths of all scenes' files. Files of a folder
 * are sorted by name.
 *
 * @throws BenchError for numbers of splats that cannot be made, and for folders without scenes.
 */
export async function sceneFiles(
  { scenes, synthetic }: { readonly scenes: readonly string[]; readonly synthetic: readonly number[] },
  folder: string,
): Promise<string[]> {
  const files = [];
  for (const path of scenes) {
    // The reader of a missing file reports it.
    const isFolder = (await stat(path).catch(() => null))?.isDirectory() ?? false;
    for (const file of isFolder ? await filesIn(path) : [path]) files.push(file);
  }
  for (const splats of synthetic) {
    const file = join(folder, `synthetic-${splats}.ply`);
    await writeFile(file, synthesize(splats));
    await writeFile(camerasFileOf(file), JSON.stringify(viewsAround(syntheticCamera)));
    files.push(file);
  }
  return files;
}

/** A file that leads to others is left out: a page is given one. */
async function filesIn(folder: string): Promise<string[]> {
  const isScene = (name: string) => formatByName(name) !== undefined && !isLeadingFile(name);
  const names = (await readdir(folder)).filter((name) => isScene(name) && !name.endsWith('.json')).sort();
  if (names.length === 0) throw new BenchError(`--scenes: there is no scene in ${folder}.`);
  return names.map((name) => join(folder, name));
}

function synthesize(splats: number): ReturnType<typeof syntheticPly> {
  try {
    return syntheticPly({ splats });
  } catch (error) {
    throw new BenchError(`--synthetic: ${(error as Error).message}`);
  }
}

/**
 * Reads a scene and takes its cameras from `camerasFile`, else from the file beside it, else from
 * its bounds.
 *
 * @throws BenchError if a file cannot be read.
 */
export async function readScene(file: string, camerasFile: string | null): Promise<BenchScene> {
  const set = await readFile(file);
  const beside = [`${file}.cameras.json`, camerasFileOf(file)].find((each) => existsSync(each));
  const from = camerasFile ?? beside;
  const cameras = from === undefined ? camerasAround(set) : await readCameras(from);
  const { format: name = 'ply', variant = '' } = set.fileFacts ?? {};
  return {
    name: basename(file).replace(/(?<!\.compressed)\.ply$/, ''),
    file,
    fileBytes: (await stat(file)).size,
    format: { name, variant },
    splats: set.count,
    shDegree: set.harmonics.degree,
    cameras,
  };
}

async function readFile(file: string) {
  try {
    return await readSplats(await openFile(file), { name: file });
  } catch (error) {
    throw new BenchError(`${file}: ${(error as Error).message}`);
  }
}

/** Files of one scene in any format share their cameras. */
function camerasFileOf(file: string): string {
  const ends = formatByName(basename(file))?.extensions ?? [];
  const end = ends.find((each) => file.toLowerCase().endsWith(each)) ?? '';
  return `${file.slice(0, file.length - end.length)}.cameras.json`;
}
