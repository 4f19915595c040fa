import { DocsError } from './markdown.ts';

// Tables made of comments in tests: failure modes, and the claims that slow test files prove.

/** Sections of the page of failure modes, in order. An annotation names one of them. */
const SECTIONS = [
  'GPU memory',
  'Devices and engines',
  'Time',
  'Order',
  'Files',
  'Servers',
  'Arguments',
  'Effects',
  'three.js and React',
  'Listeners',
  'Pages and packages',
  'Saved files',
  'Command line',
  'Other WebGPUs',
] as const;
type FaultSection = (typeof SECTIONS)[number];

interface Fault {
  readonly section: FaultSection;
  readonly fault: string;
  readonly consequence: string;
  /** Paths of the files whose tests show it, in the repository. */
  readonly tests: readonly string[];
}

/** The line of a document that `withFaults` replaces. */
const FAULTS_LINE = '<!-- faults -->';

/**
 * Collects failure modes from comments above tests:
 *
 *     /**
 *      * @fault Servers: status 408, 425, 429, 502, 503 or 504
 *      * @consequence asked again four times, at growing intervals; then `SplatSourceError`
 *      *\/
 *
 * A comment may hold several. If tests of several files show one fault, only one of them states the
 * consequence.
 *
 * @param files texts of test files by path.
 * @throws DocsError for unknown sections, and for faults with no consequence or with several.
 */
export function faultsIn(files: ReadonlyMap<string, string>): Fault[] {
  const faults = new Map<string, { section: FaultSection; consequences: string[]; tests: Set<string> }>();
  const problems: string[] = [];
  for (const [path, text] of files) {
    for (const { section, fault, consequence } of annotationsIn(text)) {
      const known = SECTIONS.find((each) => each === section);
      if (known === undefined) {
        problems.push(`${path}: “@fault ${section}” begins with no section: ${SECTIONS.join(', ')}.`);
        continue;
      }
      const key = `${known}: ${fault}`;
      const entry = faults.get(key) ?? { section: known, consequences: [], tests: new Set() };
      faults.set(key, entry);
      entry.tests.add(path);
      if (consequence !== '') entry.consequences.push(consequence);
    }
  }
  const rows = [...faults].map(([key, { section, consequences, tests }]): Fault => {
    if (consequences.length !== 1)
      problems.push(
        `${[...tests].join(', ')}: “${key}” has ${consequences.length} consequences, and needs one.`,
      );
    return {
      section,
      fault: key.slice(section.length + 2),
      consequence: consequences[0] ?? '',
      tests: [...tests],
    };
  });
  if (problems.length > 0) throw new DocsError(problems.join('\n'));
  return SECTIONS.flatMap((section) => rows.filter((row) => row.section === section));
}

function annotationsIn(text: string): { section: string; fault: string; consequence: string }[] {
  const comments = text.match(/^[ \t]*\/\*\*(?:(?!\*\/)[\s\S])*?@fault[\s\S]*?\*\//gm) ?? [];
  return comments.flatMap((comment) => {
    const lines = comment.trim().slice(3, -2).split('\n');
    const words = lines.map((line) => line.replace(/^\s*\*\s*/, '').trim()).join(' ');
    return words
      .split('@fault ')
      .slice(1)
      .map((annotation) => {
        const [head, consequence = ''] = annotation.split('@consequence ').map((part) => part.trim());
        const [section, ...fault] = head.split(': ');
        return { section, fault: fault.join(': '), consequence };
      });
  });
}

/** Replaces the line `<!-- faults -->` by a table per section. */
export function withFaults(text: string, faults: readonly Fault[]): string {
  const cell = (value: string) => value.replaceAll('|', '\\|');
  const tables = SECTIONS.flatMap((section) => {
    const rows = faults.filter((fault) => fault.section === section);
    if (rows.length === 0) return [];
    return [
      [
        `## ${section}`,
        '',
        '| fault | consequence | tests |',
        '|---|---|---|',
        ...rows.map(({ fault, consequence, tests }) => {
          const paths = tests.map((path) => `\`${path}\``).join(', ');
          return `| ${cell(fault)} | ${cell(consequence)} | ${paths} |`;
        }),
      ].join('\n'),
    ];
  });
  return text
    .split('\n')
    .map((line) => (line === FAULTS_LINE ? tables.join('\n\n') : line))
    .join('\n');
}

/** Begins a test file that names its own claim. */
const PROVES = '// Proves: ';
/** The line of a document that `withProofs` replaces. */
const PROOFS_LINE = '<!-- proofs -->';

/** Claims that no other test file proves, by path: the rest of a first comment `// Proves: …`. */
export function proofsIn(files: ReadonlyMap<string, string>): ReadonlyMap<string, string> {
  return new Map(
    [...files].flatMap(([path, text]) => {
      if (!text.startsWith(PROVES)) return [];
      const comment = text.split(/\n(?!\/\/ )/, 1)[0];
      return [[path, comment.slice(PROVES.length).replaceAll('\n// ', ' ')]];
    }),
  );
}

/** Replaces the line `<!-- proofs -->` by a table. */
export function withProofs(text: string, proofs: ReadonlyMap<string, string>): string {
  const rows = [...proofs].map(([path, proof]) => `| \`${path}\` | ${proof.replaceAll('|', '\\|')} |`);
  const table = ['| file | proves |', '|---|---|', ...rows].join('\n');
  return text
    .split('\n')
    .map((line) => (line === PROOFS_LINE ? table : line))
    .join('\n');
}
