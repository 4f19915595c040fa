import { keepText, keptText } from '@websplatter/kit/storage';
import { App } from './app/app.tsx';
import { mirrorToDocument } from './app/document-mirror.ts';
import { show } from './app/show.tsx';
import { hasOpenedFile } from './engine/keep/opened-file.ts';
import { addressedScene } from './engine/link/addressed-scene.ts';
import type { LinkedStart } from './engine/link/linked-start.ts';
import { type StartOptions, Viewer } from './engine/viewer.ts';
import { HUD_SIZES, type HudSize } from './state/page.ts';
import { createViewerStore, type ViewerStore } from './state/store.ts';
import { fetchLazy, withCode } from './ui/lazy.tsx';
import { followViewMode } from './view-modes/follow-view-mode.ts';

const KEY = 'websplatter viewer figures';
/** Screens without room for the HUD over the image; there it is closed by default. */
const PHONE = '(pointer: coarse) and (max-width: 640px), (pointer: coarse) and (max-height: 480px)';

interface KeptHud {
  readonly isHudVisible: boolean;
  readonly hudSize: HudSize | null;
}

/**
 * Restores the HUD's state from the last visit and stores its changes. By default it is closed on
 * phones.
 */
export function keepHud(store: ViewerStore): void {
  const kept = readHud();
  if (kept) store.setState(kept);
  else if (matchMedia(PHONE).matches) store.setState({ isHudVisible: false });
  const hud = ({ isHudVisible, hudSize }: KeptHud) => JSON.stringify({ isHudVisible, hudSize });
  store.subscribe(hud, (text) => keepText(KEY, text));
}

/** Null if nothing was stored, or nothing that this version can read. */
function readHud(): KeptHud | null {
  try {
    const { isHudVisible, hudSize }: Partial<KeptHud> = JSON.parse(keptText(KEY) ?? '{}') ?? {};
    if (typeof isHudVisible !== 'boolean') return null;
    return { isHudVisible, hudSize: HUD_SIZES.find((each) => each === hudSize) ?? null };
  } catch {
    // What is stored is no JSON: the figures are shown as on a first visit.
    return null;
  }
}

/**
 * Shows the viewer, with the scene and settings of `address`, the query of the page's URL.
 *
 * @param linked the view that it asks for; undefined if it only names a scene.
 */
export function showViewer(address: URLSearchParams, linked?: LinkedStart): void {
  const start = startOf(address, linked);
  const store = createViewerStore();
  store.setState({ hasInterface: !address.has('noui') });
  mirrorToDocument(store, document);
  keepHud(store);
  fetchLateWhenIdle(store);
  const viewer = new Viewer(store, start);
  // Takes a while and does not need the page.
  viewer.prepare();
  followViewMode(store, viewer);
  // The URL is not written before the first picture, which need not wait for this code.
  void withCode(
    store,
    () => import('./share/follow-address.ts'),
    ({ keepStory, keepWork, mirrorToAddress }) => {
      // A page with only the picture shows the URL's state and stores nothing.
      const storage = address.has('noui') ? null : () => localStorage;
      keepStory({ store, viewer }, address, storage);
      mirrorToAddress(store, viewer);
      if (storage) keepWork({ store, viewer });
    },
  );
  if (address.has('effects') || address.has('crop'))
    void withCode(
      store,
      () => import('./effects/linked-effects.ts'),
      ({ followLinkedEffects }) => followLinkedEffects({ store, viewer }, address),
    );
  const settings = address.get('settings');
  if (settings !== null) {
    void withCode(
      store,
      () => import('./share/follow-settings.ts'),
      ({ followSettings }) => followSettings(settings, start.linked ?? {}, store, viewer),
    );
  }
  const asksForNothing = !start.scene && !start.addresses?.length;
  if (asksForNothing || hasOpenedFile()) void viewer.files.offer();
  show(<App store={store} viewer={viewer} poster={address.get('poster')} />);
}

function startOf(address: URLSearchParams, linked: LinkedStart | undefined): StartOptions {
  const keepAbove = address.get('keep');
  return {
    ...addressedScene(address),
    linked,
    keepAboveBytes: keepAbove === null ? undefined : Number(keepAbove),
  };
}

/**
 * Fetches code that the first picture does not need, once the whole scene is on the screen and the
 * page is idle.
 */
function fetchLateWhenIdle(store: ViewerStore): void {
  const unsubscribe = store.subscribe(({ imageId }) => {
    if (imageId === 0) return;
    unsubscribe();
    // Not all browsers have `requestIdleCallback`.
    if ('requestIdleCallback' in window) requestIdleCallback(() => void fetchLazy());
    else setTimeout(fetchLazy);
  });
}
