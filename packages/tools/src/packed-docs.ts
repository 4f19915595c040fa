import { readdirSync, readFileSync } from 'node:fs';
import { join, posix } from 'node:path';
import { headingsOf, mapLinks, resolveLink } from '../../../apps/docs/src/build/markdown.ts';
import { assemblePages } from '../../../apps/docs/src/build/pages.ts';

// Documents of a tarball. Pages of the documentation site that a package's README leads to are packed
// with it: they are right for this version, and readers of node_modules need no other address.

/** Sections of the site for people who use the packages. */
const PACKED_SECTIONS = ['learn', 'guides', 'shipping', 'hood'];

/**
 * Returns the README of a package and all pages that it leads to, directly or by other pages, by path
 * in the tarball. Links to anything else, such as sources, become plain text.
 *
 * @param root the repository's.
 * @param name folder below `packages`.
 * @throws DocsError for a broken include, link or anchor.
 */
export function packedDocs(root: string, name: string): Map<string, string> {
  const own = new Map<string, string>();
  const folder = join(root, 'apps/docs/pages');
  for (const file of readdirSync(folder, { recursive: true, withFileTypes: true })) {
    const path = join(file.parentPath, file.name);
    if (file.isFile()) own.set(posix.relative(folder, path), readFileSync(path, 'utf8'));
  }
  // Empty: links to evidence must lead to a page, and none of these is packed.
  for (const file of readdirSync(join(root, 'evidence')))
    own.set(`evidence/${file.replace(/\.json$/, '.md')}`, '');
  const { pages } = assemblePages(
    own,
    (path) => readFileSync(join(root, path), 'utf8'),
    (page) => /^(?:api|examples)\//.test(page),
  );

  const start = `packages/${name}.md`;
  const packed = new Map<string, string>();
  const placeOf = (page: string) => (page === start ? 'README.md' : `docs/${page}`);
  const pack = (page: string) => {
    const place = placeOf(page);
    if (packed.has(place)) return;
    packed.set(place, '');
    const text = mapLinks(plainMarkdown(pages.get(page)!), (target, isImage) => {
      const link = resolveLink(page, target);
      if (link === null || target.startsWith('#')) return target;
      const isPacked = link.path === start || PACKED_SECTIONS.includes(link.path.split('/')[0]);
      if (isImage || !isPacked || !pages.has(link.path)) return null;
      pack(link.path);
      const path = posix.relative(posix.dirname(place), placeOf(link.path));
      return `${path.startsWith('.') ? path : `./${path}`}${link.anchor && `#${link.anchor}`}`;
    });
    packed.set(place, text);
  };
  pack(start);
  return packed;
}

/** Leaves out parts that only the site understands: metadata, comments, and elements that measure. */
function plainMarkdown(text: string): string {
  return text
    .replace(/^---\n[\s\S]*?\n---\n\s*/, '')
    .replace(/^<!--.*-->\n\n?/gm, '')
    .replace(/^<ws-.*>$/gm, '(The documentation site measures your device here.)');
}

/**
 * Finds links of Markdown files that lead nowhere among `files`, one line each.
 *
 * @param files by path. Text matters in Markdown files only.
 */
export function deadLinks(files: ReadonlyMap<string, string>): string[] {
  const problems: string[] = [];
  for (const [from, text] of files)
    if (from.endsWith('.md'))
      mapLinks(text, (target) => {
        const link = resolveLink(from, target);
        if (link === null) return target;
        const linked = files.get(link.path);
        if (linked === undefined)
          problems.push(`${from}: there is no ${link.path}, which “${target}” leads to`);
        else if (link.anchor && !headingsOf(linked).some(({ slug }) => slug === link.anchor))
          problems.push(`${from}: ${link.path} has no heading for “#${link.anchor}”`);
        return target;
      });
  return problems;
}
