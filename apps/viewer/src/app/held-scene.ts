import { builtinScenes } from '@websplatter/scenes';
import type { SceneSource } from '../engine/scene-source.ts';
import { FILE_SELECTOR, PART_SELECTOR, POSTER_NAME, VIEW_NAME } from '../share/page-text.ts';

export interface HeldScene {
  readonly title: string;
  /** The query of an address that shows the view. */
  readonly view: string;
  /** Address of an image to show until there is a picture. */
  readonly poster: string | null;
  readonly sources: readonly SceneSource[];
}

/** Takes the scene out of a page of `writePage`: its text is large and not needed after that. */
export function heldScene(page: Document): HeldScene {
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
  // Beside the page, a part of a scene is one file.
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

/** A multiple of 4, so that pieces are base64 too. */
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
