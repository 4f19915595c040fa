import type * as wgslReflect from 'wgsl_reflect';

/** Kept from the type checker, to which the package describes only its main entry. */
const moduleEntry = 'wgsl_reflect/wgsl_reflect.module.js';

/** `wgsl_reflect` by the entry that works: Node takes the main one, which is CommonJS, for an ES module. */
const { ResourceType, WgslReflect }: typeof wgslReflect = await import(moduleEntry);
export type WgslReflection = wgslReflect.WgslReflect;

export { ResourceType };

/** What linked `wgsl` declares. */
export function reflectWgsl(wgsl: string): WgslReflection {
  // Without the functions' bodies, which end at the first brace that begins a line: the parser does not know all
  // expressions, and takes `workgroup` for an address space wherever it stands.
  return new WgslReflect(wgsl.replace(/(\bfn [^{]*)\{[\s\S]*?\n\}/g, '$1{ }'));
}
