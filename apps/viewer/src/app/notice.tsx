import { useEffect, useState } from 'react';
import { useStore } from 'zustand';
import type { RunCommand } from '../state/command-list.ts';
import type { ViewerStore } from '../state/store.ts';

/** Long enough to read two sentences, ms. */
const SHOWN_MS = 8000;

/** A message that disappears by itself, unless the user is about to use its button. */
export function Notice({ store, run }: { store: ViewerStore; run: RunCommand }) {
  const notice = useStore(store, (state) => state.notice);
  // Before the first image, the loading panel has the user's attention.
  const isRead = useStore(store, ({ imageId, status }) => imageId > 0 || status === 'unavailable');
  const [isHeld, setHeld] = useState(false);
  useEffect(() => {
    if (notice === null || !isRead || isHeld) return;
    const timer = setTimeout(() => store.setState({ notice: null }), SHOWN_MS);
    return () => clearTimeout(timer);
  }, [store, notice, isRead, isHeld]);
  const { text, offers } = typeof notice === 'object' && notice ? notice : { text: notice, offers: [] };
  if (!text) return null;
  return (
    <div className="panel notice" data-testid="notice">
      <p>{text}</p>
      {offers.map(({ label, command }) => (
        <button
          key={command}
          type="button"
          className="chip"
          data-testid={`offer-${command}`}
          onPointerEnter={() => setHeld(true)}
          onPointerLeave={() => setHeld(false)}
          onFocus={() => setHeld(true)}
          onBlur={() => setHeld(false)}
          onClick={() => {
            store.setState({ notice: null });
            run(command);
          }}
        >
          {label}
        </button>
      ))}
    </div>
  );
}
