import { type Detail, InvalidArgumentError } from '@websplatter/core';
import { LINK_FIELDS, type LinkedComparison } from '../state/link-fields.ts';
import type { LinkField } from '../state/link-parts.ts';
import type { LinkedCamera } from '../state/saved-view.ts';
import type { ViewModeName } from '../state/view-mode.ts';

/** Name that the look of a file has in the page's URL. */
export const PLACE_NAME = 'place';

/** How the address asks for the scene to be shown. */
export interface LinkedStart {
  readonly camera: LinkedCamera | null;
  readonly comparison: LinkedComparison | null;
  readonly viewMode: ViewModeName;
  /** Null where none is asked for. */
  readonly detail: Detail | null;
  /** Looks of the scene's files, in their order, by `PLACE_FIELD`; none if all are as saved. */
  readonly looks: readonly string[];
  /** The unreadable parts, in words; null if none. */
  readonly notice: string | null;
}

/** Reads an address of `linkTo`; leaves unreadable parts out. */
export function linkedStart(query: URLSearchParams): LinkedStart {
  const notices: string[] = [];
  const read = <T>(field: Pick<LinkField<never, T>, 'name' | 'decode'>): T | null => {
    const text = query.get(field.name);
    if (text === null) return null;
    try {
      return field.decode(text);
    } catch (error) {
      if (!(error instanceof InvalidArgumentError)) throw error;
      notices.push(error.message);
      return null;
    }
  };
  const camera = read(LINK_FIELDS.camera);
  const comparison = read(LINK_FIELDS.compare);
  const viewMode = read(LINK_FIELDS.mode) ?? 'colours';
  const detail = read(LINK_FIELDS.detail);
  const looks = query.getAll(PLACE_NAME);
  const notice = notices.length > 0 ? notices.join(' ') : null;
  return { camera, comparison, viewMode, detail, looks, notice };
}
