import type { SceneFiles } from '@websplatter/core';
import { baseName } from '@websplatter/kit/format';
import type { BuiltinScene } from '@websplatter/scenes';

/** Source of a scene or of one of its files, kept so that it can be read again. */
export type SceneSource =
  | { readonly kind: 'builtin'; readonly scene: BuiltinScene }
  | { readonly kind: 'file'; readonly name: string; readonly source: File | SceneFiles }
  | { readonly kind: 'url'; readonly url: URL }
  | { readonly kind: 'hard-case'; readonly name: string };

export function titleOf(source: SceneSource): string {
  switch (source.kind) {
    case 'builtin':
      return source.scene.title;
    case 'file':
    case 'hard-case':
      return source.name;
    case 'url':
      return nameOf(source.url);
  }
}

/**
 * File name of a URL. A scene of several files is named by its folder, because its first file
 * always has the same name.
 */
function nameOf(url: URL): string {
  const name = baseName(url.href);
  return /^(lod-)?meta\.json$/i.test(name) ? baseName(new URL('.', url).href) : name;
}

/** Title of scenes that are shown together. */
export function titleOfAll(sources: readonly SceneSource[]): string {
  return joinedNames(sources.map(titleOf));
}

/** Joins names into a list that is short enough to read. */
export function joinedNames(names: readonly string[]): string {
  return NAMES.format(shortened(names));
}

const NAMES = new Intl.ListFormat('en');
const MOST_NAMES = 3;

/** Names of which there are few enough to read. */
export function shortened(names: readonly string[]): string[] {
  if (names.length <= MOST_NAMES) return [...names];
  return [...names.slice(0, MOST_NAMES - 1), `${names.length - MOST_NAMES + 1} more`];
}
