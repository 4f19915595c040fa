import { type ReactNode, StrictMode } from 'react';
import { createRoot } from 'react-dom/client';
import { App } from './app.tsx';
import { GALLERY_SCENE, loadHardCases } from './hard-catalogue.ts';
import { GalleryFailedPage } from './status-pages.tsx';
import { createViewerStore, mirrorToAddress, mirrorToDocument } from './store.ts';
import './viewer.css';
import './dock.css';
import './accuracy.css';
import './effects.css';
import { Viewer } from './viewer.ts';

const element = document.getElementById('root');
if (!element) throw new Error('The page has no #root.');
const root = createRoot(element);
const show = (page: ReactNode) => root.render(<StrictMode>{page}</StrictMode>);

const address = new URLSearchParams(location.search);
const file = address.get('file');
const scene = address.get('scene');
if (scene === GALLERY_SCENE && !file) {
  showGallery().catch((error) => {
    console.error(error);
    show(<GalleryFailedPage />);
  });
} else {
  const store = createViewerStore();
  mirrorToDocument(store, document);
  const viewer = new Viewer(store, { file, scene, accuracy: address.get('accuracy') });
  mirrorToAddress(store);
  show(<App store={store} viewer={viewer} />);
}

async function showGallery(): Promise<void> {
  document.title = 'Hard cases · WebSplatter';
  const [{ Gallery }, cases] = await Promise.all([import('./gallery.tsx'), loadHardCases()]);
  show(<Gallery cases={cases} firstQuery={address.get('q') ?? ''} />);
  document.documentElement.dataset.state = 'ready';
}
