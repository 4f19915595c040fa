import { InvalidArgumentError } from '@websplatter/core';
import { boundingSphere, boundsOf } from '../camera/scene-bounds.ts';
import type { UpAxis } from '../camera/up-axis.ts';
import type { LoadedScene } from '../scene/loaded-scene.ts';
import { ownUp } from '../scene/shown-scene.ts';
import { type PartLook, PLAIN_LOOK } from '../state/scene-part.ts';
import { decodeLook } from './look-text.ts';
import { type PlacedFile, placedLook, uprightPlacement } from './placement.ts';

export interface LookFinder {
  readonly lookOf: (loaded: LoadedScene) => PartLook;
  /** The unreadable parts of a link, in words; null if none. */
  readonly notice: string | null;
}

/**
 * Finds the look of a file that has arrived: as a link writes it, else as it was saved, the same
 * way up as the scene that it joins.
 *
 * @param linkedLook undefined if there is none.
 * @param sceneUp the axis that points up in the scene that it joins; null if it begins one.
 */
export function lookFinder(linkedLook: string | undefined, sceneUp: UpAxis | null): LookFinder {
  const beside = (file: PlacedFile) =>
    sceneUp === null ? PLAIN_LOOK : placedLook(PLAIN_LOOK, uprightPlacement(file, sceneUp), file);
  try {
    const find = linkedLook === undefined ? beside : decodeLook(linkedLook);
    return { lookOf: (loaded) => find(placedFile(loaded)), notice: null };
  } catch (error) {
    if (!(error instanceof InvalidArgumentError)) throw error;
    return { lookOf: (loaded) => beside(placedFile(loaded)), notice: error.message };
  }
}

function placedFile(loaded: LoadedScene): PlacedFile {
  return {
    ownUp: ownUp(loaded),
    middle: boundingSphere(boundsOf(loaded.clouds, 'robustBounds')).center,
  };
}
