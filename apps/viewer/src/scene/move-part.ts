import { changedPlacement, placedLook, placementOf } from '../engine/placement.ts';
import type { Viewer } from '../engine/viewer.ts';
import type { Placement, ScenePartSummary } from '../state/scene-part.ts';
import { withAxis } from '../state/vec3.ts';

/** Changes a file's placement in the scene. */
export function placePart(
  { scenes }: Viewer,
  part: ScenePartSummary,
  change: Partial<Omit<Placement, 'about'>>,
): void {
  const placement = changedPlacement(placementOf(part), change, part);
  scenes.setLook(part.key, placedLook(part.look, placement, part));
}

export function movePart(viewer: Viewer, part: ScenePartSummary, axis: number, to: number): void {
  placePart(viewer, part, { move: withAxis(placementOf(part).move, axis, to) });
}

/** Distance of one step: a power of ten, about a hundredth of the file's size. */
export function moveStep({ radius, look }: Pick<ScenePartSummary, 'radius' | 'look'>): number {
  const shown = radius * (look.placement?.scale ?? 1);
  return 10 ** Math.floor(Math.log10(shown / 50));
}
