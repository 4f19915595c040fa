// Fetches the viewer's code, or leads to pages that have moved to the lab.

import { applyTheme } from '@websplatter/kit/theme';
import { movedAddress } from './engine/lab-address.ts';
import './styles.css';

const query = new URLSearchParams(location.search);

async function showPage(): Promise<void> {
  const moved = movedAddress(query);
  if (moved) return location.replace(moved);
  const { showViewer } = await import('./viewer-page.tsx');
  showViewer(query);
}

applyTheme();
showPage().catch((error) => {
  console.error(error);
  document.body.textContent = 'This page could not be loaded. Check the connection, then reload it.';
});
