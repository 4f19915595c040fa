import { InvalidArgumentError } from '../errors.ts';
import type { Vec3 } from '../math/mat4.ts';
import { effectShader } from '../shaders/link-shader.ts';
import type { SplatSelection } from '../splats/splat-selection.ts';
import { defineEffect } from './effect.ts';

export interface HighlightOptions {
  /** The selection to show; kept by reference, changes show in the next frame. */
  readonly selection: SplatSelection;
  /** Red, green and blue, sRGB-encoded, 0…1. */
  readonly color: Vec3;
  /** Share of that colour in the colour of selected splats, 0…1; 0 changes nothing. */
  readonly strength: number;
}

/** Shows which splats are selected: mixes their colour with another. */
export const highlight = /* @__PURE__ */ defineEffect<HighlightOptions, { color: 'vec3f'; strength: 'f32' }>({
  name: 'highlight',
  label: 'Highlight',
  about: 'Shows which splats are selected.',
  hooks: { color: 'highlightColor' },
  wgsl: effectShader('highlight'),
  fields: { color: 'vec3f', strength: 'f32' },
  check({ color, strength }) {
    if (!(color.length === 3 && color.every((value) => value >= 0 && value <= 1))) {
      const message = `The highlight is [${color.join(', ')}]; it takes red, green and blue, each 0…1.`;
      throw new InvalidArgumentError('color', message);
    }
    if (strength >= 0 && strength <= 1) return;
    const message = `The strength of the highlight is ${strength}; it must lie in 0…1.`;
    throw new InvalidArgumentError('strength', message);
  },
  calledFor: ({ selection: { count }, strength }) =>
    count === 0 || strength === 0 ? null : `${count} ${count === 1 ? 'splat is' : 'splats are'} selected`,
  selection: ({ selection }) => selection,
  valuesAt: ({ color, strength }) => ({ color, strength }),
});
