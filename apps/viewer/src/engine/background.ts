import type { Background } from '../state/look.ts';
import type { ViewerStore } from '../state/store.ts';
import type { Vec3 } from '../state/vec3.ts';
import { observeTheme } from '../ui/theme.ts';

/**
 * Gives `element` the chosen background and calls `onColor` with it, sRGB 0…1: now, after each
 * choice and, for the theme's, when the colour scheme changes. Returns a function that stops this.
 */
export function observeBackground(
  element: HTMLElement,
  store: ViewerStore,
  onColor: (color: Vec3) => void,
): () => void {
  const report = () => onColor(backgroundOf(element));
  const take = (background: Background) => {
    element.style.backgroundColor = background === 'theme' ? '' : background;
    report();
  };
  take(store.getState().look.background);
  const unsubscribe = store.subscribe(({ look }, before) => {
    if (look.background !== before.look.background) take(look.background);
  });
  const stop = observeTheme(report);
  return () => {
    unsubscribe();
    stop();
  };
}

function backgroundOf(element: Element): Vec3 {
  const channels =
    getComputedStyle(element)
      .backgroundColor.match(/[\d.]+/g)
      ?.map(Number) ?? [];
  const [red = 0, green = 0, blue = 0] = channels;
  return [red / 255, green / 255, blue / 255];
}
