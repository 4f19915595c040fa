import { posix } from 'node:path';

/** A file of the built site: text of HTML pages, null for all others. */
export type BuiltFiles = ReadonlyMap<string, string | null>;

/**
 * Checks the links, images, scripts and anchors of built pages against the files.
 *
 * @param files by path in the site, e.g. `guide/loading.html`
 * @param base path under which the site is served, with a slash at both ends
 * @returns problems, one line each
 */
export function linkProblems(files: BuiltFiles, base: string): string[] {
  const anchors = new Map<string, Set<string>>();
  const anchorsOf = (path: string) => {
    const known = anchors.get(path) ?? new Set(attributes(files.get(path)!, /\s(?:id|name)="([^"]*)"/g));
    anchors.set(path, known);
    return known;
  };
  return [...files].flatMap(([path, html]) => {
    if (html === null) return [];
    // Relative targets depend on the page's own URL, but 404.html is served at any URL.
    const targets = new Set(attributes(html, /\s(?:href|src)="([^"]*)"/g));
    return [...targets].flatMap((target) => {
      if (/^(?:https?|mailto|data|blob):/.test(target)) return [];
      const url = new URL(target, `http://site${base}${path}`);
      const name = decodeURIComponent(url.pathname);
      if (!name.startsWith(base)) return [`${path}: ${target} leads out of ${base}.`];
      const file = fileAt(name.slice(base.length), files);
      if (file === null) return [`${path}: there is nothing at ${target}.`];
      const anchor = decodeURIComponent(url.hash.slice(1));
      if (anchor && files.get(file) !== null && !anchorsOf(file).has(anchor))
        return [`${path}: ${file} has no “#${anchor}”.`];
      return [];
    });
  });
}

/** The file that a plain web server sends for `path`; null if there is none. */
function fileAt(path: string, files: BuiltFiles): string | null {
  const file = path === '' || path.endsWith('/') ? posix.join(path, 'index.html') : path;
  return files.has(file) ? file : null;
}

function attributes(html: string, pattern: RegExp): string[] {
  return [...html.matchAll(pattern)].map(([, value]) =>
    value.replaceAll('&amp;', '&').replaceAll('&quot;', '"').replaceAll('&#39;', "'"),
  );
}
