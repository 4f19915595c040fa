import type { ViewerStore } from '../state/store.ts';
import { HUD_SIZES, type HudSize } from '../state/viewer-state.ts';
import { keepText, keptText } from '../ui/storage.ts';

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
 */
export function keepHud(store: ViewerStore): void {
  const kept = readHud();
  if (kept) store.setState(kept);
  else if (matchMedia(PHONE).matches) store.setState({ isHudVisible: false });
  store.subscribe(({ isHudVisible, hudSize }, before) => {
    if (isHudVisible === before.isHudVisible && hudSize === before.hudSize) return;
    keepText(KEY, JSON.stringify({ isHudVisible, hudSize } satisfies KeptHud));
  });
}

/** Null where nothing was kept, or nothing that this version can read. */
function readHud(): KeptHud | null {
  try {
    const { isHudVisible, hudSize }: Partial<KeptHud> = JSON.parse(keptText(KEY) ?? '{}') ?? {};
    const size = HUD_SIZES.find((each) => each === hudSize);
    return size && typeof isHudVisible === 'boolean' ? { isHudVisible, hudSize: size } : null;
  } catch {
    return null;
  }
}
