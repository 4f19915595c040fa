import { MAX_FRAGMENT_ALPHA } from '../../data/accuracy/accuracy.ts';
import { fetched } from '../../data/errors.ts';
import { SHADER_CONSTANTS } from '../../data/layout/constants.ts';
import { SHADER_STRUCTS, type ShaderStruct, SPLAT_RECORDS } from '../../data/layout/structs.ts';
import type { EffectSet } from '../effects/effect-set.ts';
import { type LinkInput, linkModules, type ShaderModules } from './shader-linker.ts';

/** Texts that shaders are linked from. */
export interface ShaderTexts {
  readonly modules: ShaderModules;
  /** Structs that the modules import, if they are not in SHADER_STRUCTS. */
  readonly structs?: readonly ShaderStruct[];
}

/** A shader to link; code whose condition is not met is not in its text. */
export interface ShaderVariant {
  /** Name of its file, without the ending. */
  readonly stage: string;
  /** Texts that there are before it is needed. */
  readonly texts?: ShaderTexts;
  /** Loads texts that it needs besides `texts`. */
  readonly later?: () => Promise<ShaderTexts>;
  /** Conditions that are met; others are not. */
  readonly conditions?: Readonly<Record<string, boolean>>;
  readonly constants?: Readonly<Record<string, number>>;
  /** Whether it uses built-in functions of subgroups, which are a feature of devices. */
  readonly usesSubgroups?: boolean;
  /** Provides modules `effects` and `parameters`; equal ones are the same object. Default none. */
  readonly effects?: Pick<EffectSet, 'modules'> & Partial<Pick<EffectSet, 'linked'>>;
}

/** Loads a variant's missing texts. Linking needs all of them. */
export async function loadVariant<Variant extends ShaderVariant>(variant: Variant): Promise<Variant> {
  const { texts, later } = variant;
  if (!later) return variant;
  const { modules, structs } = await fetched('shaders', later());
  return { ...variant, texts: { modules: { ...texts?.modules, ...modules }, structs } };
}

/**
 * Replaces some text of a shader, to show that tests notice: with a remedy removed, the test case
 * for it must fail. Only used in tests.
 */
export interface ShaderMutation {
  /** File without its folders but one, and without its ending: `lib/covariance`, `stages/project`. */
  readonly file: string;
  /** Text that occurs exactly once in the file. */
  readonly find: string;
  readonly replace: string;
}

/** Name of the module of `lib/depth-key` or `stages/cull-splats`: names in WGSL have no hyphens. */
export function moduleName(file: string): string {
  return `package::${file.replaceAll('/', '::').replaceAll('-', '_')}`;
}

/** Returns the WGSL of one stage with everything that it imports. */
export function linkShader(variant: ShaderVariant, mutation?: ShaderMutation): string {
  const linked = linkModules(linkInput(variant, mutation));
  return variant.usesSubgroups ? `enable subgroups;\n${linked}` : linked;
}

/** Returns a variant as input of the linker: host structs and constants become modules. */
export function linkInput(
  { stage, texts, conditions = {}, constants = {}, effects }: ShaderVariant,
  mutation?: ShaderMutation,
): LinkInput {
  const { modules, structs = [] } = texts!;
  const { f32, f16, paper } = SPLAT_RECORDS;
  const record = conditions.RECORD_F32 ? f32 : conditions.RECORD_PAPER ? paper : f16;
  const values = Object.entries({ ...SHADER_CONSTANTS, MAX_FRAGMENT_ALPHA, ...constants });
  return {
    modules: {
      ...(mutation ? mutated(modules, mutation) : modules),
      ...effects?.modules,
      layout: [...SHADER_STRUCTS, ...structs, record].map((struct) => struct.wgsl).join('\n'),
      constants: values.map(([name, value]) => `const ${name} = ${value};`).join('\n'),
    },
    root: moduleName(`stages/${stage}`),
    conditions,
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
  if (parts.length !== 2) throw new RangeError(`"${find}" does not occur exactly once in ${file}.wgsl.`);
  return { ...known, [name]: parts.join(replace) };
}
