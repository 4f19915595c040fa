import { type Detail, InvalidArgumentError } from '@websplatter/core';
import { decodeCamera } from '../state/camera-text.ts';
import { decodeComparison, type LinkedComparison } from '../state/comparison-text.ts';
import { decodeDetail } from '../state/detail-text.ts';
import type { LinkedCamera } from '../state/saved-view.ts';
import type { ViewModeName } from '../state/view-mode.ts';
import { decodeViewMode } from '../state/view-mode-text.ts';

/** Query parameter with the look of a file. */
export const LOOK_NAME = 'place';

/** The view that the page's URL asks for. */
export interface LinkedStart {
  readonly camera: LinkedCamera | null;
  readonly comparison: LinkedComparison | null;
  readonly viewMode: ViewModeName;
  /** Null if the URL asks for none. */
  readonly detail: Detail | null;
  /** Looks of the scene's files in order, by `encodeLook`; empty if all are drawn as saved. */
  readonly looks: readonly string[];
  /** Message about unreadable parts; null if there are none. */
  readonly notice: string | null;
}

/** Reads a URL made by `linkTo`; skips unreadable parts. */
export function linkedStart(query: URLSearchParams): LinkedStart {
  const notices: string[] = [];
  const read = <T>(name: string, decode: (text: string) => T): T | null => {
    const text = query.get(name);
    if (text === null) return null;
    try {
      return decode(text);
    } catch (error) {
      if (!(error instanceof InvalidArgumentError)) throw error;
      notices.push(error.message);
      return null;
    }
  };
  const camera = read('camera', decodeCamera);
  const comparison = read('compare', decodeComparison);
  const viewMode = read('mode', decodeViewMode) ?? 'colours';
  const detail = read('detail', decodeDetail);
  const looks = query.getAll(LOOK_NAME);
  const notice = notices.length > 0 ? notices.join(' ') : null;
  return { camera, comparison, viewMode, detail, looks, notice };
}
