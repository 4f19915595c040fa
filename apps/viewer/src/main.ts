// Fetches the code of the page that the address asks for, and of no other.
import { asksForGallery } from './scene/addressed-scene.ts';
import './styles.css';

const query = new URLSearchParams(location.search);

async function showPage(): Promise<void> {
  if (query.has('bench') || query.has('conformance') || asksForGallery(query)) {
    const { showLonePage } = await import('./lone-pages.tsx');
    await showLonePage(query);
  } else {
    const { showViewer } = await import('./viewer-page.tsx');
    showViewer(query);
  }
}

showPage().catch((error) => {
  console.error(error);
  document.body.textContent = 'This page could not be loaded. Check the connection, then reload it.';
});
