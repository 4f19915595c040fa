import { App } from './app/app.tsx';
import { mirrorToDocument } from './app/document-mirror.ts';
import { fetchLateWhenIdle } from './app/fetch-lazy.ts';
import { followDrop } from './app/follow-drop.ts';
import { show } from './app/show.tsx';
import { addressedScene } from './engine/addressed-scene.ts';
import type { FileDropDecision } from './engine/file-drop.ts';
import { linkedStart } from './engine/linked-start.ts';
import { hasOpenedFile } from './engine/opened-file.ts';
import { type StartOptions, Viewer } from './engine/viewer.ts';
import { keepHud } from './hud/kept-hud.ts';
import { createViewerStore } from './state/store.ts';
import { followViewMode } from './view-modes/follow-view-mode.ts';

/**
 * Shows the viewer.
 *
 * @param address query of the page's address.
 * @param dropped files to show in place of the address's scene.
 */
export function showViewer(address: URLSearchParams, dropped?: FileDropDecision): void {
  const start = dropped ? {} : startOf(address);
  const store = createViewerStore();
  store.setState({ hasInterface: !address.has('noui') });
  mirrorToDocument(store, document);
  keepHud(store);
  fetchLateWhenIdle(store);
  const viewer = new Viewer(store, start);
  // This takes its time, and does not need the page.
  viewer.prepare();
  followViewMode(store, viewer);
  // Nothing is written before the first picture, which does not wait for this.
  void import('./share/follow-address.ts').then(({ keepStory, mirrorToAddress }) => {
    // The picture alone shows what its address says.
    const storage = address.has('noui') ? null : () => localStorage;
    keepStory({ store, viewer }, dropped ? new URLSearchParams() : address, storage);
    mirrorToAddress(store, viewer);
  });
  if ((address.has('effects') || address.has('crop')) && !dropped)
    void import('./effects/linked-effects.ts').then(({ followLinkedEffects }) =>
      followLinkedEffects({ store, viewer }, address),
    );
  const settings = address.get('settings');
  if (settings !== null && !dropped) {
    const isCameraLinked = start.linked?.camera != null;
    void import('./share/follow-settings.ts').then(({ followSettings }) =>
      followSettings(settings, isCameraLinked, store, viewer),
    );
  }
  const asksForNothing = !start.scene && !start.addresses?.length;
  if (dropped) followDrop(dropped, store, viewer);
  else if (asksForNothing || hasOpenedFile()) void viewer.files.offer();
  show(<App store={store} viewer={viewer} poster={address.get('poster')} />);
}

function startOf(address: URLSearchParams): StartOptions {
  const keepAbove = address.get('keep');
  return {
    ...addressedScene(address),
    accuracy: address.get('accuracy'),
    linked: linkedStart(address),
    keepAboveBytes: keepAbove === null ? undefined : Number(keepAbove),
  };
}
