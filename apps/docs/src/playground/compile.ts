import { parse } from 'es-module-lexer/js';
import { transform } from 'sucrase';

/** Source texts by path, e.g. `routes/fog.tsx`; the first is the module that runs. */
export type SourceFiles = Readonly<Record<string, string>>;

/** Modules that a browser can run, by the specifier with which they import one another. */
export interface CompiledModules {
  /** The specifier of the first file. */
  readonly entry: string;
  readonly modules: Readonly<Record<string, string>>;
  /** Entry points of packages that the modules import, e.g. `three/webgpu`. */
  readonly packages: readonly string[];
}

/** The reason why a source cannot run, and its position. */
export class CompileError extends Error {
  override readonly name = 'CompileError';

  /** `line` counts from 1; null if the reason has no position in the text. */
  constructor(
    readonly path: string,
    readonly line: number | null,
    message: string,
  ) {
    super(message);
  }
}

/**
 * Specifier of a file, and its name in stack traces. Modules from memory cannot use relative paths.
 */
const specifierOf = (path: string): string => `app:/${path}`;

/**
 * Compiles TypeScript and JSX to modules for browsers; line numbers are kept. Imports with `?raw`
 * return the file's text.
 *
 * @param available entry points of packages that can be imported.
 * @throws CompileError for syntax errors and for unavailable imports.
 */
export function compile(files: SourceFiles, available: ReadonlySet<string>): CompiledModules {
  const modules: Record<string, string> = {};
  const packages = new Set<string>();
  const paths = Object.keys(files);
  for (const path of paths.filter((each) => /\.tsx?$/.test(each))) {
    const { code, rawImports } = compileModule(path, files, available, packages);
    modules[specifierOf(path)] = code;
    for (const raw of rawImports)
      modules[`${specifierOf(raw)}?raw`] = `export default ${JSON.stringify(files[raw])};`;
  }
  return { entry: specifierOf(paths[0]), modules, packages: [...packages] };
}

function compileModule(
  path: string,
  files: SourceFiles,
  available: ReadonlySet<string>,
  packages: Set<string>,
): { code: string; rawImports: string[] } {
  const code = withoutTypes(path, files[path]);
  const rawImports: string[] = [];
  let linked = '';
  let copiedTo = 0;
  for (const each of importsOf(path, code)) {
    if (each.type === 'import-meta') continue;
    const { specifier, start, end } = each;
    const isDynamic = each.type === 'dynamic';
    const line = code.slice(0, start).split('\n').length;
    if (specifier === undefined || (isDynamic && each.glob))
      throw new CompileError(path, line, 'An import here must name its module by a string.');
    let target = specifier;
    if (specifier.startsWith('.')) {
      const [file, query] = new URL(specifier, `file:///${path}`).href.slice('file:///'.length).split('?');
      if (!Object.hasOwn(files, file)) throw new CompileError(path, line, `There is no file ${file} here.`);
      if (query === 'raw') rawImports.push(file);
      target = specifierOf(file) + (query ? `?${query}` : '');
    } else {
      if (!available.has(specifier))
        throw new CompileError(
          path,
          line,
          `“${specifier}” is not among the packages of this page: ${[...available].sort().join(', ')}.`,
        );
      packages.add(specifier);
    }
    // The position of a dynamic import includes the quotes.
    linked += code.slice(copiedTo, start) + (isDynamic ? JSON.stringify(target) : target);
    copiedTo = end;
  }
  linked += code.slice(copiedTo);
  return { code: `${linked}\n//# sourceURL=${specifierOf(path)}`, rawImports };
}

function withoutTypes(path: string, text: string): string {
  try {
    return transform(text, {
      transforms: ['typescript', 'jsx'],
      jsxRuntime: 'automatic',
      production: true,
      // These transforms are unnecessary for browsers with WebGPU.
      disableESTransforms: true,
    }).code;
  } catch (error) {
    const { message, loc } = error as Error & { loc?: { line: number } };
    throw new CompileError(path, loc?.line ?? null, message.replace(/ \(\d+:\d+\)$/, ''));
  }
}

function importsOf(path: string, code: string) {
  try {
    return parse(code)[0];
  } catch (error) {
    const { message, idx } = error as Error & { idx?: number };
    const line = idx === undefined ? null : code.slice(0, idx).split('\n').length;
    throw new CompileError(path, line, message);
  }
}
