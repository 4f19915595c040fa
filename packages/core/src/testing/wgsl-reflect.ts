import type * as wgslReflect from 'wgsl_reflect';

/** Hidden from the type checker: the package declares types only for its main entry. */
const moduleEntry = 'wgsl_reflect/wgsl_reflect.module.js';

/** `wgsl_reflect` by the entry that works: Node takes the main one, CommonJS, for an ES module. */
const { ResourceType, WgslReflect }: typeof wgslReflect = await import(moduleEntry);
export type WgslReflection = wgslReflect.WgslReflect;

export { ResourceType };

/** By the text of declarations: most variants of a stage differ in the bodies of functions alone. */
const known = new Map<string, WgslReflection>();

/** Returns the declarations of linked `wgsl`. */
export function reflectWgsl(wgsl: string): WgslReflection {
  // Function bodies, which end at the first brace that begins a line, are removed: the parser does
  // not know all expressions, and reads `workgroup` as an address space everywhere.
  const declarations = wgsl.replace(/(\bfn [^{]*)\{[\s\S]*?\n\}/g, '$1{ }');
  const reflection = known.get(declarations) ?? new WgslReflect(declarations);
  known.set(declarations, reflection);
  return reflection;
}
