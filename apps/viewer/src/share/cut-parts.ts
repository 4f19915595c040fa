import { lastingScene } from '../engine/open/lasting-scene.ts';
import { type SceneSource, titleOf } from '../engine/open/scene-source.ts';
import { cloudKey, type ShownPart } from '../engine/open/shown-scene.ts';
import { inSceneWorker } from '../scene/scene-file.ts';
import type { SavedRows } from '../scene/write-scene.ts';
import type { Crop, Inspecting } from '../state/inspecting.ts';
import { countOf, type RowMasks } from '../state/selecting.ts';
import { savedName } from './file-work.ts';
import { PageRefusal } from './held-parts.ts';

export interface CutPartsOptions {
  readonly signal: AbortSignal;
  /** Called with the part that has been cut, 0…1, or undefined where that is not known. */
  readonly onPart: (part: number | undefined) => void;
  /** Called with a sentence for each kind of data that a cut file cannot store. */
  readonly onNote: (note: string) => void;
}

/** A file of the scene, and its source without what edits hide. */
export interface CutPart {
  readonly part: ShownPart;
  readonly source: SceneSource;
}

/**
 * The files of a scene without the splats that crop and removals hide. Files of which nothing is
 * hidden stay as they came; those of which nothing is left are absent.
 *
 * @throws PageRefusal if nothing is left of the whole scene; errors of readers and writers; the
 * signal's reason once that is aborted.
 */
export async function cutParts(
  parts: readonly ShownPart[],
  { crop, selecting }: Pick<Inspecting, 'crop' | 'selecting'>,
  { signal, onPart, onNote }: CutPartsOptions,
): Promise<CutPart[]> {
  const edited = parts.filter((part) => isCut(part, crop, selecting.removed));
  if (edited.length === 0) return parts.map((part) => ({ part, source: part.source }));
  return inSceneWorker(async (remote) => {
    const cut: CutPart[] = [];
    for (const part of parts) {
      const source = edited.includes(part) ? lastingScene(part) : null;
      if (!source) {
        cut.push({ part, source: part.source });
        continue;
      }
      const before = edited.indexOf(part);
      const file = await remote.call(
        'cut',
        { source, placement: part.look.placement, rows: removedRows(part, selecting.removed), crop },
        {
          signal,
          onProgress: ({ phase, part: done }) => {
            // Reading and writing take about as long.
            const ofPart = done === undefined ? undefined : (phase === 'read' ? done : 1 + done) / 2;
            onPart(ofPart === undefined ? undefined : (before + ofPart) / edited.length);
          },
        },
      );
      if (file.kind === 'all') cut.push({ part, source: part.source });
      if (file.kind !== 'file') continue;
      for (const note of file.notes) onNote(note);
      const held = new File([file.bytes], savedName([part.source], file));
      cut.push({ part, source: { kind: 'file', name: titleOf(part.source), source: held } });
    }
    if (cut.length === 0)
      throw new PageRefusal('Crop and removals leave no splats.', 'Undo one of them (Ctrl+Z).');
    return cut;
  });
}

function isCut(part: ShownPart, crop: Crop | null, removed: RowMasks): boolean {
  return crop !== null || removedRows(part, removed) !== null;
}

function removedRows({ key, loaded }: ShownPart, removed: RowMasks): SavedRows | null {
  // Sources that last have one cloud each.
  const words = removed.get(cloudKey(key, loaded.frame ?? 0));
  return words && countOf(new Map([['', words]])) > 0 ? { words, areSaved: false } : null;
}
