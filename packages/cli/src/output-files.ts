import { rename, rm, stat, writeFile } from 'node:fs/promises';
import { basename, dirname, join } from 'node:path';
import { describeSystemError, InputFileError } from './input-error.ts';

export interface OutputFile {
  readonly path: string;
  readonly content: Uint8Array | string;
}

/** @throws InputFileError if `path` cannot become a file. To be called before any work is done. */
export async function checkWritable(path: string): Promise<void> {
  const folder = dirname(path);
  const found = await stat(folder).catch((error) => {
    throw new InputFileError(path, `cannot be written: ${describeSystemError(error)}`, `folder ${folder}`, {
      cause: error,
    });
  });
  if (!found.isDirectory())
    throw new InputFileError(path, 'cannot be written: it would lie in a file', `folder ${folder}`);
  const existing = await stat(path).catch(() => undefined);
  if (existing?.isDirectory()) throw new InputFileError(path, 'cannot be written: it is a folder');
}

/** Writes files under temporary names in the same folders, and renames them once all are complete. */
export async function writeFiles(files: readonly OutputFile[]): Promise<void> {
  const unfinished: string[] = [];
  let current = '';
  try {
    for (const { path, content } of files) {
      current = path;
      const temporary = temporaryPath(path);
      unfinished.push(temporary);
      await writeFile(temporary, content, { flag: 'wx' });
    }
    for (const { path } of files) {
      current = path;
      await rename(temporaryPath(path), path);
    }
  } catch (error) {
    await Promise.all(unfinished.map((path) => rm(path, { force: true })));
    throw new InputFileError(current, `cannot be written: ${describeSystemError(error)}`, undefined, {
      cause: error,
    });
  }
}

function temporaryPath(path: string): string {
  return join(dirname(path), `.${basename(path)}.${process.pid}.part`);
}
