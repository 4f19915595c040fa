import { type ReactNode, StrictMode } from 'react';
import { createRoot } from 'react-dom/client';
import { GALLERY_SCENE, loadHardCases } from './hard-cases/catalogue.ts';
import { GalleryFailedPage } from './messages/status-pages.tsx';
import { mirrorToAddress } from './shell/address-mirror.ts';
import { App } from './shell/app.tsx';
import { mirrorToDocument } from './shell/document-mirror.ts';
import { createViewerStore } from './state/store.ts';
import './styles.css';
import { Viewer } from './viewer/viewer.ts';

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
  const [{ Gallery }, cases] = await Promise.all([import('./hard-cases/gallery.tsx'), loadHardCases()]);
  show(<Gallery cases={cases} firstQuery={address.get('q') ?? ''} />);
  document.documentElement.dataset.state = 'ready';
}
