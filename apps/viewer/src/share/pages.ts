import { WebSplatterError } from '@websplatter/core';
import { zipFiles } from '@websplatter/core/write';
import { heldView, linkedViewOf } from '../engine/link/page-address.ts';
import { PLACE_FIELD } from '../engine/link/place-link.ts';
import { type SceneSource, titleOfAll } from '../engine/open/scene-source.ts';
import type { SavingState } from '../state/saving.ts';
import { pathSegment } from '../ui/path-segment.ts';
import { cutParts } from './cut-parts.ts';
import { FileWork, perViewer, savedName } from './file-work.ts';
import { type PageKind, PageRefusal, readParts } from './held-parts.ts';
import { type PageContents, type WritePageOptions, writePage } from './page-text.ts';
import { drawPicture } from './pictures.ts';

const POSTER = 'poster.png';

/**
 * Puts the page and the files of its scene, which then lie beside it, into a zip for any web host.
 *
 * @param poster PNG that the page shows until there is a picture.
 * @throws as `writePage`, and as `zipFiles` for a scene of several files.
 */
export async function zipPage(
  template: string,
  contents: PageContents,
  poster: Blob,
  options: WritePageOptions,
): Promise<Blob> {
  const beside: Record<string, Uint8Array> = {};
  const parts = [];
  // In folders of their own, as two files may have one name.
  for (const [i, part] of contents.parts.entries()) {
    const paths = Object.fromEntries(part.files.map(({ path, bytes }) => [path, bytes]));
    const [name, bytes] =
      part.files.length === 1
        ? [part.files[0].path, await bytesOf(part.files[0].bytes)]
        : // A scene of several files can be read by one address as an archive of them.
          [`${part.title}.zip`, zipFiles(await allBytesOf(paths))];
    const path = pathSegment(name);
    beside[`scene/${i + 1}/${path}`] = bytes;
    const address = `scene/${i + 1}/${encodeURIComponent(path)}`;
    parts.push({ ...part, files: [{ path, bytes: new Blob(), address }] });
    options.signal.throwIfAborted();
  }
  const page = await writePage(template, { ...contents, parts, poster: POSTER }, options);
  const files = { ...(await allBytesOf({ 'index.html': page, [POSTER]: poster })), ...beside };
  return new Blob([zipFiles(files)], { type: 'application/zip' });
}

async function allBytesOf(files: Readonly<Record<string, Blob>>): Promise<Record<string, Uint8Array>> {
  const entries = Object.entries(files).map(async ([path, blob]) => [path, await bytesOf(blob)]);
  return Object.fromEntries(await Promise.all(entries));
}

async function bytesOf(blob: Blob): Promise<Uint8Array> {
  return new Uint8Array(await blob.arrayBuffer());
}

/** Saves the scene and the view of it as a web page or a zip of one, one at a time. */
class Pages extends FileWork {
  /** Writes the file and hands it to the browser. Does nothing without a scene, or while busy. */
  async start(kind: PageKind): Promise<void> {
    const { store } = this;
    const state = store.getState();
    const parts = this.viewer.scenes.newest?.parts.filter(({ look }) => !look.isHidden) ?? [];
    if (parts.length === 0 || this.isBusy) return;
    const sources = parts.map(({ source }) => source);
    const fileName = savedName(sources, { extension: `.${kind}` });
    // Written down now: camera and edits may change meanwhile.
    const linked = linkedViewOf(this.viewer, state);
    const { inspecting } = state;
    const { background } = state.look;
    const report = (progress: Pick<SavingState, 'phase' | 'part'>) =>
      store.setState({ savingPage: { fileName, ...progress } });
    report({ phase: 'read', part: undefined });
    store.setState({ failure: null });
    const notes: string[] = [];
    const make = async (signal: AbortSignal) => {
      const cut = await cutParts(parts, inspecting, {
        signal,
        onPart: (part) => report({ phase: 'cut', part }),
        onNote: (note) => notes.push(note),
      });
      const [template, held] = await Promise.all([
        fetchScenePage(signal),
        readParts(
          cut.map(({ source }) => source),
          { kind, signal, onPart: (part) => report({ phase: 'read', part }) },
        ),
      ]);
      const contents = {
        title: titleOfAll(sources),
        // The files are cut already. Looks are all told, as files may be left out.
        view: heldView({
          ...linked,
          crop: null,
          looks: cut.map(({ part }) => PLACE_FIELD.encode(part.look)),
        }),
        background: background === 'theme' ? null : background,
        // A built-in scene keeps its cameras.
        parts: held.map((each, i) => ({ ...each, builtin: builtinName(cut[i].part.source) })),
      };
      const options = { signal, onPart: (part: number) => report({ phase: 'write', part }) };
      if (kind === 'html') return writePage(template, contents, options);
      return zipPage(template, contents, await this.#poster(signal), options);
    };
    await this.run({
      fileName,
      doing: 'Saving',
      make,
      notes,
      failureOf: (error) => ({
        title: `${fileName} cannot be saved`,
        advice: error instanceof PageRefusal ? error.advice : '',
        isFault: !(error instanceof PageRefusal || error instanceof WebSplatterError),
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

function builtinName(source: SceneSource): string | null {
  return source.kind === 'builtin' ? source.scene.name : null;
}

/** The viewer's one `Pages`, made at the first call. */
export const pagesOf = perViewer((viewer, store) => new Pages(viewer, store));

/**
 * The text of the page that scenes are put into. It is fetched only when somebody saves one.
 *
 * @throws PageRefusal where it cannot be fetched; the signal's reason once that is aborted.
 */
async function fetchScenePage(signal: AbortSignal): Promise<string> {
  try {
    const { default: address } = await import('virtual:scene-page');
    const response = await fetch(address, { signal });
    if (!response.ok) throw new Error(`The server answers ${response.status}`);
    return await response.text();
  } catch (error) {
    signal.throwIfAborted();
    console.error(error);
    throw new PageRefusal(
      'The code of the page could not be fetched.',
      'Check the connection, then reload the viewer.',
    );
  }
}
