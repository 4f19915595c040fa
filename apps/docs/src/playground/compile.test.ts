import { describe, expect, it } from 'vitest';
import { CompileError, compile } from './compile.ts';

const AVAILABLE = new Set(['react', 'react/jsx-runtime', 'three']);

function problemOf(text: string): CompileError {
  try {
    compile({ 'routes/a.tsx': text }, AVAILABLE);
  } catch (error) {
    if (error instanceof CompileError) return error;
  }
  throw new Error('It compiles.');
}

describe('compiling sources', () => {
  it('removes types, turns JSX into calls, and keeps lines where they are', () => {
    const text =
      "import type { Mesh } from 'three';\nconst a: number = 1;\n\nexport default () => <p>{a}</p>;\n";
    const { entry, modules, packages } = compile({ 'routes/a.tsx': text }, AVAILABLE);
    expect(entry).toBe('app:/routes/a.tsx');
    expect(modules[entry].split('\n')[3]).toContain('_jsx(');
    expect(modules[entry]).toContain('//# sourceURL=app:/routes/a.tsx');
    expect(packages).toEqual(['react/jsx-runtime']);
  });

  it('links files that import one another, and files as text', () => {
    const { modules } = compile(
      {
        'routes/a.tsx': "import { b } from '../b.ts';\nexport default b;\nvoid import('../b.ts');",
        'b.ts': "import text from './c.wgsl?raw';\nexport const b = text;",
        'c.wgsl': 'fn c() {}',
      },
      AVAILABLE,
    );
    expect(modules['app:/routes/a.tsx']).toContain("from 'app:/b.ts'");
    expect(modules['app:/routes/a.tsx']).toContain('import("app:/b.ts")');
    expect(modules['app:/b.ts']).toContain("from 'app:/c.wgsl?raw'");
    expect(modules['app:/c.wgsl?raw']).toBe('export default "fn c() {}";');
  });

  it('leaves import.meta alone', () => {
    const { entry, modules } = compile({ 'a.ts': 'export default import.meta.url;' }, AVAILABLE);
    expect(modules[entry]).toContain('export default import.meta.url;');
  });

  it.each([
    ['const a = ;', 1, /Unexpected token/],
    ["\n\nimport b from './b.ts';\nb();", 3, 'There is no file routes/b.ts here.'],
    [
      "\nimport { lerp } from 'lodash';\nlerp();",
      2,
      /“lodash” is not among the packages of this page: react, react\/jsx/,
    ],
    ['const name = "three";\nvoid import(name);', 2, 'An import here must name its module by a string.'],
  ])('tells what is wrong with %j, and in which line', (text, line, message) => {
    const problem = problemOf(text);
    expect(problem.path).toBe('routes/a.tsx');
    expect(problem.line).toBe(line);
    expect(problem.message).toMatch(message);
  });
});
