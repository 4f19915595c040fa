import type { ViewerStore } from '../state/store.ts';
import { addressWithAccuracy } from '../words/accuracy-address.ts';

/** The address is written this long after the last change: browsers limit how often it may be written. */
const ADDRESS_DELAY_MS = 250;

/** Keeps the accuracy in the page's address, so that it can be shared; returns what stops that. */
export function mirrorToAddress(store: ViewerStore): () => void {
  let timer: ReturnType<typeof setTimeout> | undefined;
  const write = () => {
    const { wish, accuracy, defaultAccuracy } = store.getState();
    const address = addressWithAccuracy(new URL(location.href), wish ?? accuracy, defaultAccuracy);
    history.replaceState(history.state, '', address);
  };
  const unsubscribe = store.subscribe((state, before) => {
    if (state.accuracy === before.accuracy && state.wish === before.wish) return;
    clearTimeout(timer);
    timer = setTimeout(write, ADDRESS_DELAY_MS);
  });
  return () => {
    clearTimeout(timer);
    unsubscribe();
  };
}
