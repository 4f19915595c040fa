import type { SceneFiles } from '@websplatter/core';
import type { SceneSource } from './scene-source.ts';

/** A source from which a scene's file can be read again. */
export type LastingScene =
  | { readonly kind: 'file'; readonly name: string; readonly source: File | SceneFiles }
  | { readonly kind: 'url'; readonly href: string };

/** Null for hard cases, which have no file. */
export function lastingScene(source: SceneSource): LastingScene | null {
  switch (source.kind) {
    case 'builtin':
      return { kind: 'url', href: source.scene.url.href };
    case 'file':
      return source;
    case 'url':
      return { kind: 'url', href: source.url.href };
    case 'hard-case':
      return null;
  }
}
