// Part of the kit: package code that the page of an example needs.
import { setWorkerUrl } from '@websplatter/core';
import { SplatsErrorBoundary } from '@websplatter/react';
import { type ComponentType, StrictMode, Suspense } from 'react';
import { createRoot } from 'react-dom/client';

/** Reads files in the worker at `url`: modules from memory have no worker file beside them. */
export function hostWorker(url: string): void {
  setWorkerUrl(url);
}

/**
 * Renders `Component` on the whole page, or a message without WebGPU, for which it calls `onSaid`.
 */
export function mount(Component: ComponentType, onSaid: () => void): void {
  createRoot(
    document.body.appendChild(Object.assign(document.createElement('main'), { className: 'stage' })),
  ).render(
    <StrictMode>
      <SplatsErrorBoundary
        fallback={(error) => (
          <p ref={onSaid} className="unavailable" role="alert">
            {error.message}
          </p>
        )}
      >
        <Suspense>
          <Component />
        </Suspense>
      </SplatsErrorBoundary>
    </StrictMode>,
  );
}
