import { useStore } from 'zustand';
import { Icon } from './icon.tsx';
import type { ViewerStore } from './store.ts';

/** What went wrong with the last file; the scene before it stays. */
export function ErrorPanel({ store }: { store: ViewerStore }) {
  const error = useStore(store, (state) => state.error);
  // The live region is always there: one that comes with its text is not read out everywhere.
  return (
    <div role="alert" className="message-slot">
      {error && (
        <section className="panel message error" data-testid="error">
          <Icon name="warning" />
          <div className="message-text">
            <h2>{error.title}</h2>
            <p className="particulars" data-testid="error-message">
              {error.message}
            </p>
            {error.advice && <p>{error.advice}</p>}
          </div>
          <button
            type="button"
            className="icon-button"
            aria-label="Dismiss the error"
            data-testid="dismiss-error"
            onClick={() => store.setState({ error: null })}
          >
            <Icon name="close" />
          </button>
        </section>
      )}
    </div>
  );
}
