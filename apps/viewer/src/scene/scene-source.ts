import type { SceneFiles } from '@websplatter/core';
import type { BuiltinSceneFacts } from '@websplatter/scenes';
import { baseName } from '../words/format.ts';

/** Where a scene comes from; kept, so that it can be read again. */
export type SceneSource =
  | { readonly kind: 'builtin'; readonly scene: BuiltinSceneFacts }
  | { readonly kind: 'file'; readonly name: string; readonly source: File | SceneFiles }
  | { readonly kind: 'url'; readonly url: URL }
  /** Two or more files, which are shown together. */
  | { readonly kind: 'urls'; readonly urls: readonly URL[] }
  | { readonly kind: 'hard-case'; readonly name: string };

export function titleOf(source: SceneSource): string {
  switch (source.kind) {
    case 'builtin':
      return source.scene.title;
    case 'file':
    case 'hard-case':
      return source.name;
    case 'url':
      return baseName(source.url.href);
    case 'urls':
      return NAMES.format(shortened(source.urls.map(({ href }) => baseName(href))));
  }
}

const NAMES = new Intl.ListFormat('en');
const MOST_NAMES = 3;

/** So many names that they can be read, and how many there are besides. */
function shortened(names: readonly string[]): string[] {
  if (names.length <= MOST_NAMES) return [...names];
  return [...names.slice(0, MOST_NAMES - 1), `${names.length - MOST_NAMES + 1} more`];
}
