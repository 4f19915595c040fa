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

/** Lines of `text`, with whether they are fenced code. */
function linesOf(text: string): { readonly line: string; readonly isCode: boolean }[] {
  let fence: string | null = null;
  return text.split('\n').map((line) => {
    const mark = /^\s*(`{3,}|~{3,})/.exec(line)?.[1];
    const isCode = fence !== null || mark !== undefined;
    if (fence === null && mark) fence = mark;
    else if (fence !== null && mark?.startsWith(fence)) fence = null;
    return { line, isCode };
  });
}

/** All headings of `text`, with their anchors on a page of their own. */
export function headingsOf(text: string): Heading[] {
  const headings: Heading[] = [];
  const times = new Map<string, number>();
  for (const [index, { line, isCode }] of linesOf(text).entries()) {
    const [, marks, title] = /^(#{1,6})\s+(.+?)\s*$/.exec(line) ?? [];
    if (!isCode && marks && title) {
      const plain = title.replace(/\[([^\]]*)\]\([^)]*\)/g, '$1').replaceAll('`', '');
      const first = slug(plain);
      const earlier = times.get(first) ?? 0;
      times.set(first, earlier + 1);
      const anchor = earlier === 0 ? first : `${first}-${earlier}`;
      headings.push({ level: marks.length, text: plain, slug: anchor, line: index });
    }
  }
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
  return linesOf(body)
    .map(({ line: each, isCode }) =>
      isCode ? each : each.replace(/^#+(?=\s)/, (marks) => '#'.repeat(marks.length - level + underLevel)),
    )
    .join('\n');
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
  const parts: { readonly isProse: boolean; readonly lines: string[] }[] = [];
  for (const { line, isCode } of linesOf(text)) {
    const isProse = !isCode && line.trim() !== '';
    const last = parts.at(-1);
    if (last?.isProse === isProse) last.lines.push(line);
    else parts.push({ isProse, lines: [line] });
  }
  return parts
    .map(({ isProse, lines }) => (isProse ? mapped(lines.join('\n')) : lines.join('\n')))
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
