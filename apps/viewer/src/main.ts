// Fetches only the code of the page that the URL asks for.

import { applyTheme } from '@websplatter/kit/theme';
import { asksForGallery } from './engine/addressed-scene.ts';
import { movedAddress } from './engine/lab-address.ts';
import './styles.css';

const query = new URLSearchParams(location.search);

async function showPage(): Promise<void> {
  const moved = movedAddress(query);
  if (moved) location.replace(moved);
  else if (asksForGallery(query)) {
    const { showGallery } = await import('./gallery-page.tsx');
    await showGallery();
  } else {
    const { showViewer } = await import('./viewer-page.tsx');
    showViewer(query);
  }
}

applyTheme();
showPage().catch((error) => {
  console.error(error);
  document.body.textContent = 'This page could not be loaded. Check the connection, then reload it.';
});
