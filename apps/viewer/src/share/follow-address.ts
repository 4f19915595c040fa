import { addressWithout, linkedViewOf, pageAddress } from '../engine/link/page-address.ts';
import type { Viewer } from '../engine/viewer.ts';
import type { ViewerStore } from '../state/store.ts';

/** In this script, too, since none is needed before the first picture. */
export { keepStory } from '../navigate/keep-story.ts';
export { keepWork } from '../project/keep-work.ts';

/** The address is written this long after the last change: browsers limit how often it may be. */
const ADDRESS_DELAY_MS = 250;

/**
 * Keeps the view and its settings in the page's URL, so that a reload or a shared link restores them.
 * The camera is written once it is at rest. Returns a function that stops the updates.
 */
export function mirrorToAddress(store: ViewerStore, viewer: Viewer): () => void {
  let timer: ReturnType<typeof setTimeout> | undefined;
  const write = () => {
    const state = store.getState();
    // The rest that follows writes it, when all of the scene is there.
    if (!state.isIdle || state.load) return;
    const page = new URL(location.href);
    const unmentioned = { camera: viewer.camera.first, accuracy: state.defaultAccuracy };
    const address = pageAddress(page, linkedViewOf(viewer, state), unmentioned);
    if (address !== page.href.slice(page.origin.length)) history.replaceState(history.state, '', address);
  };
  let forgotten = 0;
  /** Without waiting for a picture: a reload, or a copy of the address, would download the file after all. */
  const forget = () => {
    const { cancelled } = viewer.scenes;
    if (cancelled.length === forgotten) return;
    const address = addressWithout(new URL(location.href), cancelled.slice(forgotten));
    forgotten = cancelled.length;
    history.replaceState(history.state, '', address);
  };
  const writeSoon = () => {
    clearTimeout(timer);
    timer = setTimeout(write, ADDRESS_DELAY_MS);
  };
  forget();
  const unsubscribe = store.subscribe((state, before) => {
    forget();
    if (MIRRORED.some((name) => state[name] !== before[name])) writeSoon();
  });
  writeSoon();
  return () => {
    clearTimeout(timer);
    unsubscribe();
  };
}

/** Parts of the state after whose change the address may be another one. */
const MIRRORED = [
  'accuracy',
  'target',
  'detail',
  'isDetailChosen',
  'comparison',
  'splitPart',
  'requested',
  'scene',
  'isFlipped',
  'isZUp',
  'look',
  'viewMode',
  'savedViews',
  'path',
  'annotating',
  'cameraIndex',
  'restedFrames',
  'isIdle',
  'load',
] as const;
