import { ShaderError } from '../../data/errors.ts';
import { structName } from '../effects/effect.ts';
import { callOf, type LinkedEffect, moduleNameOf } from '../effects/effect-set.ts';
import { linkInput, type ShaderMutation, type ShaderVariant } from './link-shader.ts';
import { LinkError, type LinkInput, linkTokens, type Token } from './shader-linker.ts';

/** A shader that could not be linked, or not be compiled. */
export interface ShaderFailure {
  /** The variant, with all of its texts. */
  readonly variant: ShaderVariant;
  readonly mutation: ShaderMutation | undefined;
  /** What linking or compiling threw. */
  readonly cause: unknown;
  /** The module that was compiled; null if none was linked. */
  readonly module: GPUShaderModule | null;
  /** The first error of the device while it made module, layout and pipeline; null if there was none. */
  readonly refusal: GPUError | null;
}

/** A place in the modules, and what is wrong there. */
interface Found {
  readonly module: string | null;
  /** From 1; null if unknown. */
  readonly line: number | null;
  readonly problem: string;
}

/**
 * Returns the error of a shader, with the module and line that it comes from, what WGSL's compiler says, and
 * the effects that are to blame. If nothing tells which, those are all effects of the shader.
 *
 * Fetched when a shader has an error.
 */
export async function shaderErrorOf(failure: ShaderFailure): Promise<ShaderError> {
  const { variant, mutation, cause } = failure;
  const input = linkInput(variant, mutation);
  const found = cause instanceof LinkError ? cause : await compiled(failure, input);
  const linked = variant.effects?.linked ?? [];
  const own = effectAt(found, linked, input);
  const { module, line, problem } = found;
  const place = module === null ? '' : `${module}${line === null ? '' : `, line ${line}`}: `;
  const effects = (own ? [own] : linked).map(({ effect }) => effect.name);
  const what = `${place}${problem.replace(/\.$/, '')}.`;
  const message =
    effects.length > 0
      ? `The ${effects.length > 1 ? 'effects' : 'effect'} ${effects.join(', ')} cannot be drawn: ${what} ` +
        'Clouds are drawn without; correct the WGSL and define the effect anew.'
      : `The shader ${variant.stage} cannot be made: ${what} Update the browser or the driver of the GPU.`;
  const culprit = own?.effect ?? (linked.length > 0 ? variant.effects! : null);
  return new ShaderError(message, { stage: variant.stage, effects, module, line, culprit }, { cause });
}

async function compiled(
  { variant, module, cause, refusal }: ShaderFailure,
  input: LinkInput,
): Promise<Found> {
  // A lost device has no messages: those of the refusal or the cause are used.
  const info = await module?.getCompilationInfo?.().catch(() => null);
  const first = info?.messages.find(({ type }) => type === 'error');
  const problem = first?.message ?? (refusal ?? (cause as Error)).message;
  // `enable subgroups;` is in front of the linked text.
  const lineNum = (first?.lineNum ?? 0) - Number(variant.usesSubgroups === true);
  const token = lineNum > 0 ? tokenAt(linkTokens(input), lineNum, first!.linePos) : null;
  return { module: token?.module ?? null, line: token?.line ?? null, problem };
}

/** Returns the token at a place of a linked text; lines and positions from 1. */
function tokenAt(
  declarations: readonly (readonly Token[])[],
  lineNum: number,
  linePos: number,
): Token | null {
  let found: Token | null = null;
  let line = 1;
  let column = 1;
  for (const tokens of declarations) {
    for (const [i, { text, gap }] of tokens.entries()) {
      const lines = (i === 0 ? '' : gap).split('\n');
      line += lines.length - 1;
      column = lines.length > 1 ? 1 + lines.at(-1)!.length : column + lines[0].length;
      if (line > lineNum || (line === lineNum && column > Math.max(linePos, 1) && found !== null))
        return found;
      found = tokens[i];
      column += text.length;
    }
    line += 2;
    column = 1;
  }
  return found;
}

/** Returns the effect that a place belongs to; undefined if it is none's. */
function effectAt(
  { module, line }: Found,
  linked: readonly LinkedEffect[],
  { modules }: LinkInput,
): LinkedEffect | undefined {
  if (module === null || line === null) return undefined;
  if (module !== 'effects' && module !== 'parameters')
    return linked.find(({ effect }) => moduleNameOf(effect) === module);
  // In generated text, each line has a word of its effect, or the line that its declaration begins with.
  const lines = modules[module].split('\n').slice(0, line).reverse();
  const begin = lines.findIndex((text) => /^\S/.test(text));
  for (const text of lines.slice(0, begin + 1)) {
    const words = text.match(/\w+/g) ?? [];
    const named = linked.find((each, index) => {
      const calls = Object.keys(each.hooks).map((hook) => callOf(hook, index));
      const name = structName(each.effect.name);
      const begins = [name, name[0].toLowerCase() + name.slice(1)];
      return words.some((word) => calls.includes(word) || begins.some((start) => word.startsWith(start)));
    });
    if (named) return named;
  }
  return undefined;
}
