import type { SceneFiles } from '@websplatter/core';
import type { SceneSource } from '../scene/scene-source.ts';

/** Where a scene of one cloud can be read again. */
export type LastingScene =
  | { readonly kind: 'builtin'; readonly name: string }
  | { readonly kind: 'file'; readonly name: string; readonly source: File | SceneFiles }
  | { readonly kind: 'url'; readonly href: string };

/** Null for what is several clouds, and no one file. */
export function lastingScene(source: SceneSource): LastingScene | null {
  switch (source.kind) {
    case 'builtin':
      return { kind: 'builtin', name: source.scene.name };
    case 'file':
      return source;
    case 'url':
      return { kind: 'url', href: source.url.href };
    case 'urls':
    case 'hard-case':
      return null;
  }
}
