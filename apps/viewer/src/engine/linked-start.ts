import { type Detail, InvalidArgumentError } from '@websplatter/core';
import { decodeCamera } from '../state/camera-text.ts';
import { decodeComparison, type LinkedComparison } from '../state/comparison-text.ts';
import { decodeDetail } from '../state/detail-text.ts';
import type { LinkedCamera } from '../state/saved-view.ts';
import type { ViewModeName } from '../state/view-mode.ts';
import { decodeViewMode } from '../state/view-mode-text.ts';

/** Name that the look of a file has in the page's address. */
export const LOOK_NAME = 'place';

/** How the address asks for the scene to be shown. */
export interface LinkedStart {
  readonly camera: LinkedCamera | null;
  readonly comparison: LinkedComparison | null;
  readonly viewMode: ViewModeName;
  /** Null where none is asked for. */
  readonly detail: Detail | null;
  /** Looks of the scene's files, in their order, by `encodeLook`; none if all are as saved. */
  readonly looks: readonly string[];
  /** The unreadable parts, in words; null if none. */
  readonly notice: string | null;
}

/** Reads an address of `linkTo`; leaves unreadable parts out. */
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
