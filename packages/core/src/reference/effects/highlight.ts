import type { HighlightOptions } from '../../effects/highlight.ts';
import type { Vec3 } from '../../math/mat4.ts';
import type { EffectReference } from './effect-reference.ts';

export function highlightReference({ selection, color, strength }: HighlightOptions): EffectReference {
  const mixed = (unselected: Vec3, axis: number) =>
    unselected[axis] + strength * (color[axis] - unselected[axis]);
  return {
    changeColor: (unselected, { row }) =>
      selection.has(row) ? [mixed(unselected, 0), mixed(unselected, 1), mixed(unselected, 2)] : unselected,
  };
}
