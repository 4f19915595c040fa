import type { ReactNode } from 'react';
import type { FileDropDecision } from './file-drop/file-drop.ts';
import { loadHardCases } from './hard-cases/catalogue.ts';
import { PageFailedPage } from './messages/page-failed-page.tsx';
import { show } from './shell/show.tsx';

/**
 * Shows the page in place of the viewer that the address asks for: the benchmark (`?bench`), the hard cases run on this device
 * (`?conformance`), or their gallery.
 */
export async function showLonePage(query: URLSearchParams): Promise<void> {
  const page = query.has('bench') ? benchPage : query.has('conformance') ? conformancePage : galleryPage;
  try {
    show(await page(query));
  } catch (error) {
    console.error(error);
    show(<PageFailedPage />);
  }
}

async function benchPage(query: URLSearchParams): Promise<ReactNode> {
  document.title = 'Benchmark · WebSplatter';
  const { BenchPage } = await import('./bench/bench-page.tsx');
  return <BenchPage query={query} />;
}

async function conformancePage(query: URLSearchParams): Promise<ReactNode> {
  document.title = 'Conformance · WebSplatter';
  const { ConformancePage } = await import('./conformance/conformance-page.tsx');
  return <ConformancePage query={query} />;
}

async function galleryPage(): Promise<ReactNode> {
  document.title = 'Hard cases · WebSplatter';
  const [{ HardCasePages }, cases] = await Promise.all([
    import('./hard-cases/hard-case-pages.tsx'),
    loadHardCases(),
  ]);
  return <HardCasePages cases={cases} onOpen={(dropped) => void showDropped(dropped)} />;
}

/** In place of the gallery, which is one step back in the browser's history. */
async function showDropped(dropped: FileDropDecision): Promise<void> {
  const { showViewer } = await import('./viewer-page.tsx');
  history.pushState(null, '', location.pathname);
  addEventListener('popstate', () => location.reload(), { once: true });
  showViewer(new URLSearchParams(), dropped);
}
