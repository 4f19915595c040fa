import { useStore } from 'zustand';
import type { ViewerStore } from '../state/store.ts';
import { MessagePanel } from './message-panel.tsx';

/** What went wrong with the last file; the scene before it stays. */
export function ErrorPanel({ store }: { store: ViewerStore }) {
  const error = useStore(store, (state) => state.error);
  // The live region is always there: one that comes with its text is not read out everywhere.
  return (
    <div role="alert" className="message-slot">
      {error && (
        <MessagePanel kind="error" title={error.title} onDismiss={() => store.setState({ error: null })}>
          <p className="particulars" data-testid="error-message">
            {error.message}
          </p>
          {error.advice && <p>{error.advice}</p>}
          {error.links && (
            <ul className="links">
              {error.links.map(({ label, href }) => (
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
