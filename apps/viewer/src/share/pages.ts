import { encodeLook } from '../engine/look-text.ts';
import { heldView } from '../engine/page-address.ts';
import { joinedNames, titleOf } from '../engine/scene-source.ts';
import type { SavingState } from '../state/saving.ts';
import { FileWork, perViewer } from './file-work.ts';
import { type PageKind, PageRefusal, readParts } from './held-parts.ts';
import { linkedViewOf } from './linked-view.ts';
import { writePage } from './page-text.ts';
import { zipPage } from './page-zip.ts';
import { drawPicture } from './pictures.ts';
import { savedName } from './saved-name.ts';
import { fetchScenePage } from './scene-page-template.ts';

/** Saves the scene and the view of it as a web page or a zip of one, one at a time. */
class Pages extends FileWork {
  /** Writes the file and hands it to the browser. Does nothing without a scene, or while busy. */
  async start(kind: PageKind): Promise<void> {
    const { store } = this;
    const state = store.getState();
    const parts = this.viewer.scenes.newest?.parts.filter(({ look }) => !look.isHidden) ?? [];
    if (parts.length === 0 || this.isBusy) return;
    const titles = parts.map(({ source }) => titleOf(source));
    const fileName = savedName(titles, { extension: `.${kind}` });
    // Written down now: the camera may move meanwhile. Looks are all told, as files may be left out.
    // The page has no list of views.
    const view = heldView({
      ...linkedViewOf(this.viewer, state),
      savedViews: [],
      looks: parts.map(({ look }) => encodeLook(look)),
    });
    const { background } = state.look;
    const report = (progress: Pick<SavingState, 'phase' | 'part'>) =>
      store.setState({ savingPage: { fileName, ...progress } });
    report({ phase: 'read', part: undefined });
    store.setState({ failure: null });
    const make = async (signal: AbortSignal) => {
      if (state.inspecting.selecting.removed.size > 0) throw removedSplats();
      const sources = parts.map(({ source }) => source);
      const [template, held] = await Promise.all([
        fetchScenePage(signal),
        readParts(sources, { kind, signal, onPart: (part) => report({ phase: 'read', part }) }),
      ]);
      const contents = {
        title: joinedNames(titles),
        view,
        background: background === 'theme' ? null : background,
        parts: held,
      };
      const options = { signal, onPart: (part: number) => report({ phase: 'write', part }) };
      if (kind === 'html') return writePage(template, contents, options);
      return zipPage(template, contents, await this.#poster(signal), options);
    };
    await this.run({
      fileName,
      doing: 'Saving',
      make,
      failureOf: (error) => ({
        title: `${fileName} cannot be saved`,
        advice: error instanceof PageRefusal ? error.advice : '',
        isFault: !(error instanceof PageRefusal),
      }),
      onEnd: () => store.setState({ savingPage: null }),
    });
  }

  /** The picture on the screen. */
  async #poster(signal: AbortSignal): Promise<Blob> {
    const shown = this.viewer.shownFrame;
    if (!shown) return new Blob();
    const { widthPx, heightPx } = shown.frame;
    const options = { widthPx, heightPx, isTransparent: false };
    return drawPicture(shown, this.store.getState().accuracy, options, () => {}, signal);
  }
}

function removedSplats(): PageRefusal {
  return new PageRefusal(
    'A page holds files as they came, with the splats that were removed.',
    'Save the scene as a file, which leaves them out, open that and save the page then.',
  );
}

/** Those of a viewer. */
export const pagesOf = perViewer((viewer, store) => new Pages(viewer, store));
