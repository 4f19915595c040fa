import { type ReactNode, StrictMode } from 'react';
import { createRoot } from 'react-dom/client';
import type { FileDropDecision } from './file-drop/file-drop.ts';
import { followDrop, hasOpenedFile } from './file-drop/follow-drop.ts';
import { GALLERY_SCENE, loadHardCases } from './hard-cases/catalogue.ts';
import { keepHud } from './hud/kept-hud.ts';
import { linkedStart } from './links/linked-start.ts';
import { addressedScene, foreseeFirst } from './scene/first-source.ts';
import { App } from './shell/app.tsx';
import { mirrorToDocument } from './shell/document-mirror.ts';
import { fetchLateWhenIdle } from './shell/fetch-late.ts';
import { lonePage } from './shell/lone-page.tsx';
import { createViewerStore } from './state/store.ts';
import './styles.css';
import { followViewMode } from './view-modes/follow-view-mode.ts';
import { type StartOptions, Viewer } from './viewer/viewer.ts';

const element = document.getElementById('root');
if (!element) throw new Error('The page has no #root.');
const root = createRoot(element);
const show = (page: ReactNode) => root.render(<StrictMode>{page}</StrictMode>);

const address = new URLSearchParams(location.search);
const addressed = addressedScene(address);
const isGallery = addressed.scene === GALLERY_SCENE && addressed.addresses?.length === 0;
const page = lonePage(address) ?? (isGallery ? galleryPage : null);
if (page) {
  page().then(show, async (error) => {
    console.error(error);
    const { PageFailedPage } = await import('./messages/status-pages.tsx');
    show(<PageFailedPage />);
  });
} else {
  showViewer({ ...addressed, accuracy: address.get('accuracy'), linked: linkedStart(address) });
}

function showViewer(start: StartOptions, dropped?: FileDropDecision): void {
  const store = createViewerStore();
  store.setState({ hasInterface: !address.has('noui') });
  mirrorToDocument(store, document);
  keepHud(store);
  fetchLateWhenIdle(store);
  const viewer = new Viewer(store, start);
  // Both take their time, and need neither each other nor the page.
  viewer.prepare();
  if (!dropped) foreseeFirst(start, location.href);
  followViewMode(store, viewer);
  // Nothing is written before the first picture, which does not wait for this.
  void import('./links/address-mirror.ts').then(({ mirrorToAddress }) => mirrorToAddress(store, viewer));
  if ((address.has('effects') || address.has('crop')) && !dropped)
    void import('./links/linked-effects.ts').then(({ followLinkedEffects }) =>
      followLinkedEffects({ store, viewer }, address),
    );
  const settings = address.get('settings');
  if (settings !== null && !dropped) {
    const isCameraLinked = start.linked?.camera != null;
    void import('./supersplat/follow-settings.ts').then(({ followSettings }) =>
      followSettings(settings, isCameraLinked, store, viewer),
    );
  }
  const asksForNothing = !start.scene && !start.addresses?.length;
  if (dropped) followDrop(dropped, store, viewer);
  else if (asksForNothing || hasOpenedFile()) void viewer.files.offer();
  show(<App store={store} viewer={viewer} poster={address.get('poster')} />);
}

/** In place of the gallery, which is one step back in the browser's history. */
function showDropped(dropped: FileDropDecision): void {
  history.pushState(null, '', location.pathname);
  addEventListener('popstate', () => location.reload(), { once: true });
  showViewer({}, dropped);
}

async function galleryPage(): Promise<ReactNode> {
  document.title = 'Hard cases · WebSplatter';
  const [{ HardCasePages }, cases] = await Promise.all([
    import('./hard-cases/hard-case-pages.tsx'),
    loadHardCases(),
  ]);
  return <HardCasePages cases={cases} onOpen={showDropped} />;
}
