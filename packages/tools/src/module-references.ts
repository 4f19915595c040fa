import { parseSync, Visitor } from 'oxc-parser';

/** One module's mention of another. */
export interface ModuleReference {
  /** As written, e.g. `../math/mat4.ts` or `@websplatter/core`. */
  readonly specifier: string;
  /** Whether compilers remove it: `import type`, `export type` and types in `import()`. */
  readonly isType: boolean;
  /** Whether an import statement names it, so that both are loaded together. */
  readonly isStatic: boolean;
}

/**
 * Relative paths, globs included but for what they leave out, and this repository's packages;
 * `@websplatter/source` is an export condition.
 */
const NAMES_A_MODULE = /^\.\.?\/|^@websplatter\/(?!source$)[a-z]/;

/**
 * Finds every string in a module that is a relative path or names a package of this repository.
 * Imports are not the only way to depend on a module: the URL of a worker, a glob of shaders and
 * the path of a mocked module are others. A template literal counts as a glob of all that begins
 * like the text before its first expression.
 *
 * @throws SyntaxError where the module does not parse.
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
