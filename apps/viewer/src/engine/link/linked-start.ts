import {
  type AccuracySettings,
  type AccuracyTarget,
  type Detail,
  InvalidArgumentError,
} from '@websplatter/core';
import { decodeAccuracy } from '../../state/accuracy-address.ts';
import type { Background } from '../../state/camera.ts';
import { LINK_FIELDS, type LinkedComparison } from '../../state/link-fields.ts';
import type { LinkField } from '../../state/link-parts.ts';
import type { LinkedCamera } from '../../state/saved-view.ts';
import type { ViewModeName } from '../../state/view-mode.ts';

/** Query parameter with the look of a file. */
export const PLACE_NAME = 'place';

/** The view that the page's URL asks for. */
export interface LinkedStart {
  /** Null if the URL asks for none. */
  readonly accuracy: AccuracySettings | AccuracyTarget | null;
  readonly camera: LinkedCamera | null;
  readonly comparison: LinkedComparison | null;
  readonly viewMode: ViewModeName;
  /** Null if the URL asks for none. */
  readonly background: Background | null;
  /** Null if the URL asks for none. */
  readonly detail: Detail | null;
  /** Looks of the scene's files in order, by `PLACE_FIELD`; empty if all are drawn as saved. */
  readonly looks: readonly string[];
  /** Message about unreadable parts; null if there are none. */
  readonly notice: string | null;
}

const ACCURACY = {
  name: 'accuracy',
  decode: (text: string) => {
    try {
      return decodeAccuracy(text);
    } catch (error) {
      if (!(error instanceof InvalidArgumentError)) throw error;
      throw new InvalidArgumentError(
        'accuracy',
        `The address asks for an unknown accuracy. ${error.message}`,
      );
    }
  },
};

/** Reads a URL made by `linkTo`; skips unreadable parts. */
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
  const background = read(LINK_FIELDS.background);
  const detail = read(LINK_FIELDS.detail);
  const accuracy = read(ACCURACY);
  const looks = query.getAll(PLACE_NAME);
  const notice = notices.length > 0 ? notices.join(' ') : null;
  return { accuracy, camera, comparison, viewMode, background, detail, looks, notice };
}
