import type { ScenePartSummary } from '../state/scene-part.ts';
import type { ViewerState } from '../state/store.ts';

/** The file that placement handles move: the selected one, or the scene's only one. */
export function selectedPartOf({
  scene,
  selectedPart,
}: Pick<ViewerState, 'scene' | 'selectedPart'>): ScenePartSummary | undefined {
  const parts = scene?.parts ?? [];
  return parts.find(({ key }) => key === selectedPart) ?? (parts.length === 1 ? parts[0] : undefined);
}
