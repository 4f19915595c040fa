// Fetches the viewer's code, or leads to pages that have moved to the lab.

import { makePageFailed } from '@websplatter/kit/page-failed';
import { applyTheme } from '@websplatter/kit/theme';
import { ADDRESS_NAMES } from './engine/link/addressed-scene.ts';
import { movedAddress } from './engine/link/lab-address.ts';
import './styles.css';

const query = new URLSearchParams(location.search);

/** Query parameters that name a scene, and say nothing about its picture. */
const OF_SCENES: readonly string[] = [...ADDRESS_NAMES, 'scene'];

async function showPage(): Promise<void> {
  const moved = movedAddress(query);
  if (moved) return location.replace(moved);
  // At the same time; an address that only names a scene needs none of it.
  const linking = [...query.keys()].every((name) => OF_SCENES.includes(name))
    ? null
    : import('./engine/link/linked-start.ts');
  // Together, so that a failure of either is caught.
  const [{ showViewer }, linked] = await Promise.all([import('./viewer-page.tsx'), linking]);
  showViewer(query, linked?.linkedStart(query));
}

applyTheme();
showPage().catch((error) => {
  console.error(error);
  document.documentElement.dataset.state = 'unavailable';
  document.body.replaceChildren(makePageFailed());
});
