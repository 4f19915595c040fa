// The address chooses the page and options: `?conformance`, `?bench` or `?peers`; else the index.
import { createRoot } from 'react-dom/client';
import { PAGES, type PageName } from './page.tsx';

const LOADERS: Readonly<Record<PageName, () => Promise<{ default: React.FC<{ query: URLSearchParams }> }>>> =
  {
    conformance: () => import('./conformance/conformance-page.tsx'),
    bench: () => import('./benchmark/benchmark-page.tsx'),
    peers: () => import('./peers/peers-page.tsx'),
  };

const query = new URLSearchParams(location.search);
const page = PAGES.find(({ name }) => query.has(name));
if (page) document.title = `${page.title} · WebSplatter lab`;
const { default: Page } = await (page ? LOADERS[page.name]() : import('./overview-page.tsx'));
createRoot(document.getElementById('root')!).render(<Page query={query} />);
