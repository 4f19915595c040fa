import type { SceneFiles } from '@websplatter/core';
import { framesOf } from '../play/scene-time.ts';
import type { ShownPart } from './shown-scene.ts';

/** A source from which a scene's file can be read again. */
export type LastingScene = (
  | { readonly kind: 'file'; readonly name: string; readonly source: File | SceneFiles }
  | { readonly kind: 'url'; readonly href: string }
) & {
  /** Index of the frame to read of a file of frames; undefined for other files. */
  readonly frame?: number;
};

/** The source of a part, with the frame that it shows. Null for hard cases, which have no file. */
export function lastingScene({ source, loaded }: Pick<ShownPart, 'source' | 'loaded'>): LastingScene | null {
  const hasFrames = loaded.clouds.some(({ cloud }) => framesOf(cloud));
  const frame = hasFrames ? (loaded.frame ?? 0) : undefined;
  switch (source.kind) {
    case 'builtin':
      return { kind: 'url', href: source.scene.url.href };
    case 'file':
      return { ...source, frame };
    case 'url':
      return { kind: 'url', href: source.url.href, frame };
    case 'hard-case':
      return null;
  }
}
