import { type FrameSceneOptions, frameScene, InvalidArgumentError } from '@websplatter/core';
import { boundingSphere, boundsOf } from '../../camera/scene-bounds.ts';
import { type PartLook, PLAIN_LOOK } from '../../state/scene-part.ts';
import { nearestUpAxis, type UpAxis } from '../../state/up-axis.ts';
import { PLACE_FIELD } from '../link/place-link.ts';
import { changedPlacement, type PlacedFile, placedLook, uprightPlacement } from './placement.ts';
import { SURE } from './scene-notices.ts';
import { type LoadedScene, ownUp, type SceneFrame } from './shown-scene.ts';

/** How a file that is being opened is drawn. */
export interface LookFinder {
  readonly lookOf: (loaded: LoadedScene) => PartLook;
  /** Looks at the whole file before it is shown; rejects as `frameScene`. */
  readonly whenWhole?: (loaded: LoadedScene, options: FrameSceneOptions) => Promise<void>;
  /** Message about unreadable parts of a link. */
  readonly notice?: string;
}

/** The scene that a file is added to. */
export interface JoinedScene extends SceneFrame {
  /** The axis that points up in the scene. */
  readonly up: UpAxis;
}

/**
 * The look of a file is taken from the link; otherwise the file is drawn as saved, the same way up as the
 * scene that it joins.
 *
 * @param linkedLook undefined if the link has none.
 * @param joined null if the file starts a scene.
 */
export function lookFinder(linkedLook: string | undefined, joined: JoinedScene | null): LookFinder {
  let upright: PartLook | null = null;
  const lookOf = (loaded: LoadedScene) => {
    // Captures in formats that define no up axis are mostly parts of one scene, in the same axes.
    if (joined === null || (joined.isUpsideDown && loaded.isUpsideDown)) return upright ?? PLAIN_LOOK;
    const file = placedFile(loaded);
    return upright ?? placedLook(PLAIN_LOOK, uprightPlacement(file, joined.up), file);
  };
  const whenWhole = async (loaded: LoadedScene, options: FrameSceneOptions) => {
    if (joined && loaded.clouds.length > 0)
      upright = await uprightLook(loaded, joined.up, lookOf(loaded), options);
  };
  if (linkedLook === undefined) return { lookOf, whenWhole };
  try {
    const find = PLACE_FIELD.decode(linkedLook);
    return { lookOf: (loaded) => find(placedFile(loaded)) };
  } catch (error) {
    if (!(error instanceof InvalidArgumentError)) throw error;
    return { lookOf, notice: error.message };
  }
}

/**
 * The look of a file that joins a scene, upright by its own splats as it would be alone; `usual` unless they
 * are clear about its up axis.
 */
async function uprightLook(
  loaded: LoadedScene,
  up: UpAxis,
  usual: PartLook,
  options: FrameSceneOptions,
): Promise<PartLook> {
  // A file whose splats cannot be read back is drawn as usual; if the GPU is lost, its session says so.
  const framing = await frameScene(loaded.clouds, options).catch(() => null);
  if (!framing || framing.confidence.up < SURE) return usual;
  const found = nearestUpAxis(framing.up);
  // Parts of one capture have the same axes.
  if (found === up) return PLAIN_LOOK;
  const file = placedFile(loaded);
  return placedLook(PLAIN_LOOK, changedPlacement(uprightPlacement(file, up), { up: found }, file), file);
}

function placedFile(loaded: LoadedScene): PlacedFile {
  return {
    ownUp: ownUp(loaded),
    middle: boundingSphere(boundsOf(loaded.clouds, 'robustBounds')).center,
  };
}
