import { MAX_FRAGMENT_ALPHA } from '../../data/accuracy/accuracy.ts';
import { SHADER_CONSTANTS } from '../../data/layout/constants.ts';
import { SHADER_STRUCTS, type ShaderStruct, SPLAT_RECORDS } from '../../data/layout/structs.ts';
import { type LinkInput, linkModules, type ShaderModules } from './shader-linker.ts';

/**
 * Shader files in the engine's own code. Files of effects come with their effect; the excluded files
 * come with the code that only some pages need: see `later-source.ts`.
 */
const files = import.meta.glob<string>(
  [
    '../../../../../shaders/{lib,stages}/*.wgsl',
    '!../../../../../shaders/stages/{average-samples,compare-images,compose,copy-words,cover-points,cut-*,ingest-*,merge-*,morph-*,pick,plan-cut,repack-*,resolve-depth,sort-gather,tile-*,touch-links,upscale,wide-keys}.wgsl',
    '!../../../../../shaders/lib/{exact-exp,dilated-blob,float-bits,float64,harmonics-packing,instances,layer-rounding,level-link,merged-cell,merged-splat,pack-splat,splat-ellipse,tile-grid,workgroup-scan}.wgsl',
  ],
  { query: '?raw', import: 'default', eager: true },
);

/** Every shader file as a module. */
const modules: ShaderModules = /* @__PURE__ */ modulesOf(files);

function modulesOf(texts: Readonly<Record<string, string>>): ShaderModules {
  const named = ([path, text]: [string, string]) =>
    [moduleName(path.replace(/^.*\/shaders\/|\.wgsl$/g, '')), text] as const;
  return Object.fromEntries(Object.entries(texts).map(named));
}

/** Returns `package::stages::cull_splats` for `stages/cull-splats`: WGSL names have no hyphens. */
function moduleName(file: string): string {
  return `package::${file.replaceAll('/', '::').replaceAll('-', '_')}`;
}

/** Texts of a variant that are fetched when they are needed. */
export interface LaterTexts {
  readonly source: string;
  readonly libraries?: ShaderVariant['libraries'];
  readonly structs?: ShaderVariant['structs'];
}

/** A shader to link; code whose condition is not met is not in its text. */
export interface ShaderVariant {
  /** File in shaders/stages, without its ending. */
  readonly stage: string;
  /** Text of that file, or its loader, if it is not among the engine's own modules. */
  readonly source?: string | (() => Promise<LaterTexts>);
  /** Texts of further files below shaders/ that it imports, by name without ending: `lib/instances`. */
  readonly libraries?: Readonly<Record<string, string>>;
  /** Structs that it may import in addition to `SHADER_STRUCTS`. */
  readonly structs?: readonly ShaderStruct[];
  readonly conditions?: Readonly<Record<string, boolean>>;
  readonly constants?: Readonly<Record<string, number>>;
  /** Whether it uses built-in functions of subgroups, which are a feature of devices. */
  readonly usesSubgroups?: boolean;
  /** Provides modules `effects` and `parameters`; equal ones are the same object. Default none. */
  readonly effects?: { readonly modules: ShaderModules };
}

/** Loads a variant's missing texts, as it must be before it is linked. */
export async function loadVariant<Variant extends ShaderVariant>(variant: Variant): Promise<Variant> {
  const { source } = variant;
  return typeof source === 'function' ? { ...variant, ...(await source()) } : variant;
}

/**
 * Replaces some text of a shader, to show that tests notice: with a remedy removed, the test case
 * for it must fail. Only used in tests.
 */
export interface ShaderMutation {
  /** File below shaders/ without its ending, e.g. `lib/covariance`. */
  readonly file: string;
  /** Text that occurs exactly once in the file. */
  readonly find: string;
  readonly replace: string;
}

/** Every condition that shaders may use; absent means false. */
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
  SH_PALETTE: false,
  REPACK_TO_U8: false,
  DEPTH_TEST: false,
  DEPTH_LOGARITHMIC: false,
  DEPTH_LAYER: false,
  COMPUTE: false,
  NARROW: false,
  SUBGROUPS: false,
  WIDE_SUBGROUPS: false,
  BGRA: false,
  LAYER_F32: false,
  LAYER_F16: false,
  MULTISAMPLED: false,
  REVERSED_DEPTH: false,
  SCALED: false,
  SHORT_KEYS: false,
  STACKED: false,
  DISTANCE_ORDER: false,
  FIXED_EXTENT: false,
  FRUSTUM_CULLING: false,
  ISOTROPIC: false,
  SPLAT_EFFECTS: false,
  OPACITY_EFFECTS: false,
  COLOR_EFFECTS: false,
  CONTRIBUTIONS: false,
  UPPER: false,
  LEVELS: false,
  INSTANCES: false,
  DILATED: false,
  SHIFTED: false,
};

/** Returns the WGSL of one stage with everything that it imports. */
export function linkShader(variant: ShaderVariant, mutation?: ShaderMutation): string {
  const linked = linkModules(linkInput(variant, mutation));
  return variant.usesSubgroups ? `enable subgroups;\n${linked}` : linked;
}

/** Returns a variant as input of the linker: host structs and constants become modules. */
export function linkInput(
  { stage, source, libraries = {}, structs = [], conditions = {}, constants = {}, effects }: ShaderVariant,
  mutation?: ShaderMutation,
): LinkInput {
  const { f32, f16, paper } = SPLAT_RECORDS;
  const record = conditions.RECORD_F32 ? f32 : conditions.RECORD_PAPER ? paper : f16;
  const root = moduleName(`stages/${stage}`);
  const values = Object.entries({ ...SHADER_CONSTANTS, MAX_FRAGMENT_ALPHA, ...constants });
  const known =
    typeof source === 'string' ? { ...modules, ...modulesOf(libraries), [root]: source } : modules;
  return {
    modules: {
      ...(mutation ? mutated(known, mutation) : known),
      ...effects?.modules,
      layout: [...SHADER_STRUCTS, ...structs, record].map((struct) => struct.wgsl).join('\n'),
      constants: values.map(([name, value]) => `const ${name} = ${value};`).join('\n'),
    },
    root,
    conditions: { ...NO_CONDITIONS, ...conditions },
    counts: Object.fromEntries(values),
  };
}

function mutated(known: ShaderModules, { file, find, replace }: ShaderMutation): ShaderModules {
  const name = moduleName(file);
  // A mutation applies to all shaders of an engine, but only some of them contain its file.
  if (!(name in known)) return known;
  // Built packages contain shaders without most of their spaces.
  const tokens = find.match(/\w+|\S/g)!.map((token) => token.replace(/\W/, '\\$&'));
  const parts = known[name].split(new RegExp(tokens.join('\\s*')));
  if (parts.length !== 2)
    throw new RangeError(`"${find}" does not occur exactly once in shaders/${file}.wgsl.`);
  return { ...known, [name]: parts.join(replace) };
}
