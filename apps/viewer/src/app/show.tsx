import { type ReactNode, StrictMode } from 'react';
import { createRoot, type Root } from 'react-dom/client';

let root: Root | null = null;

/** Replaces the current page. */
export function show(page: ReactNode): void {
  if (!root) {
    const element = document.getElementById('root');
    if (!element) throw new Error('The page has no #root.');
    root = createRoot(element);
  }
  root.render(<StrictMode>{page}</StrictMode>);
}
