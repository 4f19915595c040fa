import { heldView, linkedViewOf } from '../engine/link/page-address.ts';
import { cloudKey } from '../engine/open/shown-scene.ts';
import type { Viewer } from '../engine/viewer.ts';
import type { LengthScale, Ruler } from '../state/inspecting.ts';
import { SCENE_LINK_FIELDS } from '../state/scene-link-fields.ts';
import type { RowMasks } from '../state/selecting.ts';
import type { ViewerState } from '../state/store.ts';

/** All that a person made of a scene, without its files: as projects and the browser keep it. */
export interface KeptWork {
  /** Query as `heldView` writes it: camera, look, crop, effects, saved views and annotations. */
  readonly view: string;
  readonly rulers: readonly Ruler['ends'][];
  readonly scale: LengthScale | null;
  /** Removed rows, by `cloudKey` of a file's place in the scene. */
  readonly removed: RowMasks;
}

/** The work on the scene of the screen. */
export function keptWork(viewer: Viewer, state: ViewerState): KeptWork {
  const { rulers, scale, selecting } = state.inspecting;
  const parts = viewer.scenes.newest?.parts ?? [];
  const places = new Map(parts.map(({ key }, place) => [String(key), place]));
  return {
    view: heldView(linkedViewOf(viewer, state)),
    rulers: rulers.map(({ ends }) => ends),
    scale,
    removed: withKeys(selecting.removed, (key) => places.get(key)),
  };
}

/** Masks by other keys of their files; those of files without one are left out. */
export function withKeys(masks: RowMasks, keyOf: (file: string) => number | undefined): RowMasks {
  const entries = [...masks].flatMap(([name, words]) => {
    const [file, cloud] = name.split('/');
    const key = keyOf(file);
    return key === undefined ? [] : [[cloudKey(key, Number(cloud)), words] as const];
  });
  return new Map(entries);
}

/** Whether two have the same edits, seen from wherever. */
export function hasSameEdits(a: KeptWork, b: KeptWork): boolean {
  const textOf = ({ view, rulers }: KeptWork) =>
    JSON.stringify([new URLSearchParams(view).get(SCENE_LINK_FIELDS.crop.name), rulers]);
  const keys = [...new Set([...a.removed.keys(), ...b.removed.keys()])];
  return (
    textOf(a) === textOf(b) &&
    keys.every((key) => {
      const [words, others] = [a, b].map(({ removed }) => removed.get(key) ?? new Uint32Array());
      const count = Math.max(words.length, others.length);
      for (let i = 0; i < count; i++) if ((words[i] ?? 0) !== (others[i] ?? 0)) return false;
      return true;
    })
  );
}
