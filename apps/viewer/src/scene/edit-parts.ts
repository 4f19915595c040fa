import { changedPlacement, placedLook, placementOf } from '../engine/open/placement.ts';
import type { PanelProps } from '../engine/viewer.ts';
import { makeEdit, replacement } from '../state/make-edit.ts';
import type { PartLook, Placement, ScenePartSummary } from '../state/scene-part.ts';
import { withAxis } from '../state/vec3.ts';

/**
 * Changes how a file is drawn.
 *
 * @param name what it changes, as in "Undo opacity of a.ply".
 * @param gesture successive changes of one gesture are undone together; null for a change of its own.
 */
export function lookPart(
  { store, viewer: { scenes } }: PanelProps,
  { key, title, look }: ScenePartSummary,
  name: string,
  change: Partial<PartLook>,
  gesture: unknown = null,
): void {
  const now = () => scenes.lookOf(key) ?? look;
  // A look without a placement has no matrix, which would otherwise stay.
  const show = (shown: PartLook) => scenes.setLook(key, { modelMatrix: undefined, ...shown });
  makeEdit(store, replacement(`${name} of ${title}`, { ...now(), ...change }, now, show), gesture);
}

/** Names of edits of a placement. */
const PLACINGS = {
  move: 'move',
  turnDegrees: 'turn',
  scale: 'scale',
  up: 'up axis',
  sceneUp: 'up axis',
} as const;

/** Changes one thing of a file's placement in the scene. */
export function placePart(
  panel: PanelProps,
  part: ScenePartSummary,
  change: Partial<Omit<Placement, 'about'>>,
  gesture: unknown = null,
): void {
  const placement = changedPlacement(placementOf(part), change, part);
  const [changed] = Object.keys(change) as (keyof typeof change)[];
  lookPart(panel, part, PLACINGS[changed], placedLook(part.look, placement, part), gesture);
}

export function movePart(
  panel: PanelProps,
  part: ScenePartSummary,
  axis: number,
  to: number,
  gesture: unknown = null,
): void {
  placePart(panel, part, { move: withAxis(placementOf(part).move, axis, to) }, gesture);
}

/** Removes a file from the scene; undoing it opens the file again with its look. */
export function removePart({ store, viewer }: PanelProps, { key, title }: ScenePartSummary): void {
  const removed = viewer.scenes.newest?.parts.find((part) => part.key === key);
  if (!removed) return;
  makeEdit(store, {
    name: `removal of ${title}`,
    do: () => viewer.scenes.remove(key),
    undo: () => viewer.scenes.addAgain(removed),
  });
  store.setState({ notice: { text: `${title} is removed.`, offers: [{ label: 'Undo', command: 'undo' }] } });
}

/** Distance of one step: a power of ten, about a hundredth of the file's size. */
export function moveStep({ radius, look }: Pick<ScenePartSummary, 'radius' | 'look'>): number {
  const shown = radius * (look.placement?.scale ?? 1);
  return 10 ** Math.floor(Math.log10(shown / 50));
}
