import { PageFailedPage } from '@websplatter/kit/page-failed-page';
import { show } from './app/show.tsx';
import { loadHardCases } from './engine/catalogue.ts';
import type { FileDropDecision } from './engine/file-drop.ts';

/** Shows the gallery of hard cases instead of the viewer. */
export async function showGallery(): Promise<void> {
  document.title = 'Hard cases · WebSplatter';
  try {
    const [{ HardCasePages }, cases] = await Promise.all([
      import('./hard-cases/hard-case-pages.tsx'),
      loadHardCases(),
    ]);
    show(<HardCasePages cases={cases} onOpen={(dropped) => void showDropped(dropped)} />);
  } catch (error) {
    console.error(error);
    show(<PageFailedPage />);
  }
}

/** Replaces the gallery by the viewer; the browser's Back returns to the gallery. */
async function showDropped(dropped: FileDropDecision): Promise<void> {
  const { showViewer } = await import('./viewer-page.tsx');
  history.pushState(null, '', location.pathname);
  addEventListener('popstate', () => location.reload(), { once: true });
  showViewer(new URLSearchParams(), dropped);
}
