import { execFileSync } from 'node:child_process';
import { existsSync } from 'node:fs';
import { join } from 'node:path';

/** Paths of the repository's files, including uncommitted ones and excluding ignored ones. */
export function repositoryFiles(root: string): string[] {
  const options = ['ls-files', '-z', '--cached', '--others', '--exclude-standard'];
  const listed = execFileSync('git', options, { cwd: root, encoding: 'utf8' }).split('\0');
  // Git lists deleted files, too.
  return listed.filter((path) => path !== '' && existsSync(join(root, path)));
}
