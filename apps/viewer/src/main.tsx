import { StrictMode } from 'react';
import { createRoot } from 'react-dom/client';
import { App } from './app.tsx';
import { createViewerStore, mirrorToDocument } from './store.ts';
import './viewer.css';
import { Viewer } from './viewer.ts';

const store = createViewerStore();
mirrorToDocument(store, document);
const address = new URLSearchParams(location.search);
const viewer = new Viewer(store, { file: address.get('file'), scene: address.get('scene') });

const root = document.getElementById('root');
if (!root) throw new Error('The page has no #root.');
createRoot(root).render(
  <StrictMode>
    <App store={store} viewer={viewer} />
  </StrictMode>,
);
