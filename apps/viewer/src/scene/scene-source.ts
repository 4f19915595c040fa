import type { BuiltinScene } from '@websplatter/scenes';
import { baseName } from '../words/format.ts';

/** Where a scene comes from; kept, so that it can be read again. */
export type SceneSource =
  | { readonly kind: 'builtin'; readonly scene: BuiltinScene }
  | { readonly kind: 'file'; readonly file: File }
  | { readonly kind: 'url'; readonly url: URL }
  | { readonly kind: 'hard-case'; readonly name: string };

export function titleOf(source: SceneSource): string {
  switch (source.kind) {
    case 'builtin':
      return source.scene.title;
    case 'file':
      return source.file.name;
    case 'url':
      return baseName(source.url.href);
    case 'hard-case':
      return source.name;
  }
}
