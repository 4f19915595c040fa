import type { Inspecting } from './inspecting.ts';
import type { SceneSummary } from './scene.ts';
import { countOf } from './selecting.ts';

/**
 * How many splats of the scene are left: of files that are shown, neither removed nor cropped away. Null while
 * the splats that a crop leaves are not counted yet. All words about what is left take this number.
 */
export function leftSplats({
  scene,
  inspecting: { crop, cropCount, selecting },
}: {
  readonly scene: SceneSummary | null;
  readonly inspecting: Inspecting;
}): number | null {
  if (crop) return cropCount;
  const shown = scene?.parts.filter(({ look }) => !look.isHidden) ?? [];
  const masks = shown.flatMap(({ cloudKeys }) =>
    cloudKeys.map((key) => [key, selecting.removed.get(key)] as const),
  );
  const removed = countOf(new Map(masks.flatMap(([key, words]) => (words ? [[key, words]] : []))));
  return shown.reduce((sum, { splats }) => sum + splats, 0) - removed;
}
