import type { ViewerStore } from '../state/store.ts';
import { HUD_SIZES, type HudSize } from '../state/viewer-state.ts';

const KEY = 'websplatter viewer figures';
/** These have no room for figures over the image, unless a person asks for them. */
const PHONE = '(pointer: coarse) and (max-width: 640px), (pointer: coarse) and (max-height: 480px)';

interface KeptHud {
  readonly isHudVisible: boolean;
  readonly hudSize: HudSize;
}

/**
 * Shows the figures as they were when the page was closed last, and keeps what becomes of them. At
 * first they are closed on phones.
 *
 * @param storage the page's own; null where it may not store anything.
 */
export function keepHud(store: ViewerStore, storage = storageOf(window), matches = isMatching): void {
  const kept = readHud(storage);
  if (kept) store.setState(kept);
  else if (matches(PHONE)) store.setState({ isHudVisible: false });
  store.subscribe(({ isHudVisible, hudSize }, before) => {
    if (isHudVisible === before.isHudVisible && hudSize === before.hudSize) return;
    try {
      storage?.setItem(KEY, JSON.stringify({ isHudVisible, hudSize } satisfies KeptHud));
    } catch {
      // A full storage only costs the next page a click.
    }
  });
}

/** Null where nothing was kept, or nothing that this version can read. */
function readHud(storage: Pick<Storage, 'getItem'> | null): KeptHud | null {
  try {
    const { isHudVisible, hudSize }: Partial<KeptHud> = JSON.parse(storage?.getItem(KEY) ?? '{}') ?? {};
    const size = HUD_SIZES.find((each) => each === hudSize);
    return size && typeof isHudVisible === 'boolean' ? { isHudVisible, hudSize: size } : null;
  } catch {
    return null;
  }
}

/** Reading it throws where a page may not store anything. */
function storageOf(page: Window): Pick<Storage, 'getItem' | 'setItem'> | null {
  try {
    return page.localStorage;
  } catch {
    return null;
  }
}

function isMatching(query: string): boolean {
  return matchMedia(query).matches;
}
