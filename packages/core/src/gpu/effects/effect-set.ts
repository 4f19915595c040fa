import {
  type GpuFields,
  type GpuStruct,
  type GpuValues,
  gpuStruct,
  roundUp,
} from '../../data/layout/gpu-struct.ts';
import { numberOf } from '../../data/number-of.ts';
import type { ShaderModules } from '../shaders/shader-linker.ts';
import {
  type EffectHooks,
  type EffectRows,
  type EffectUse,
  type RowCloud,
  type SplatEffect,
  structName,
} from './effect.ts';

/** What shaders contain of one effect. */
export interface LinkedEffect {
  readonly effect: SplatEffect;
  readonly hooks: EffectHooks;
  /** The effect's parameters, or its list with some room; null without either. */
  readonly parameters: GpuStruct<GpuFields> | null;
  /** Offset of the parameters in the parameters of the whole set, bytes. */
  readonly offset: number;
}

/** Effects that one cloud is drawn with, in the order they act. Equal lists are the same object. */
export interface EffectSet {
  readonly linked: readonly LinkedEffect[];
  /** The modules that shaders import these effects from. */
  readonly modules: ShaderModules;
  /** Size of the parameters of the whole set, bytes; 0 if there are none. */
  readonly parameterBytes: number;
}

/** For clouds without effects. */
export const NO_EFFECTS: EffectSet = { linked: [], modules: {}, parameterBytes: 0 };

/** Binding of the parameters, in every stage that applies effects. */
const PARAMETERS_BINDING = 16;
/** Binding of a bit per splat of the page and selection, in stages whose hooks take `selected`. */
const SELECTED_BINDING = 17;
/** Binding of the levels of the page's chunks, in stages whose hooks take `level`. */
const LEVELS_BINDING = 18;
/** First binding of the resources that effects have of their own, in the order of the effects. */
const RESOURCES_BINDING = 32;
/**
 * Bytes of the levels of a page's chunks, four bits each. A uniform, because a stage may have no more
 * than eight storage buffers. This is WebGPU's default limit of a uniform, enough for 33 million
 * splats of a page; further chunks have the level of the last.
 */
export const CHUNK_LEVEL_BYTES = 65_536;
/** Level of a chunk that replaces finer detail that is not on the GPU yet. */
export const MISSING_LEVEL = 15;
/** Structs in a uniform buffer begin at multiples of this many bytes. */
export const STRUCT_ALIGNMENT = 16;

const NO_PARAMETERS = /* @__PURE__ */ new Uint8Array(0);

const sets = new Map<string, EffectSet>([['', NO_EFFECTS]]);

export function effectSetOf(uses: readonly EffectUse[]): EffectSet {
  const key = uses
    .map((use) => [numberOf(use.effect), roomOf(use), ...Object.keys(use.hooks)].join(':'))
    .join(' ');
  let set = sets.get(key);
  if (!set) {
    let parameterBytes = 0;
    const linked = uses.map((use): LinkedEffect => {
      const { effect, hooks } = use;
      const each = { effect, hooks, parameters: parametersOf(use), offset: parameterBytes };
      parameterBytes += roundUp(each.parameters?.bytes ?? 0, STRUCT_ALIGNMENT);
      return each;
    });
    set = { linked, modules: modulesOf(linked), parameterBytes };
    sets.set(key, set);
  }
  return set;
}

/** Number of vec4f that shaders have room for: lists of similar lengths share shaders. */
function roomOf({ listLength }: EffectUse): number {
  return listLength === 0 ? 0 : 2 ** Math.ceil(Math.log2(listLength));
}

/** Returns the struct of a use's parameters, or of its list; null without either. */
export function parametersOf(use: EffectUse): GpuStruct<GpuFields> | null {
  const { effect, listLength } = use;
  if (listLength === 0) return effect.parameters;
  return gpuStruct(structName(effect.name), { list: `array<vec4f, ${roomOf(use)}>` });
}

/** Whether a stage with these hooks needs the selection. */
export function takesSelection({ linked }: EffectSet, hooks: readonly SelectionHook[]): boolean {
  return linked.some((each) => each.effect.takesSelection && hooks.some((hook) => each.hooks[hook]));
}

/** How many effects of the set take a selection, each of its own. */
export function selectionsOf({ linked }: EffectSet): number {
  return linked.filter(({ effect }) => effect.takesSelection).length;
}

/** Whether a stage with colours needs the levels of chunks. */
export function hasLevels({ linked }: EffectSet): boolean {
  return linked.some(({ effect, hooks }) => effect.takesLevel && hooks.color !== undefined);
}

/** Returns the rows that effects of the set take, if any takes them. */
export function rowsOf({ linked }: RowCloud['effects']): EffectRows | null | undefined {
  return linked.find(({ effect }) => effect.rows)?.effect.rows;
}

/** Whether any effect of the set uses this hook. */
export function hasHook({ linked }: EffectSet, hook: keyof EffectHooks): boolean {
  return linked.some(({ hooks }) => hooks[hook] !== undefined);
}

/** Returns the set for stages without colours: NO_EFFECTS if effects change only colours. */
export function geometryEffects(set: EffectSet): EffectSet {
  return set.linked.some(({ hooks }) => changesOrder(hooks)) ? set : NO_EFFECTS;
}

/** Returns the set for stages that test chunks: NO_EFFECTS if no effect changes their bounds. */
export function boundsEffects(set: EffectSet): EffectSet {
  return hasHook(set, 'bounds') ? set : NO_EFFECTS;
}

/** Packs the parameters of one cloud's effects into a struct `Effects` for each place of the cloud. */
export function packParameters(
  { linked, parameterBytes }: EffectSet,
  places: readonly (readonly { readonly values: GpuValues<GpuFields> | null }[])[],
): Uint8Array {
  if (parameterBytes === 0) return NO_PARAMETERS;
  const packed = new ArrayBuffer(parameterBytes * places.length);
  for (const [i, uses] of places.entries())
    for (const [j, { effect, parameters, offset }] of linked.entries()) {
      const { values } = uses[j];
      const at = parameterBytes * i + offset;
      // The rest of a list's room stays 0.
      if (effect.hasList) new Float32Array(packed, at).set((values as { list: ArrayLike<number> }).list);
      else parameters?.write(packed, values!, at);
    }
  return new Uint8Array(packed);
}

/** Name of the module of one effect's shader. */
export function moduleNameOf({ name }: SplatEffect): string {
  return `package::effects::${name.replaceAll('-', '_')}`;
}

/** Name in the module `effects` of the function for a hook: effects may give theirs the same name. */
export function callOf(hook: string, index: number): string {
  return `${hook}${index}`;
}

/** Returns `windSway` for `wind-sway`. */
function camelCase({ name }: SplatEffect): string {
  return name.replace(/-(.)/g, (_, first: string) => first.toUpperCase());
}

/** Member of `Effects` with one effect's parameters: never a keyword of WGSL, whatever the effect's name. */
function memberOf(effect: SplatEffect): string {
  return `${camelCase(effect)}Values`;
}

/** Hooks that take `selected`. */
type SelectionHook = 'splat' | 'color';

/** The functions by which stages call hooks. Linked text has them in this order. */
const HOOK_FUNCTIONS: Readonly<Record<keyof EffectHooks, HookFunction>> = {
  splat: { name: 'changeSplat', type: 'Splat', others: ['splatIndex: u32'], redoes: 'order' },
  opacity: {
    name: 'changeOpacity',
    type: 'f32',
    others: ['onScreen: ScreenSplat', 'dilationPx2: f32'],
    redoes: 'order',
  },
  screen: { name: 'changeScreen', type: 'ScreenSplat', others: [], redoes: 'order' },
  bounds: { name: 'changeBounds', type: 'ChunkBounds', others: ['chunkIndex: u32'], redoes: 'order' },
  color: {
    name: 'changeColor',
    type: 'vec3f',
    others: ['splat: Splat', 'splatIndex: u32', 'centerView: vec3f'],
    redoes: 'colors',
  },
};

interface HookFunction {
  readonly name: string;
  readonly type: string;
  /** Further parameters. */
  readonly others: readonly string[];
  /** What other values of the effect change: the splats that are drawn and their places, or colours alone. */
  readonly redoes: 'order' | 'colors';
}

const ORDER_HOOKS = /* @__PURE__ */ (Object.keys(HOOK_FUNCTIONS) as (keyof EffectHooks)[]).filter(
  (hook) => HOOK_FUNCTIONS[hook].redoes === 'order',
);

/** Whether other values of an effect with these hooks change which splats are drawn, or where. */
export function changesOrder(hooks: EffectHooks): boolean {
  return ORDER_HOOKS.some((hook) => hooks[hook] !== undefined);
}

/**
 * Returns the module `effects`, whose functions apply one effect after another, the module
 * `parameters` with their structs, and a module for each effect. Only declarations that a stage uses
 * are linked.
 */
function modulesOf(linked: readonly LinkedEffect[]): ShaderModules {
  const withParameters = linked.filter(({ parameters }) => parameters !== null);
  const selecting = linked.filter(({ effect }) => effect.takesSelection);
  const structs = withParameters.map(({ parameters }) => parameters!.wgsl);
  const members = withParameters.map(
    ({ effect, parameters }) =>
      `  @size(${roundUp(parameters!.bytes, STRUCT_ALIGNMENT)}) ${memberOf(effect)}: ${parameters!.name},`,
  );
  const imports = [
    'import package::lib::chunk_frustum::ChunkBounds;',
    'import package::lib::packing::Splat;',
    'import package::lib::visible_ellipse::ScreenSplat;',
  ];
  const functions: string[] = [];
  const localName = (each: LinkedEffect, hook: keyof EffectHooks) => callOf(hook, linked.indexOf(each));
  for (const hook of Object.keys(HOOK_FUNCTIONS) as (keyof EffectHooks)[]) {
    const acting = linked.filter(({ hooks }) => hooks[hook] !== undefined);
    if (acting.length === 0) continue;
    const { name, type, others } = HOOK_FUNCTIONS[hook];
    const passed = others.map((parameter) => parameter.split(':')[0]);
    const steps = acting.map((each) => {
      const { effect } = each;
      const isOfSplat = hook === 'splat' || hook === 'color';
      const row = effect.rows && isOfSplat ? ['rowOf(splatIndex)'] : [];
      const selected =
        effect.takesSelection && isOfSplat ? [`isSelected(splatIndex, ${selecting.indexOf(each)}u)`] : [];
      const level = effect.takesLevel && hook === 'color' ? ['levelOf(splatIndex)'] : [];
      const changedBy = (own: string[]) =>
        `changed = ${localName(each, hook)}(${['changed', ...passed, ...row, ...level, ...selected, ...own].join(', ')});`;
      if (!effect.parameters) return `  ${changedBy([])}`;
      const member = memberOf(effect);
      return [
        `  @if(!INSTANCES) ${changedBy([`effects.${member}`])}`,
        `  @if(INSTANCES) ${changedBy([`effects[instanceIndex].${member}`])}`,
      ].join('\n');
    });
    functions.push(
      `fn ${name}(${[`unchanged: ${type}`, ...others].join(', ')}) -> ${type} {`,
      '  var changed = unchanged;',
      ...steps,
      '  return changed;',
      '}',
    );
    for (const each of acting) {
      const { effect } = each;
      imports.push(`import ${moduleNameOf(effect)}::${effect.hooks[hook]} as ${localName(each, hook)};`);
    }
  }
  const uniform =
    members.length > 0
      ? [
          '@if(INSTANCES) import constants::BATCH_INSTANCES;',
          '@if(INSTANCES) import package::lib::instances::instanceIndex;',
          `@if(!INSTANCES) @group(0) @binding(${PARAMETERS_BINDING}) var<uniform> effects: Effects;`,
          `@if(INSTANCES) @group(0) @binding(${PARAMETERS_BINDING}) var<uniform> effects: array<Effects, BATCH_INSTANCES>;`,
        ]
      : [];
  if (uniform.length > 0)
    imports.push(
      'import parameters::effects;',
      '@if(INSTANCES) import package::lib::instances::instanceIndex;',
    );
  // Every thread copies arrays that are passed by value, so functions read lists where they are.
  const lists = linked
    .filter(({ effect }) => effect.hasList)
    .flatMap(({ effect }) => {
      const member = memberOf(effect);
      return [
        `fn ${camelCase(effect)}At(index: u32) -> vec4f {`,
        `  @if(!INSTANCES) return effects.${member}.list[index];`,
        `  @if(INSTANCES) return effects[instanceIndex].${member}.list[index];`,
        '}',
      ];
    });
  const resources = linked
    .flatMap(({ effect }) => effect.resources?.declarations(effect.name) ?? [])
    .map((declaration, i) => `@group(0) @binding(${RESOURCES_BINDING + i}) ${declaration}`);
  // All bits of the first effect's selection, then all bits of the second's, and so on.
  const selection =
    selecting.length > 0
      ? [
          `@group(0) @binding(${SELECTED_BINDING}) var<storage, read> selectedBits: array<u32>;`,
          'fn isSelected(splatIndex: u32, selection: u32) -> bool {',
          `  let first = selection * (arrayLength(&selectedBits) / ${selecting.length}u);`,
          '  return extractBits(selectedBits[first + splatIndex / 32u], splatIndex % 32u, 1u) == 1u;',
          '}',
        ]
      : [];
  const levels = linked.some(({ effect }) => effect.takesLevel)
    ? [
        'import constants::CHUNK_SPLATS;',
        `@group(0) @binding(${LEVELS_BINDING}) var<uniform> chunkLevels: array<vec4u, ${CHUNK_LEVEL_BYTES / 16}>;`,
        'fn levelOf(splatIndex: u32) -> u32 {',
        `  let chunk = min(splatIndex / CHUNK_SPLATS, ${2 * CHUNK_LEVEL_BYTES - 1}u);`,
        '  return extractBits(chunkLevels[chunk / 32u][chunk / 8u % 4u], 4u * (chunk % 8u), 4u);',
        '}',
      ]
    : [];
  return {
    effects: [...imports, rowsOf({ linked })?.wgsl() ?? '', ...levels, ...selection, ...functions].join('\n'),
    parameters: [
      ...uniform,
      ...structs,
      `struct Effects {\n${members.join('\n')}\n}`,
      ...lists,
      ...resources,
    ].join('\n'),
    ...Object.fromEntries(linked.map(({ effect }) => [moduleNameOf(effect), effect.wgsl])),
  };
}
