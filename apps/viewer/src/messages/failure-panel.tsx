import { useStore } from 'zustand';
import type { ViewerStore } from '../state/store.ts';
import { MessagePanel } from './message-panel.tsx';

/** Why the last scene failed to open; the scene before it stays. */
export function FailurePanel({ store }: { store: ViewerStore }) {
  const failure = useStore(store, (state) => state.failure);
  // The live region is always there: some screen readers ignore one that comes with its text.
  return (
    <div role="alert" className="message-slot">
      {failure && (
        <MessagePanel kind="error" title={failure.title} onDismiss={() => store.setState({ failure: null })}>
          <p className="particulars" data-testid="error-message">
            {failure.message}
          </p>
          {failure.advice && <p>{failure.advice}</p>}
          {failure.details && (
            <details className="explained">
              <summary>Details</summary>
              <p className="particulars" data-testid="error-details">
                {failure.details}
              </p>
            </details>
          )}
          {failure.links && (
            <ul className="links">
              {failure.links.map(({ label, href }) => (
                <li key={href}>
                  <a href={href}>{label}</a>
                </li>
              ))}
            </ul>
          )}
        </MessagePanel>
      )}
    </div>
  );
}
