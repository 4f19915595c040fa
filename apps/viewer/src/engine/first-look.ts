import { InvalidArgumentError } from '@websplatter/core';
import { boundingSphere, boundsOf } from '../camera/scene-bounds.ts';
import { type PartLook, PLAIN_LOOK } from '../state/scene-part.ts';
import type { UpAxis } from '../state/up-axis.ts';
import type { LoadedScene } from './loaded-scene.ts';
import { PLACE_FIELD } from './place-link.ts';
import { type PlacedFile, placedLook, uprightPlacement } from './placement.ts';
import { ownUp, type SceneFrame } from './shown-scene.ts';

export interface LookFinder {
  readonly lookOf: (loaded: LoadedScene) => PartLook;
  /** Message about unreadable parts of a link; null if there are none. */
  readonly notice: string | null;
}

/** The scene that a file is added to. */
export interface JoinedScene extends SceneFrame {
  /** The axis that points up in the scene. */
  readonly up: UpAxis;
}

/**
 * Returns a function that decides the look of a loaded file. The look is taken from the link;
 * otherwise the file is drawn as saved, the same way up as the scene that it joins.
 *
 * @param linkedLook undefined if the link has none.
 * @param joined null if the file starts a scene.
 */
export function lookFinder(linkedLook: string | undefined, joined: JoinedScene | null): LookFinder {
  const beside = (loaded: LoadedScene) => {
    // Captures in formats that define no up axis are mostly parts of one scene, in the same axes.
    if (joined === null || (joined.isUpsideDown && loaded.isUpsideDown)) return PLAIN_LOOK;
    const file = placedFile(loaded);
    return placedLook(PLAIN_LOOK, uprightPlacement(file, joined.up), file);
  };
  if (linkedLook === undefined) return { lookOf: beside, notice: null };
  try {
    const find = PLACE_FIELD.decode(linkedLook);
    return { lookOf: (loaded) => find(placedFile(loaded)), notice: null };
  } catch (error) {
    if (!(error instanceof InvalidArgumentError)) throw error;
    return { lookOf: beside, notice: error.message };
  }
}

function placedFile(loaded: LoadedScene): PlacedFile {
  return {
    ownUp: ownUp(loaded),
    middle: boundingSphere(boundsOf(loaded.clouds, 'robustBounds')).center,
  };
}
