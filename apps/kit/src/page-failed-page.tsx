import { TextButton } from './controls.tsx';

/** Shown instead of a page whose code could not be loaded. */
export function PageFailedPage() {
  return (
    <main className="status-page" data-testid="page-failed">
      <h1>This page could not be loaded</h1>
      <p role="alert">Check the connection. The browser’s console has details.</p>
      <p className="actions">
        <TextButton look="primary" onClick={() => location.reload()}>
          Try again
        </TextButton>
      </p>
    </main>
  );
}
