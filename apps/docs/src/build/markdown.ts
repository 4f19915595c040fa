import { posix } from 'node:path';
import { slug } from './slug.ts';

// Markdown of the pages and the repository's documents: ATX headings, fenced code, inline links.

/** Names text of the documentation that cannot be used, with the reason. */
export class DocsError extends Error {
  override readonly name = 'DocsError';
}

export interface Heading {
  /** Number of `#` characters. */
  readonly level: number;
  /** The heading without markup. */
  readonly text: string;
  readonly slug: string;
  /** Index of its line. */
  readonly line: number;
}

/** Maps each line outside of fenced code blocks, which are unchanged. */
function mapLines(text: string, map: (line: string, index: number) => string): string {
  let fence: string | null = null;
  return text
    .split('\n')
    .map((line, index) => {
      const mark = /^\s*(`{3,}|~{3,})/.exec(line)?.[1];
      if (fence === null && mark) fence = mark;
      else if (fence !== null && mark?.startsWith(fence)) fence = null;
      else if (fence === null) return map(line, index);
      return line;
    })
    .join('\n');
}

/** All headings of `text`, with their anchors on a page of their own. */
export function headingsOf(text: string): Heading[] {
  const headings: Heading[] = [];
  const times = new Map<string, number>();
  mapLines(text, (line, index) => {
    const [, marks, title] = /^(#{1,6})\s+(.+?)\s*$/.exec(line) ?? [];
    if (marks && title) {
      const plain = title.replace(/\[([^\]]*)\]\([^)]*\)/g, '$1').replaceAll('`', '');
      const first = slug(plain);
      const earlier = times.get(first) ?? 0;
      times.set(first, earlier + 1);
      const anchor = earlier === 0 ? first : `${first}-${earlier}`;
      headings.push({ level: marks.length, text: plain, slug: anchor, line: index });
    }
    return line;
  });
  return headings;
}

/**
 * Returns the text under a heading, without the heading itself.
 *
 * @param heading its text without markup.
 * @param underLevel level of the heading above the result, whose own headings start one level
 * below.
 * @throws DocsError if there is no such heading.
 */
export function sectionOf(path: string, text: string, heading: string, underLevel: number): string {
  const headings = headingsOf(text);
  const at = headings.findIndex((each) => each.text === heading);
  if (at < 0)
    throw new DocsError(
      `${path} has no heading “${heading}”; it has ${headings.map((each) => `“${each.text}”`).join(', ')}.`,
    );
  const { level, line } = headings[at];
  const end = headings.slice(at + 1).find((each) => each.level <= level)?.line;
  const body = text
    .split('\n')
    .slice(line + 1, end)
    .join('\n')
    .trim();
  return mapLines(body, (each) =>
    each.replace(/^#+(?=\s)/, (marks) => '#'.repeat(marks.length - level + underLevel)),
  );
}

/** Replaces targets of links and images by results of `map`; null keeps only the link's text. */
export function mapLinks(text: string, map: (target: string, isImage: boolean) => string | null): string {
  // A link's text may be an image or code, and code may contain brackets.
  const link = /(`+)[^`]*\1|(!?)\[((?:[^\]`]|`[^`]*`)*)\]\(([^()\s]+)\)/g;
  const mapped = (prose: string): string =>
    prose.replace(link, (all, ticks: string | undefined, mark: string, label: string, target: string) => {
      if (ticks !== undefined) return all;
      const next = map(target, mark === '!');
      return next === null ? mapped(label) : `${mark}[${mapped(label)}](${next})`;
    });
  // A link may go on in the next line, but not in the next paragraph.
  const paragraphs: string[][] = [[]];
  const isProse = new Set<number>();
  mapLines(text, (line, index) => {
    if (line.trim() !== '') isProse.add(index);
    return line;
  });
  for (const [index, line] of text.split('\n').entries()) {
    if (!(isProse.has(index) && isProse.has(index - 1))) paragraphs.push([]);
    paragraphs.at(-1)?.push(line);
  }
  let line = 0;
  return paragraphs
    .slice(1)
    .map((lines) => {
      const whole = lines.join('\n');
      const isMapped = isProse.has(line);
      line += lines.length;
      return isMapped ? mapped(whole) : whole;
    })
    .join('\n');
}

/** A link's path from the root of its tree, and its anchor without `#`; null for external links. */
export function resolveLink(from: string, target: string): { path: string; anchor: string } | null {
  if (/^[a-z][a-z\d+.-]*:|^\/\//i.test(target)) return null;
  const [path, anchor = ''] = target.split('#');
  if (path === '') return { path: from, anchor };
  const absolute = path.startsWith('/') ? path.slice(1) : posix.join(posix.dirname(from), path);
  return { path: decodeURIComponent(absolute), anchor: decodeURIComponent(anchor) };
}
