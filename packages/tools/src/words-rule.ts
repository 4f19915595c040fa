/** Most words of a sentence of prose. */
export const MOST_WORDS = 35;

export interface WordsProblem {
  /** 1-based line at which the paragraph begins. */
  readonly line: number;
  readonly problem: string;
}

/** A commit's abbreviated hash: 7 to 40 hexadecimal digits, of which some are letters and some are not. */
const HASH = /\b(?=[0-9a-f]*\d)(?=[0-9a-f]*[a-f])[0-9a-f]{7,40}\b/;
const HISTORY = /\b(?:until|since|before|at) commit\b/i;

/**
 * Finds sentences of Markdown with more than `MOST_WORDS` words, and lines that name a commit.
 * Tables, headings and code have no sentences; code between backticks counts as one word each.
 */
export function wordsProblems(markdown: string): WordsProblem[] {
  const problems: WordsProblem[] = [];
  for (const { line, text } of paragraphsOf(markdown))
    for (const sentence of text.split(/(?<=[.!?:])\s+(?=[A-Z`*"“[])/)) {
      const words = sentence.match(/`[^`]*`|[\p{L}\p{N}][\p{L}\p{N}'’.,-]*/gu)?.length ?? 0;
      if (words > MOST_WORDS) problems.push({ line, problem: `${words} words: ${sentence.slice(0, 60)}…` });
    }
  let isCode = false;
  for (const [index, text] of markdown.split('\n').entries()) {
    if (isFence(text)) isCode = !isCode;
    else if (!isCode && (HASH.test(text) || HISTORY.test(text)))
      problems.push({ line: index + 1, problem: `a commit: ${text.trim().slice(0, 60)}` });
  }
  return problems;
}

const isFence = (line: string) => /^\s*(?:```|~~~)/.test(line);

/** Paragraphs and items of lists, each joined to one line; without tables, headings, code and HTML. */
function paragraphsOf(markdown: string): { readonly line: number; readonly text: string }[] {
  const paragraphs: { line: number; text: string }[] = [];
  let isCode = false;
  let isOpen = false;
  for (const [index, text] of withoutFrontMatter(markdown).split('\n').entries()) {
    if (isFence(text)) isCode = !isCode;
    const isProse = !isCode && !isFence(text) && text.trim() !== '' && !/^\s*(?:\||#|<)/.test(text);
    const isItem = /^\s*(?:[-*]|\d+\.)\s/.test(text);
    if (isProse && (!isOpen || isItem)) paragraphs.push({ line: index + 1, text: '' });
    const last = paragraphs.at(-1);
    if (isProse && last) last.text += ` ${text.trim()}`;
    isOpen = isProse;
  }
  return paragraphs;
}

/** Blanks the metadata at the top of a page, so that lines keep their numbers. */
function withoutFrontMatter(markdown: string): string {
  return markdown.replace(/^---\n[\s\S]*?\n---\n/, (all) => '\n'.repeat(all.split('\n').length - 1));
}
