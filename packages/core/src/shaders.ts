import { type Conditions, link } from 'wesl/core';
import { MAX_FRAGMENT_ALPHA } from './accuracy.ts';
import { SHADER_CONSTANTS } from './layout/constants.ts';
import { ProjectedSplat, ProjectedSplatF32, SHADER_STRUCTS } from './layout/structs.ts';

const files = import.meta.glob<string>('../../../shaders/**/*.wgsl', {
  query: '?raw',
  import: 'default',
  eager: true,
});

/** Every shader by its module path (`stages/cull_splats.wgsl`): names with hyphens are no WGSL identifiers. */
const modules: Record<string, string> = {};
for (const [path, text] of Object.entries(files)) {
  modules[path.replace(/^.*\/shaders\//, '').replaceAll('-', '_')] = text;
}

/** A shader as it is to be linked: what is not called for is not in its text. */
export interface ShaderVariant {
  /** File in shaders/stages, without its ending. */
  readonly stage: string;
  readonly conditions?: Readonly<Record<string, boolean>>;
  readonly constants?: Readonly<Record<string, number>>;
}

/**
 * One line of a shader replaced by another, to show that tests notice: with a remedy switched off, the case that it is
 * for has to fail. Never used outside of tests.
 */
export interface ShaderMutation {
  /** File below shaders/ without its ending, e.g. `lib/covariance`. */
  readonly file: string;
  /** Text that occurs exactly once in the file. */
  readonly find: string;
  readonly replace: string;
}

/** Names of all stages in shaders/stages. */
export const SHADER_STAGES: readonly string[] = Object.keys(files)
  .map((path) => /\/stages\/(.*)\.wgsl$/.exec(path)?.[1])
  .filter((name) => name !== undefined);

/** Every condition that a shader may ask for; absent means false. */
const NO_CONDITIONS: Conditions = {
  ORTHOGRAPHIC: false,
  GEOMETRY_F32: false,
  RECORD_F32: false,
  SH_1: false,
  SH_2: false,
  SH_3: false,
  SH_F32: false,
  SH_F16: false,
  SH_U8: false,
  FIRST_PASS: false,
  LAST_PASS: false,
  DEPTH_TEST: false,
  DEPTH_LOGARITHMIC: false,
  DEPTH_LAYER: false,
  MULTISAMPLED: false,
  REVERSED_DEPTH: false,
};

/** WGSL of one stage with everything that it imports. */
export async function linkShader(
  { stage, conditions = {}, constants = {} }: ShaderVariant,
  mutation?: ShaderMutation,
): Promise<string> {
  const record = conditions.RECORD_F32 ? ProjectedSplatF32 : ProjectedSplat;
  const structs = [...SHADER_STRUCTS, record].map((struct) => struct.wgsl).join('\n\n');
  const linked = await link({
    weslSrc: mutation ? mutated(mutation) : modules,
    rootModuleName: `package::stages::${stage.replaceAll('-', '_')}`,
    conditions: { ...NO_CONDITIONS, ...conditions },
    constants: { ...SHADER_CONSTANTS, MAX_FRAGMENT_ALPHA, ...constants },
    virtualLibs: { layout: () => structs },
    keepComments: false,
    sourceMap: false,
  });
  return linked.dest;
}

function mutated({ file, find, replace }: ShaderMutation): Record<string, string> {
  const path = `${file.replaceAll('-', '_')}.wgsl`;
  const parts = modules[path]?.split(find);
  if (parts?.length !== 2)
    throw new RangeError(`"${find}" does not occur exactly once in shaders/${file}.wgsl.`);
  return { ...modules, [path]: parts.join(replace) };
}
