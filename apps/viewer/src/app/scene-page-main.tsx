// The page that the section “Web page” saves: the picture alone, of the scene in it or beside it.
import './scene-page.css';
import { builtinScenes } from '@websplatter/scenes';
import { useEffect, useMemo } from 'react';
import { useStore } from 'zustand';
import { followLinkedEffects } from '../effects/linked-effects.ts';
import { linkedStart } from '../engine/link/linked-start.ts';
import type { SceneSource } from '../engine/open/scene-source.ts';
import { type PanelProps, Viewer } from '../engine/viewer.ts';
import { keepStory } from '../navigate/keep-story.ts';
import { FILE_SELECTOR, PART_SELECTOR, POSTER_NAME, VIEW_NAME } from '../share/page-text.ts';
import { createViewerStore } from '../state/store.ts';
import { followViewMode } from '../view-modes/follow-view-mode.ts';
import { createCommands, listenToKeys } from './commands.ts';
import { mirrorToDocument } from './document-mirror.ts';
import { followDrop } from './follow-drop.ts';
import { listenForGamepads } from './gamepad-listener.ts';
import { PlainPicture } from './plain-picture.tsx';
import { show } from './show.tsx';
import { UnavailablePage } from './status-pages.tsx';

interface HeldScene {
  readonly title: string;
  /** URL query of the view. */
  readonly view: string;
  /** URL of an image to show before the first picture. */
  readonly poster: string | null;
  readonly sources: readonly SceneSource[];
}

/** Removes the scene from a page made by `writePage`: its text is large and no longer needed. */
function heldScene(page: Document): HeldScene {
  const meta = (name: string) => page.querySelector<HTMLMetaElement>(`meta[name="${name}"]`)?.content;
  const sources = [...page.querySelectorAll<HTMLElement>(PART_SELECTOR)].map((element) => {
    element.remove();
    return sourceIn(element);
  });
  return { title: page.title, view: meta(VIEW_NAME) ?? '', poster: meta(POSTER_NAME) ?? null, sources };
}

function sourceIn(element: HTMLElement): SceneSource {
  const { part: name = '', builtin } = element.dataset;
  const elements = [...element.querySelectorAll<HTMLElement>(FILE_SELECTOR)];
  const texts = elements.map(({ dataset, textContent }) => ({
    path: dataset.path ?? '',
    base64: textContent,
  }));
  const [first] = elements;
  // A scene beside the page is one file.
  const beside = first instanceof HTMLAnchorElement ? new URL(first.href) : null;
  const scene = builtinScenes.find((each) => each.name === builtin);
  if (scene) {
    const url = beside ?? new URL(`data:application/octet-stream;base64,${texts[0].base64}`);
    return { kind: 'builtin', scene: { ...scene, url } };
  }
  if (beside) return { kind: 'url', url: beside };
  const files = texts.map(({ path, base64 }) => new File(bytesOf(base64), path.split('/').at(-1) ?? path));
  const source = files.length === 1 ? files[0] : { files, paths: texts.map(({ path }) => path) };
  return { kind: 'file', name, source };
}

/** A multiple of 4, so that each piece is valid base64. */
const PIECE_CHARACTERS = 2 ** 22;

function bytesOf(base64: string): Uint8Array<ArrayBuffer>[] {
  const pieces: Uint8Array<ArrayBuffer>[] = [];
  for (let at = 0; at < base64.length; at += PIECE_CHARACTERS) {
    const binary = atob(base64.slice(at, at + PIECE_CHARACTERS));
    const bytes = new Uint8Array(binary.length);
    for (let i = 0; i < binary.length; i++) bytes[i] = binary.charCodeAt(i);
    pieces.push(bytes);
  }
  return pieces;
}

const { title, view, poster, sources } = heldScene(document);
const query = new URLSearchParams(view);
const store = createViewerStore();
store.setState({ hasInterface: false });
mirrorToDocument(store, document, () => title);
const viewer = new Viewer(store, {
  held: sources,
  linked: linkedStart(query),
});
viewer.prepare();
followViewMode(store, viewer);
const isHeld = (shown: readonly SceneSource[]) => shown.every((source) => sources.includes(source));
followLinkedEffects({ store, viewer }, query, isHeld);
keepStory({ store, viewer }, query, null, isHeld);
show(<ScenePage store={store} viewer={viewer} poster={poster} />);

/** Only the picture, or the reason why there is none. */
function ScenePage({ store, viewer, poster }: PanelProps & { poster: string | null }) {
  const isUnavailable = useStore(store, (state) => state.status === 'unavailable');
  // Without the interface, no key runs these commands.
  const run = useMemo(
    () => createCommands(viewer, store, { addFiles: () => {}, walk: () => {} }),
    [viewer, store],
  );
  useEffect(() => listenToKeys(viewer, store, run), [viewer, store, run]);
  useEffect(() => listenForGamepads(viewer, store, run), [viewer, store, run]);
  if (isUnavailable) return <UnavailablePage store={store} onRetry={() => viewer.recover()} />;
  return (
    <PlainPicture
      store={store}
      viewer={viewer}
      poster={poster}
      onDrop={(decision) => followDrop(decision, store, viewer)}
    />
  );
}
