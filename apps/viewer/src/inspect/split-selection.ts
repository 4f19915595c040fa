import { formatSplats } from '@websplatter/kit/format';
import { lastingScene } from '../engine/open/lasting-scene.ts';
import { joinedNames, titleOf } from '../engine/open/scene-source.ts';
import { cloudKey } from '../engine/open/shown-scene.ts';
import type { SavedPart, SaveRequest } from '../scene/write-scene.ts';
import { PLAIN_LOOK } from '../state/scene-part.ts';
import { countOf } from '../state/selecting.ts';
import type { EditHistory } from './edit-history.ts';
import type { InspectTools } from './inspect-tools.ts';
import { joined } from './row-masks.ts';

/** Tools for `splitSelection`. */
export interface SplitTools extends Pick<InspectTools, 'store' | 'update'> {
  readonly viewer: {
    readonly scenes: Pick<InspectTools['viewer']['scenes'], 'newest' | 'newKey' | 'addAgain' | 'remove'>;
  };
  /** Writes a file; see `sceneFile`. */
  readonly write: (request: SaveRequest) => Promise<Blob>;
}

/**
 * Makes the selected splats a file of their own beside the others, which can be moved, turned,
 * scaled and saved like any file. One edit: undoing it puts the splats back.
 */
export async function splitSelection(
  { store, update, viewer, write }: SplitTools,
  history: EditHistory,
): Promise<void> {
  const { scenes } = viewer;
  const { selected } = store.getState().inspecting.selecting;
  const titles: string[] = [];
  const parts: SavedPart[] = [];
  for (const shown of scenes.newest?.parts ?? []) {
    const { key, look, loaded } = shown;
    // Sources that last have one cloud each.
    const words = selected.get(cloudKey(key, loaded.frame ?? 0));
    const source = lastingScene(shown);
    if (!words || !source) continue;
    titles.push(titleOf(shown.source).replace(/(\.compressed)?\.[a-z]+$/i, ''));
    parts.push({ source, placement: look.placement, opacity: look.opacity, rows: { words, areSaved: true } });
  }
  if (parts.length === 0) return;
  let blob: Blob;
  try {
    // A PLY keeps every value in float32, and with −y up nothing is turned.
    blob = await write({ parts, formatName: 'ply', up: '-y', crop: null });
  } catch (error) {
    update({ problem: `The selection cannot be a file of its own. ${(error as Error).message}` });
    return;
  }
  const { selecting } = store.getState().inspecting;
  // Another selection was made meanwhile.
  if (selecting.selected !== selected) return;
  const name = `Part of ${joinedNames(titles)}.ply`;
  const part = {
    key: scenes.newKey(),
    source: { kind: 'file', name, source: new File([blob], name) },
    look: PLAIN_LOOK,
  } as const;
  const change = { selected: new Map(), removed: joined(selecting.removed, selected) };
  history.edit(`split of ${formatSplats(countOf(selected))}`, change, null, {
    do: () => scenes.addAgain(part),
    undo: () => scenes.remove(part.key),
  });
  store.setState({ dock: 'clouds', selectedPart: part.key });
}
