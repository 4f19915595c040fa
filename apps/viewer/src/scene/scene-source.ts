import type { SceneFiles } from '@websplatter/core';
import type { BuiltinScene } from '@websplatter/scenes';
import { baseName } from '../words/format.ts';

/** Where a scene comes from; kept, so that it can be read again. */
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
      return baseName(source.url.href);
  }
}
