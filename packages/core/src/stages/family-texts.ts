import type { ShaderStruct } from '../data/layout/structs.ts';
import { moduleName, type ShaderTexts } from '../gpu/shaders/link-shader.ts';

/** The library that every engine has: its stages need it, and effects may import it. */
const library = import.meta.glob<string>(
  '../../../../shaders/lib/{chunk-frustum,covariance,covering-triangle,depth-key,dispatch,edge-fade,host-depth,packing,scan-run,spherical-harmonics,splat-record,srgb,stacked-opacity,visible-ellipse}.wgsl',
  { query: '?raw', import: 'default', eager: true },
);

/**
 * Texts of a family of stages, beside the library.
 *
 * @param files WGSL by path: the family's own, and the files of the library that not every engine has.
 * @param structs structs that the files import, if they are not in SHADER_STRUCTS.
 */
export function familyTexts(
  files: Readonly<Record<string, string>>,
  structs?: readonly ShaderStruct[],
): ShaderTexts {
  const named = Object.entries({ ...library, ...files }).map(([path, text]) => {
    const [, folder = 'stages/', name] = /(lib\/)?([^/]+)\.wgsl$/.exec(path)!;
    return [moduleName(folder + name), text] as const;
  });
  return { modules: Object.fromEntries(named), structs };
}

/** Texts of the families that every engine has, in one place: they compress better together. */
export const engineTexts = /* @__PURE__ */ familyTexts(
  import.meta.glob('./{composite,cull,project,quads,sort}/*.wgsl', {
    query: '?raw',
    import: 'default',
    eager: true,
  }),
);
