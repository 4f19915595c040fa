import type { ReactNode } from 'react';

/**
 * A page in place of the viewer, with code of its own, that the address asks for: the benchmark (`?bench`) and the hard cases
 * run on this device (`?conformance`). Null where it asks for the viewer.
 */
export function lonePage(query: URLSearchParams): (() => Promise<ReactNode>) | null {
  if (query.has('bench')) {
    return async () => {
      document.title = 'Benchmark · WebSplatter';
      const { BenchPage } = await import('../bench/bench-page.tsx');
      return <BenchPage query={query} />;
    };
  }
  if (query.has('conformance')) {
    return async () => {
      document.title = 'Conformance · WebSplatter';
      const { ConformancePage } = await import('../conformance/conformance-page.tsx');
      return <ConformancePage query={query} />;
    };
  }
  return null;
}
