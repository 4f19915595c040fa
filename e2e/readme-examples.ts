/** Names without imports in examples: the text around, or an example before, introduces them. */
const MODULES: Readonly<Record<string, readonly string[]>> = {
  '@react-three/fiber': ['Canvas', 'invalidate', 'useFrame'],
  '@websplatter/react': [
    'createSplatRenderer',
    'SplatCanvas',
    'SplatCloudObject',
    'Splats',
    'SplatSelection',
    'SplatsFallback',
    'useSplats',
  ],
  '@websplatter/three': ['SplatCloudObject', 'SplatLoader'],
  react: ['Suspense', 'useRef', 'useState'],
  three: ['Box3', 'PerspectiveCamera', 'Plane', 'Sphere', 'Vector3'],
};

/** An example of a README. */
export interface ReadmeExample {
  /** Of the code's first line, from 1. */
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

/**
 * Returns an example as a module, after one line of imports and declarations for the names that it
 * leaves out.
 *
 * @param prefers the package whose README it is: if several export a name, its own counts.
 * @param declared further names with their types.
 */
export function completedExample(
  code: string,
  prefers: string,
  declared: Readonly<Record<string, string>>,
): string {
  const lacks = (name: string) =>
    new RegExp(`(?<![\\w.'"-])${name}(?![\\w'"-])`).test(code) &&
    !new RegExp(`\\b(?:const|let|function|class|type)\\s+${name}\\b`).test(code) &&
    !new RegExp(`\\b(?:const|import)\\s*(?:type\\s*)?[{[][^=;]*\\b${name}\\b[^=;]*[}\\]]\\s*(?:=|from)`).test(
      code,
    );
  const modules = [prefers, ...Object.keys(MODULES).filter((name) => name !== prefers)];
  const from = new Map<string, string>();
  for (const module of modules)
    for (const name of MODULES[module] ?? []) if (lacks(name) && !from.has(name)) from.set(name, module);
  const imports = [...from].map(([name, module]) => `import { ${name} } from '${module}';`);
  const declarations = Object.entries(declared)
    .filter(([name]) => lacks(name))
    .map(([name, type]) => `declare const ${name}: ${type};`);
  return `${[...imports, ...declarations, 'export {};'].join(' ')}\n${code}`;
}
