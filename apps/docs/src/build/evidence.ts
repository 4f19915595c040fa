import { readdirSync, readFileSync } from 'node:fs';
import { join } from 'node:path';
import { DocsError } from './markdown.ts';

// Measurements as data: `evidence/NAME.json` of the repository. Each file becomes a page of the site, to
// which captions of other pages link.

/** The conditions of one run, as far as they are known. */
export interface EvidenceRun {
  readonly commit?: string;
  /** Year-month-day. */
  readonly date?: string;
  readonly machine?: string;
  /** The GPU, by the name that its driver gives. */
  readonly adapter?: string;
  readonly driver?: string;
  /** Name and version; or the program that drew instead of one. */
  readonly browser?: string;
  /** The command line. */
  readonly command?: string;
}

export interface EvidenceTable {
  readonly caption: string;
  /** Headings, with units. */
  readonly columns: readonly string[];
  /** Values by column; null where nothing was measured. Strings are Markdown without links. */
  readonly rows: readonly (readonly EvidenceCell[])[];
}

type EvidenceCell = string | number | null;

/** One run, or runs of one subject. All texts are Markdown without links. */
export interface Evidence {
  readonly title: string;
  /** One sentence. */
  readonly conclusion: string;
  /** The only run; `runs` if there are several. */
  readonly run?: EvidenceRun;
  readonly runs?: readonly EvidenceRun[];
  readonly tables?: readonly EvidenceTable[];
  /** Sentences with figures that no table has. */
  readonly remarks?: readonly string[];
}

const RUN_FIELDS = ['commit', 'date', 'machine', 'adapter', 'driver', 'browser', 'command'];
const FIELDS = ['title', 'conclusion', 'run', 'runs', 'tables', 'remarks'];

/** Evidence by name: contents of `evidence/*.json`. */
export function readEvidence(root: string): Map<string, Evidence> {
  const folder = join(root, 'evidence');
  return new Map(
    readdirSync(folder)
      .filter((file) => file.endsWith('.json'))
      .sort()
      .map((file) => [
        file.replace(/\.json$/, ''),
        parseEvidence(`evidence/${file}`, readFileSync(join(folder, file), 'utf8')),
      ]),
  );
}

/**
 * Reads a file of evidence.
 *
 * @param path only for messages
 * @throws DocsError that names the file, and the row, for unknown or missing fields, values of
 * another type and rows that have not one value for each column.
 */
export function parseEvidence(path: string, text: string): Evidence {
  const fail = (message: string): never => {
    throw new DocsError(`${path}: ${message}`);
  };
  const object = (value: unknown, at: string, fields: readonly string[]): Record<string, unknown> => {
    if (typeof value !== 'object' || value === null || Array.isArray(value))
      return fail(`${at} is no object.`);
    for (const field of Object.keys(value))
      if (!fields.includes(field)) fail(`${at} has an unknown field “${field}”.`);
    return value as Record<string, unknown>;
  };
  const list = (value: unknown, at: string): unknown[] =>
    Array.isArray(value) ? value : fail(`${at} is no list.`);
  const sentence = (value: unknown, at: string) => {
    if (typeof value !== 'string' || value.trim() === '') fail(`${at} is no text.`);
  };
  const run = (value: unknown, at: string) => {
    for (const [field, each] of Object.entries(object(value, at, RUN_FIELDS)))
      sentence(each, `${at}.${field}`);
  };
  const table = (value: unknown, at: string) => {
    const { caption, columns, rows } = object(value, at, ['caption', 'columns', 'rows']);
    sentence(caption, `${at}.caption`);
    const headings = list(columns, `${at}.columns`);
    if (headings.some((heading) => typeof heading !== 'string')) fail(`${at}.columns has what is no text.`);
    for (const [index, each] of list(rows, `${at}.rows`).entries()) {
      const row = list(each, `${at}.rows[${index}]`);
      if (row.length !== headings.length)
        fail(`${at}.rows[${index}] has ${row.length} values for ${headings.length} columns.`);
      if (!row.every((cell) => cell === null || typeof cell === 'string' || Number.isFinite(cell)))
        fail(`${at}.rows[${index}] has a value that is neither text nor number nor null.`);
    }
  };

  let parsed: unknown;
  try {
    parsed = JSON.parse(text);
  } catch (error) {
    return fail((error as Error).message);
  }
  const evidence = object(parsed, 'the file', FIELDS);
  sentence(evidence.title, 'title');
  sentence(evidence.conclusion, 'conclusion');
  if (evidence.run !== undefined && evidence.runs !== undefined) fail('it has both run and runs.');
  if (evidence.run !== undefined) run(evidence.run, 'run');
  for (const [index, each] of list(evidence.runs ?? [], 'runs').entries()) run(each, `runs[${index}]`);
  for (const [index, each] of list(evidence.tables ?? [], 'tables').entries())
    table(each, `tables[${index}]`);
  for (const [index, each] of list(evidence.remarks ?? [], 'remarks').entries())
    sentence(each, `remarks[${index}]`);
  if (evidence.tables === undefined && evidence.remarks === undefined)
    fail('it has neither tables nor remarks.');
  return evidence as unknown as Evidence;
}

/** The page of a file of evidence, by its path in the repository; null for other files. */
export function evidencePageOf(path: string): string | null {
  const name = /^evidence\/([^/]+)\.json$/.exec(path)?.[1];
  return name === undefined ? null : `evidence/${name}.md`;
}

/** Markdown of the page that shows all of `evidence`. */
export function evidencePage({
  title,
  conclusion,
  run,
  runs = run ? [run] : [],
  tables = [],
  remarks = [],
}: Evidence): string {
  const known = RUN_FIELDS.filter((field) => runs.some((each) => field in each)) as (keyof EvidenceRun)[];
  const conditions = {
    columns: known.map((field) => `${field[0].toUpperCase()}${field.slice(1)}`),
    rows: runs.map((each) => known.map((field) => each[field] ?? null)),
  };
  return `${[
    // Searches would find these figures before the pages that explain them.
    '---\nsearch: false\n---',
    `# ${inline(title)}`,
    inline(conclusion),
    ...(known.length > 0 ? ['## Runs', markdownTable(conditions)] : []),
    ...tables.flatMap((table) => [`## ${inline(table.caption)}`, markdownTable(table)]),
    ...(remarks.length > 0 ? ['## Remarks', remarks.map((each) => `- ${inline(each)}`).join('\n')] : []),
  ].join('\n\n')}\n`;
}

/** Markdown of the page that lists all evidence. */
export function evidenceIndex(all: ReadonlyMap<string, Evidence>): string {
  return `---
search: false
---

# Evidence

What was measured, run by run: the figures that other pages draw conclusions from. The files are
\`evidence/*.json\` in the repository.

${[...all].map(([name, { title, conclusion }]) => `- [${inline(title)}](${name}.md): ${inline(conclusion)}`).join('\n')}
`;
}

function markdownTable({ columns, rows }: Pick<EvidenceTable, 'columns' | 'rows'>): string {
  const line = (cells: readonly EvidenceCell[]) => `| ${cells.map(cellText).join(' | ')} |`;
  return [line(columns), line(columns.map(() => '---')), ...rows.map(line)].join('\n');
}

function cellText(cell: EvidenceCell): string {
  if (cell === null) return '–';
  if (typeof cell === 'string') return inline(cell).replaceAll('|', '\\|');
  return Math.abs(cell) < 10_000 ? String(cell) : cell.toLocaleString('en', { maximumFractionDigits: 20 });
}

/** One line of Markdown, in which `<` begins no element. */
const inline = (text: string): string =>
  text.replace(/\s+/g, ' ').replace(/(`+)[^`]*\1|</g, (found) => (found === '<' ? '&lt;' : found));
