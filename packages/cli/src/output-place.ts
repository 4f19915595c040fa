import { type BigIntStats, fstatSync } from 'node:fs';
import { readlink, realpath, stat } from 'node:fs/promises';
import { basename, dirname, join, resolve } from 'node:path';

/** Stands for standard input among inputs, and for standard output among outputs. */
export const STDIO = '-';
export const STDIN_FD = 0;
export const STDOUT_FD = 1;

/** Where writing to a path leads, links followed. */
export interface OutputPlace {
  /** A `file`, maybe new, can be replaced; a `stream` (pipe, device, open file) is written into. */
  readonly kind: 'file' | 'stream' | 'stdout';
  readonly path: string;
  /** Undefined where there is nothing yet. */
  readonly found: BigIntStats | undefined;
}

/** Rejects with the system's error, also where the folder is missing. */
export async function outputPlace(path: string): Promise<OutputPlace> {
  const identity = await identityOf(path, STDOUT_FD);
  const isStdout = identity !== undefined && identity === (await identityOf(STDIO, STDOUT_FD));
  if (path === STDIO || isStdout) return { kind: 'stdout', path, found: undefined };
  const found = await statIfThere(path);
  const target = await followLinks(path);
  const isFile = found === undefined || (found.isFile() && !isOfSystem(dirname(target)));
  return { kind: isFile ? 'file' : 'stream', path: target, found };
}

/**
 * A key that two paths share if they lead to the same file; undefined for terminals and other
 * devices that are read and written independently.
 *
 * @param stdioFd the file descriptor that `-` stands for.
 */
export async function identityOf(path: string, stdioFd: number): Promise<string | undefined> {
  const found = path === STDIO ? fstatSync(stdioFd, { bigint: true }) : await statIfThere(path);
  if (found === undefined) return followLinks(path);
  return found.isCharacterDevice() ? undefined : `${found.dev}:${found.ino}`;
}

function statIfThere(path: string): Promise<BigIntStats | undefined> {
  return stat(path, { bigint: true }).catch((error) => {
    if (error.code === 'ENOENT') return undefined;
    throw error;
  });
}

/** The path at the end of links, which need not be there. */
async function followLinks(path: string): Promise<string> {
  const folder = await realpath(dirname(path));
  const target = join(folder, basename(path));
  if (isOfSystem(folder)) return target;
  // It is no link, or not there.
  const link = await readlink(target).catch(() => undefined);
  return link === undefined ? target : followLinks(resolve(folder, link));
}

/** Whether the entries of a folder stand for devices and open files, such as `/dev/fd/3`. */
function isOfSystem(folder: string): boolean {
  return ['/dev', '/dev/fd'].includes(folder) || folder.startsWith('/proc/');
}
