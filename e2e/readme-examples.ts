/** An example of a README. */
export interface ReadmeExample {
  /** Number of the code's first line, from 1. */
  readonly line: number;
  readonly language: string;
  readonly code: string;
}

/** Finds the examples in TypeScript of a README. */
export function examplesIn(text: string): ReadmeExample[] {
  return [...text.matchAll(/^```(tsx?)\n(.*?)^```$/gms)].map(({ 1: language, 2: code, index }) => ({
    line: text.slice(0, index).split('\n').length + 1,
    language,
    code,
  }));
}

/** Returns the names of the packages that an example imports from. */
export function packagesOf(code: string): string[] {
  const specifiers = [...code.matchAll(/^import .* from '([^.'][^']*)';$/gm)].map(([, name]) => name);
  return specifiers.map((name) => /^(?:@[^/]+\/)?[^/]+/.exec(name)![0]);
}

/** Packages that `packages/tools/pack.mjs` packs, installed by `FOLDER/*.tgz`. */
const PACKED = ['core', 'scenes', 'three', 'react'].map((name) => `@websplatter/${name}`);

/** Returns the names of the packages that a README's install lines install. */
export function installedBy(text: string): string[] {
  const lines = [...text.matchAll(/^npm install (.*?)(?: +#.*)?$/gm)];
  return lines.flatMap(([, names]) =>
    names
      .split(' ')
      .filter((name) => !name.startsWith('--'))
      .flatMap((name) => (name.endsWith('/*.tgz') ? PACKED : [name])),
  );
}

/**
 * Returns an example as a module, after one line that declares values introduced by the text around
 * it or by an example before. The example must contain its own imports.
 *
 * @param declared names and types of the declared values.
 */
export function completedExample(code: string, declared: Readonly<Record<string, string>>): string {
  const lacks = (name: string) =>
    new RegExp(`(?<![\\w.'"-])${name}(?![\\w'"-])`).test(code) &&
    !new RegExp(`\\b(?:const|let|function|class|type)\\s+${name}\\b`).test(code) &&
    !new RegExp(`\\b(?:const|import)\\s*(?:type\\s*)?[{[][^=;]*\\b${name}\\b[^=;]*[}\\]]\\s*(?:=|from)`).test(
      code,
    );
  const declarations = Object.entries(declared)
    .filter(([name]) => lacks(name))
    .map(([name, type]) => `declare const ${name}: ${type};`);
  return `${[...declarations, 'export {};'].join(' ')}\n${code}`;
}
