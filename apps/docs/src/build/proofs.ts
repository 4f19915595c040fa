/** First words of a test file that says what it alone proves. */
const PROVES = '// Proves: ';
/** The line of a document that `withProofs` replaces. */
const PROOFS_LINE = '<!-- proofs -->';

/** What test files alone prove, by path: the rest of a first line `// Proves: …`. */
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
