import type { Vec3 } from '../../../data/math/mat4.ts';
import { SplatSelection } from '../../../data/splats/splat-selection.ts';
import type { EffectReference } from '../../../reference/effects/effect-reference.ts';
import type { HighlightOptions } from './highlight.ts';

/** A selection of every third of the first 1,200 rows. */
function everyThird(): SplatSelection {
  const selection = new SplatSelection();
  selection.add(Array.from({ length: 400 }, (_, i) => 3 * i));
  return selection;
}

export const example: HighlightOptions = {
  selection: /* @__PURE__ */ everyThird(),
  color: [1, 0.6, 0],
  strength: 0.7,
};

export function reference({ selection, color, strength }: HighlightOptions): EffectReference {
  const mixed = (unselected: Vec3, axis: number) => {
    const seen = Math.max(0, unselected[axis]);
    return seen + strength * (color[axis] - seen);
  };
  return {
    changeColor: (unselected, { row }) =>
      selection.has(row) ? [mixed(unselected, 0), mixed(unselected, 1), mixed(unselected, 2)] : unselected,
  };
}
