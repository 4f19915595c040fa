import { readFileSync } from 'node:fs';
import { join } from 'node:path';

/** Packages in the order of the sidebar. The first that exports a name documents it. */
const API_PACKAGES = ['core', 'three', 'react', 'scenes'] as const;

/** Entry points without an API: scripts to be served. */
const SCRIPTS = new Set(['core/load-worker']);

export interface ApiEntry {
  /** Name after `@websplatter/` in an import, e.g. `core/effects`. */
  readonly name: string;
  /** Path of its source, from the root of the repository. */
  readonly source: string;
}

/** The entry points in the packages' manifests. */
export function apiEntries(root: string): ApiEntry[] {
  return API_PACKAGES.flatMap((folder) => {
    const { exports } = JSON.parse(readFileSync(join(root, 'packages', folder, 'package.json'), 'utf8'));
    return Object.entries<string | Record<string, string>>(exports)
      .flatMap(([subpath, conditions]) => {
        // Files other than code have no source.
        if (typeof conditions === 'string') return [];
        const source = join('packages', folder, conditions['@websplatter/source']);
        return [{ name: `${folder}${subpath.slice(1)}`, source }];
      })
      .filter(({ name }) => !SCRIPTS.has(name));
  });
}
