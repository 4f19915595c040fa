// The address chooses the page and options: `?gallery`, `?conformance`, `?bench` or `?peers`; else the
// index.
import { makePageFailed } from '@websplatter/kit/page-failed';
import { applyTheme } from '@websplatter/kit/theme';
import { createRoot } from 'react-dom/client';
import { PAGES, type PageName } from './page.tsx';

const LOADERS: Readonly<Record<PageName, () => Promise<{ default: React.FC<{ query: URLSearchParams }> }>>> =
  {
    gallery: () => import('./gallery/gallery-page.tsx'),
    conformance: () => import('./conformance/conformance-page.tsx'),
    bench: () => import('./benchmark/benchmark-page.tsx'),
    peers: () => import('./peers/peers-page.tsx'),
  };

applyTheme();
const query = new URLSearchParams(location.search);
const page = PAGES.find(({ name }) => query.has(name));
if (page) document.title = `${page.title} · WebSplatter lab`;
const element = document.getElementById('root')!;
const root = createRoot(element);
try {
  const { default: Page } = await (page ? LOADERS[page.name]() : import('./overview-page.tsx'));
  root.render(<Page query={query} />);
} catch (error) {
  console.error(error);
  root.unmount();
  element.replaceChildren(makePageFailed());
}
