import { randomUUID } from 'node:crypto';
import { readdir, stat } from 'node:fs/promises';
import { hostname } from 'node:os';
import { join } from 'node:path';
import { printable } from '@websplatter/core';
import type { Console } from './console.ts';

/** The machine's name in names of files: containers have names of their own, and the same process ids. */
const HOST = hostname()
  .replace(/[^\w.-]/g, '_')
  .slice(0, 64);
const PART = /^\.websplatter-(?<host>.+)-(?<pid>\d+)-[\da-f-]{36}\.part$/;
/** Names that a note lists; it counts the others. */
const MOST_NAMED = 3;

/**
 * A path in `folder` for an incomplete file. It is random, so that no other run has it, and short,
 * so that results may have names as long as the system allows.
 */
export function partPath(folder: string): string {
  return join(folder, `.websplatter-${HOST}-${process.pid}-${randomUUID()}.part`);
}

/** Says which incomplete files killed runs have left in folders. Nothing is removed. */
export async function noteLeftParts(folders: Iterable<string>, console: Console): Promise<void> {
  for (const folder of new Set(folders)) {
    // Whoever writes into a folder that cannot be listed reports it.
    const names = (await readdir(folder).catch(() => [])).filter(isLeft).sort();
    if (names.length === 0) continue;
    // Another run may have removed its file meanwhile.
    const sizes = await Promise.all(names.map((name) => stat(join(folder, name)).catch(() => null)));
    const bytes = sizes.reduce((sum, found) => sum + (found?.size ?? 0), 0);
    const others = names.length > MOST_NAMED ? ', …' : '';
    const listed = names.slice(0, MOST_NAMED).join(', ') + others;
    const files = names.length === 1 ? '1 incomplete file' : `${names.length} incomplete files`;
    const inAll = `${bytes.toLocaleString('en')} bytes`;
    console.err(
      `note: ${printable(folder)} has ${files} of runs that were killed or are at work on another machine (${printable(listed)}; ${inAll}); remove what no run is writing\n`,
    );
  }
}

/** Whether a name is of an incomplete file whose process is not known to be at work. */
function isLeft(name: string): boolean {
  const found = PART.exec(name)?.groups;
  if (!found) return false;
  const pid = Number(found.pid);
  // One of this process's id was made by another, before or in a container of the same name.
  return found.host !== HOST || pid === process.pid || !isAlive(pid);
}

function isAlive(pid: number): boolean {
  try {
    return process.kill(pid, 0);
  } catch (error) {
    return (error as NodeJS.ErrnoException).code === 'EPERM';
  }
}
