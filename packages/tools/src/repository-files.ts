import { execFileSync } from 'node:child_process';
import { existsSync } from 'node:fs';
import { join } from 'node:path';

/** Paths of the repository's files, those that are not committed yet too, but for what git ignores: what was installed or built. */
export function repositoryFiles(root: string): string[] {
  const options = ['ls-files', '-z', '--cached', '--others', '--exclude-standard'];
  const listed = execFileSync('git', options, { cwd: root, encoding: 'utf8' }).split('\0');
  // Git lists what was deleted, too.
  return listed.filter((path) => path !== '' && existsSync(join(root, path)));
}
