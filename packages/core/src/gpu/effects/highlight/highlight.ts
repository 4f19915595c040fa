import { given, wrongArgument } from '../../../data/given.ts';
import type { Vec3 } from '../../../data/math/mat4.ts';
import type { SplatSelection } from '../../../data/splats/splat-selection.ts';
import { effectFunction } from '../effect.ts';
import { EFFECT_LIST } from '../effect-list.ts';
import { checkRange, checkVector } from '../option-checks.ts';
import wgsl from './highlight.wgsl?raw';

/** Options of `highlight`. */
export interface HighlightOptions {
  /** The selection to show; kept by reference, changes show in the next frame. */
  readonly selection: SplatSelection;
  /** Red, green and blue, sRGB-encoded, 0…1. */
  readonly color: Vec3;
  /** Share of `color` in the colour of selected splats, 0…1; 0 changes nothing. */
  readonly strength: number;
}

/**
 * Shows which splats are selected: mixes their colour with another.
 *
 * @example
 * const selection = new SplatSelection();
 * const effects = [highlight({ selection, color: [1, 0.6, 0], strength: 0.7 })];
 */
export const highlight = /* @__PURE__ */ effectFunction<
  HighlightOptions,
  { color: 'vec3f'; strength: 'f32' }
>({
  ...EFFECT_LIST.highlight,
  wgsl,
  fields: { color: 'vec3f', strength: 'f32' },
  check(options) {
    given(options, {}, 'highlight');
    const { selection, color, strength } = options;
    if (typeof selection?.bitsOf !== 'function')
      throw wrongArgument('selection', selection, 'the SplatSelection to show');
    checkVector('color', color, 'red, green and blue of a highlight, each 0…1', { isNonNegative: true });
    if (color.some((value) => value > 1))
      throw wrongArgument('color', color, 'red, green and blue of a highlight, each 0…1');
    checkRange('strength', strength, 1, 'the share of that colour');
  },
  calledFor: ({ selection: { size }, strength }) =>
    size === 0 || strength === 0 ? null : `${size} ${size === 1 ? 'splat is' : 'splats are'} selected`,
  selection: ({ selection }) => selection,
  valuesAt: ({ color, strength }) => ({ color, strength }),
});
