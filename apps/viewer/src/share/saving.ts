import { WebSplatterError } from '@websplatter/core';
import type { GradeOptions, WritableFormat } from '@websplatter/core/write';
import { lastingScene } from '../engine/open/lasting-scene.ts';
import { cloudKey, type ShownPart } from '../engine/open/shown-scene.ts';
import { timingOf } from '../engine/play/scene-time.ts';
import { sceneFile } from '../scene/scene-file.ts';
import type { SavedPart, SavedRows, SaveRequest } from '../scene/write-scene.ts';
import type { SavingState } from '../state/saving.ts';
import type { Selecting } from '../state/selecting.ts';
import { upAxisOf } from '../state/up-axis.ts';
import { FileWork, perViewer, savedName } from './file-work.ts';

/** Saves the scene on the screen as a file, one at a time. */
class Saving extends FileWork {
  /** Writes the scene in another format and hands the browser the file, if there is a scene. */
  async start(format: WritableFormat): Promise<void> {
    const { store } = this;
    const state = store.getState();
    const { crop, selecting } = state.inspecting;
    const all = this.viewer.scenes.newest?.parts ?? [];
    const seen = all.filter(({ look }) => !look.isHidden && look.opacity > 0);
    const parts = seen.map((part) => savedPart(part, selecting)).filter((part) => part !== null);
    if (parts.length === 0 || this.isBusy) return;
    const fileName = savedName(
      seen.map(({ source }) => source),
      format,
    );
    const report = (progress: Pick<SavingState, 'phase' | 'part'>) =>
      store.setState({ saving: { fileName, ...progress } });
    report({ phase: 'read', part: undefined });
    store.setState({ failure: null });
    const up = upAxisOf(state);
    const graded = state.requested.effects.find(({ effect }) => effect.name === 'grade');
    const grade = graded && { grade: graded.options as GradeOptions };
    const time = state.sceneTime ?? timingOf(this.viewer.scenes.newest)?.range[0];
    const request: SaveRequest = { parts, formatName: format.name, up, crop, time, ...grade };
    const notes: string[] = [];
    await this.run({
      fileName,
      doing: 'Saving',
      make: (signal) => sceneFile(request, report, (note) => notes.push(note), signal),
      notes,
      failureOf: (error) => ({
        title: `${fileName} cannot be saved`,
        // The engine's errors say why the scene cannot be written, which is no fault of the viewer.
        isFault: !(error instanceof WebSplatterError),
      }),
      onEnd: () => store.setState({ saving: null }),
    });
  }
}

/** The viewer's one `Saving`, made at the first call. */
export const savingOf = perViewer((viewer, store) => new Saving(viewer, store));

/** A scene's part of the saved file; null if the scene has no lasting source, such as a file. */
function savedPart(part: ShownPart, selecting: Selecting): SavedPart | null {
  const { key, loaded, look } = part;
  const { opacity, placement } = look;
  const source = lastingScene(part);
  // Sources that last have one cloud each.
  const rows = savedRows(cloudKey(key, loaded.frame ?? 0), selecting);
  return source && { source, opacity, placement, rows };
}

function savedRows(key: string, selecting: Selecting): SavedRows | null {
  if (savesSelection(selecting))
    return { words: selecting.selected.get(key) ?? new Uint32Array(), areSaved: true };
  const words = selecting.removed.get(key);
  return words ? { words, areSaved: false } : null;
}

/** Whether only the selected splats are saved. */
export function savesSelection({ savesSelection: isAsked, selected }: Selecting): boolean {
  return isAsked && selected.size > 0;
}
