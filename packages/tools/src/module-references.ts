import { parseSync, Visitor } from 'oxc-parser';

/** A module's reference to another module. */
export interface ModuleReference {
  /** As written, e.g. `../math/mat4.ts` or `@websplatter/core`. */
  readonly specifier: string;
  /** Whether compilers remove it: `import type`, `export type` and types in `import()`. */
  readonly isType: boolean;
  /** Whether it is a static import, so that both modules are loaded together. */
  readonly isStatic: boolean;
}

/**
 * Relative paths, including globs but not their exclusions, and this repository's packages.
 * `@websplatter/source` is an export condition, not a package.
 */
const NAMES_A_MODULE = /^\.\.?\/|^@websplatter\/(?!source$)[a-z]/;

/**
 * Finds every string in a module that is a relative path or names a package of this repository.
 * Imports are not the only dependencies: URLs of workers, globs of shaders and paths of mocked
 * modules count too. A template literal counts as a glob with the text before its first expression
 * as prefix.
 *
 * @throws SyntaxError if the module cannot be parsed.
 */
export function moduleReferences(path: string, text: string): ModuleReference[] {
  const { program, errors } = parseSync(path, text);
  if (errors.length > 0) throw new SyntaxError(`${path} does not parse: ${errors[0].message}`);
  const typeSources = new Set<number>();
  const staticSources = new Set<number>();
  const references: ModuleReference[] = [];
  const add = (specifier: string, start: number) => {
    if (NAMES_A_MODULE.test(specifier))
      references.push({ specifier, isType: typeSources.has(start), isStatic: staticSources.has(start) });
  };
  // Parents are visited before their children.
  new Visitor({
    ImportDeclaration({ importKind, source }) {
      staticSources.add(source.start);
      if (importKind === 'type') typeSources.add(source.start);
    },
    ExportNamedDeclaration({ exportKind, source }) {
      if (exportKind === 'type' && source) typeSources.add(source.start);
    },
    ExportAllDeclaration({ exportKind, source }) {
      if (exportKind === 'type') typeSources.add(source.start);
    },
    TSImportType({ source }) {
      typeSources.add(source.start);
    },
    Literal({ value, start }) {
      if (typeof value === 'string') add(value, start);
    },
    TemplateLiteral({ quasis: [first, ...others], start }) {
      add(others.length > 0 ? `${first.value.cooked}*` : (first.value.cooked ?? ''), start);
    },
  }).visit(program);
  return references;
}
