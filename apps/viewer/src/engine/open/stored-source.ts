import type { Harmonics, SplatSet } from '@websplatter/core';
import { findHardCase, loadHardCases } from './catalogue.ts';
import { type LastingScene, lastingScene } from './lasting-scene.ts';
import type { ShownPart } from './shown-scene.ts';

/** Source from which a cloud is read again; structured-cloneable, for workers. */
export type StoredSource =
  | LastingScene
  | { readonly kind: 'bytes'; readonly bytes: Uint8Array<ArrayBuffer> }
  | { readonly kind: 'set'; readonly set: SplatSet<Harmonics> };

/** Source of each cloud of a file or a hard case, in order. */
export async function cloudSources(
  part: Pick<ShownPart, 'source' | 'loaded'>,
): Promise<readonly StoredSource[]> {
  const { source } = part;
  if (source.kind === 'hard-case') {
    const hardCase = findHardCase(await loadHardCases(), source.name);
    if (hardCase.kind === 'refused-file') return [{ kind: 'bytes', bytes: hardCase.file() }];
    return hardCase
      .clouds()
      .map((splats) =>
        'file' in splats ? { kind: 'bytes', bytes: splats.file } : { kind: 'set', set: splats.set },
      );
  }
  const lasting = lastingScene(part);
  return lasting ? [lasting] : [];
}
