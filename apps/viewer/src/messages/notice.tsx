import { useEffect } from 'react';
import { useStore } from 'zustand';
import type { ViewerStore } from '../state/store.ts';

/** Long enough to read two sentences. */
const SHOWN_MS = 8000;

/** A sentence that disappears by itself. */
export function Notice({ store }: { store: ViewerStore }) {
  const notice = useStore(store, (state) => state.notice);
  // Before the first image there is something else to wait for.
  const isRead = useStore(store, ({ imageId, status }) => imageId > 0 || status === 'unavailable');
  useEffect(() => {
    if (notice === null || !isRead) return;
    const timer = setTimeout(() => store.setState({ notice: null }), SHOWN_MS);
    return () => clearTimeout(timer);
  }, [store, notice, isRead]);
  return (
    <div role="status" className="message-slot">
      {notice && (
        <p className="panel notice" data-testid="notice">
          {notice}
        </p>
      )}
    </div>
  );
}
