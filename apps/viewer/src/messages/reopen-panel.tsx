import { useStore } from 'zustand';
import type { ViewerStore } from '../state/store.ts';
import { Icon } from '../ui/icon.tsx';

/** Offers the file that was open before the page was loaded anew. */
export function ReopenPanel(props: { store: ViewerStore; onReopen: () => void; onForget: () => void }) {
  const { store, onReopen, onForget } = props;
  const lastFile = useStore(store, (state) => state.lastFile);
  if (!lastFile) return null;
  const { name, isReachable } = lastFile;
  return (
    <section className="panel reopen" aria-label="Last file" data-testid="reopen">
      <p>
        <b>{name}</b> was open before
      </p>
      <button type="button" className="text-button" data-testid="reopen-file" onClick={onReopen}>
        {isReachable ? 'Open again' : 'Choose it again'}
      </button>
      <button
        type="button"
        className="icon-button"
        aria-label={`Forget ${name}`}
        data-testid="forget-file"
        onClick={onForget}
      >
        <Icon name="close" />
      </button>
    </section>
  );
}
