import { existsSync } from 'node:fs';
import { posix } from 'node:path';
import { REPOSITORY_PAGES } from './contents.ts';
import { evidencePageOf } from './evidence.ts';
import { DocsError, headingsOf, mapLinks, resolveLink, sectionOf } from './markdown.ts';

/** URL path, within the site, of an image in the repository. */
export const siteImage = (path: string): string => `/images/${posix.basename(path)}`;

/** Folder in the repository of the site's own pages. */
const OWN_PAGES = 'apps/docs/pages/';

/** Reads a file of the repository, e.g. `docs/effects.md`. */
export type ReadRepository = (path: string) => string;

export interface Assembled {
  /** Markdown by path in the site. */
  readonly pages: ReadonlyMap<string, string>;
  /** Images of the repository that pages use, by path; the site has them under `images/`. */
  readonly images: ReadonlySet<string>;
}

/**
 * Assembles the site's own pages, including sections of the repository's documents, and the
 * documents that are whole pages. Links to documents, and to `apps/docs/pages`, become links to pages;
 * links to other files of the repository become plain text.
 *
 * A line `<!-- include PATH#Heading -->` is replaced by the document's text under the heading.
 *
 * @param own Markdown of the site's own pages, by path in the site.
 * @param generated whether a page at this path is generated later, e.g. for the API.
 * @throws DocsError for a broken include, link or anchor.
 */
export function assemblePages(
  own: ReadonlyMap<string, string>,
  read: ReadRepository,
  generated: (page: string) => boolean,
): Assembled {
  const images = new Set<string>();
  const problems: string[] = [];
  const pages = new Map<string, string>();
  /** Documents by their pages. */
  const homes = new Map(Object.entries(REPOSITORY_PAGES).map(([path, page]) => [page, path]));
  const linksToOwn: { readonly path: string; readonly page: string; readonly anchor: string }[] = [];

  const anchorsOf = (text: string) => new Set(headingsOf(text).map(({ slug }) => slug));
  /** Text of a document in the repository, with links and images rewritten for `page`. */
  const fromRepository = (text: string, path: string, page: string) =>
    mapLinks(text, (target, isImage) => {
      const link = resolveLink(path, target);
      if (link === null) return target;
      if (isImage) {
        images.add(link.path);
        return siteImage(link.path);
      }
      const evidence = evidencePageOf(link.path);
      if (evidence !== null) {
        if (!own.has(evidence)) problems.push(`${path}: there is no ${link.path}.`);
        return `/${evidence}`;
      }
      const ownPage = link.path.startsWith(OWN_PAGES) ? link.path.slice(OWN_PAGES.length) : undefined;
      const home = REPOSITORY_PAGES[link.path] ?? ownPage;
      if (home === undefined) return null;
      if (ownPage !== undefined) linksToOwn.push({ path, page: ownPage, anchor: link.anchor });
      else if (link.anchor && !anchorsOf(read(link.path)).has(link.anchor))
        problems.push(`${path}: ${link.path} has no heading for “#${link.anchor}”.`);
      const hash = link.anchor && `#${link.anchor}`;
      return home === page && hash ? hash : `/${home}${hash}`;
    });

  /** Text of one of the site's own pages, with links to documents and images of the repository rewritten. */
  const withDocuments = (text: string, page: string) =>
    mapLinks(text, (target, isImage) => {
      const link = resolveLink(`${OWN_PAGES}${page}`, target);
      if (link === null) return target;
      if (isImage && link.path.startsWith('docs/images/')) {
        images.add(link.path);
        return siteImage(link.path);
      }
      const home = REPOSITORY_PAGES[link.path];
      if (home === undefined) return target;
      if (link.anchor && !anchorsOf(read(link.path)).has(link.anchor))
        problems.push(`${page}: ${link.path} has no heading for “#${link.anchor}”.`);
      return `/${home}${link.anchor && `#${link.anchor}`}`;
    });

  for (const [path, page] of Object.entries(REPOSITORY_PAGES))
    pages.set(page, fromRepository(read(path), path, page));
  for (const [page, text] of own) {
    if (pages.has(page))
      throw new DocsError(`${page} is made of a document of the repository; name it otherwise.`);
    pages.set(page, includeSections(withDocuments(text, page), page, read, fromRepository));
  }
  for (const { path, page, anchor } of linksToOwn) {
    const linked = pages.get(page);
    if (linked === undefined) problems.push(`${path}: there is no page ${page}.`);
    else if (anchor && !anchorsOf(linked).has(anchor))
      problems.push(`${path}: ${page} has no heading for “#${anchor}”.`);
  }
  for (const [page, text] of own)
    mapLinks(text, (target) => {
      const link = resolveLink(page, target);
      const document = resolveLink(`${OWN_PAGES}${page}`, target)?.path ?? '';
      if (link === null || !link.path.endsWith('.md') || REPOSITORY_PAGES[document]) return target;
      const linked = pages.get(link.path);
      if (homes.has(link.path))
        problems.push(`${page}: “${target}” leads nowhere in a clone: link ${homes.get(link.path)}.`);
      else if (linked === undefined && !generated(link.path))
        problems.push(`${page}: there is no page ${link.path}, which “${target}” leads to.`);
      else if (linked !== undefined && link.anchor && !anchorsOf(linked).has(link.anchor))
        problems.push(`${page}: ${link.path} has no heading for “#${link.anchor}”.`);
      return target;
    });
  if (problems.length > 0) throw new DocsError(problems.join('\n'));
  return { pages, images };
}

function includeSections(
  text: string,
  page: string,
  read: ReadRepository,
  fromRepository: (text: string, path: string, page: string) => string,
): string {
  const headings = headingsOf(text);
  return text
    .split('\n')
    .map((line, index) => {
      const [, path, heading] = /^<!-- include ([^#]+)#(.+) -->$/.exec(line) ?? [];
      if (path === undefined) {
        if (line.startsWith('<!-- include')) throw new DocsError(`${page}: “${line}” names no heading.`);
        return line;
      }
      const under = headings.findLast((each) => each.line < index)?.level ?? 1;
      return fromRepository(sectionOf(path, read(path), heading, under), path, page);
    })
    .join('\n');
}

/** @throws DocsError if pages of the sidebar are missing, or if a page is in no section. */
export function checkSidebar(
  pages: Iterable<string>,
  sections: readonly { readonly pages: readonly { readonly page: string }[] }[],
): void {
  const listed = new Set(sections.flatMap((section) => section.pages.map(({ page }) => page)));
  const existing = new Set(pages);
  const problems = [
    ...[...listed]
      .filter((page) => !existing.has(page))
      .map((page) => `The sidebar names ${page}, which is no page.`),
    ...[...existing]
      .filter((page) => !listed.has(page))
      .map((page) => `${page} is in no section of the sidebar.`),
  ];
  if (problems.length > 0) throw new DocsError(problems.join('\n'));
}

/** @throws DocsError if an image is missing in the repository. */
export function checkImages(images: ReadonlySet<string>, root: string): void {
  const missing = [...images].filter((path) => !existsSync(posix.join(root, path)));
  if (missing.length > 0) throw new DocsError(`There are no images ${missing.join(', ')}.`);
}
