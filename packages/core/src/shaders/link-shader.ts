import { MAX_FRAGMENT_ALPHA } from '../accuracy/accuracy.ts';
import { SHADER_CONSTANTS } from '../layout/constants.ts';
import { SHADER_STRUCTS, SPLAT_RECORDS } from '../layout/structs.ts';
import { type LinkInput, linkModules, type ShaderModules } from './shader-linker.ts';

/** All but those that only measuring and making planes need: they come with it. */
const files = import.meta.glob<string>(
  ['../../../../shaders/**/*.wgsl', '!../../../../shaders/stages/{compare-images,repack-*}.wgsl'],
  { query: '?raw', import: 'default', eager: true },
);

/** Every file as a module. */
const modules: ShaderModules = /* @__PURE__ */ modulesOf(files);

function modulesOf(texts: Readonly<Record<string, string>>): ShaderModules {
  const named = ([path, text]: [string, string]) =>
    [moduleName(path.replace(/^.*\/shaders\/|\.wgsl$/g, '')), text] as const;
  return Object.fromEntries(Object.entries(texts).map(named));
}

/** `package::stages::cull_splats` of `stages/cull-splats`: names with hyphens are no WGSL identifiers. */
function moduleName(file: string): string {
  return `package::${file.replaceAll('/', '::').replaceAll('-', '_')}`;
}

/**
 * Text of the shader of one of this package's own effects.
 *
 * @__NO_SIDE_EFFECTS__
 */
export function effectShader(name: string): string {
  return modules[moduleName(`effects/${name}`)];
}

/** A shader as it is to be linked: what is not called for is not in its text. */
export interface ShaderVariant {
  /** File in shaders/stages, without its ending. */
  readonly stage: string;
  /** Text of that file, where it does not come with the engine. */
  readonly source?: string;
  readonly conditions?: Readonly<Record<string, boolean>>;
  readonly constants?: Readonly<Record<string, number>>;
  /** Brings the modules `effects` and `parameters`, one object for equal modules; default none. */
  readonly effects?: { readonly modules: ShaderModules };
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

/** Every condition that a shader may ask for; absent means false. */
const NO_CONDITIONS: LinkInput['conditions'] = {
  ORTHOGRAPHIC: false,
  GEOMETRY_F32: false,
  RECORD_F32: false,
  RECORD_PAPER: false,
  SH_1: false,
  SH_2: false,
  SH_3: false,
  SH_F32: false,
  SH_F16: false,
  SH_U8: false,
  REPACK_TO_U8: false,
  DEPTH_TEST: false,
  DEPTH_LOGARITHMIC: false,
  DEPTH_LAYER: false,
  MULTISAMPLED: false,
  REVERSED_DEPTH: false,
  SCALED: false,
  SHORT_KEYS: false,
  FIXED_EXTENT: false,
  FRUSTUM_CULLING: false,
  COLOR_CACHE: false,
  ISOTROPIC: false,
  FAINT_SPLATS: false,
  SPLAT_EFFECTS: false,
  OPACITY_EFFECTS: false,
  COLOR_EFFECTS: false,
};

/** WGSL of one stage with everything that it imports. */
export function linkShader(variant: ShaderVariant, mutation?: ShaderMutation): string {
  return linkModules(linkInput(variant, mutation));
}

/** A variant as the linker takes it: what shaders share with the host are modules like those of files. */
export function linkInput(
  { stage, source, conditions = {}, constants = {}, effects }: ShaderVariant,
  mutation?: ShaderMutation,
): LinkInput {
  const { f32, f16, paper } = SPLAT_RECORDS;
  const record = conditions.RECORD_F32 ? f32 : conditions.RECORD_PAPER ? paper : f16;
  const root = moduleName(`stages/${stage}`);
  const values = Object.entries({ ...SHADER_CONSTANTS, MAX_FRAGMENT_ALPHA, ...constants });
  return {
    modules: {
      ...(mutation ? mutated(mutation) : modules),
      ...(source !== undefined && { [root]: source }),
      ...effects?.modules,
      layout: [...SHADER_STRUCTS, record].map((struct) => struct.wgsl).join('\n'),
      constants: values.map(([name, value]) => `const ${name} = ${value};`).join('\n'),
    },
    root,
    conditions: { ...NO_CONDITIONS, ...conditions },
  };
}

function mutated({ file, find, replace }: ShaderMutation): ShaderModules {
  const name = moduleName(file);
  const parts = modules[name]?.split(find);
  if (parts?.length !== 2)
    throw new RangeError(`"${find}" does not occur exactly once in shaders/${file}.wgsl.`);
  return { ...modules, [name]: parts.join(replace) };
}
