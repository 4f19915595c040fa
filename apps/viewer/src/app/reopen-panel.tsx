import { IconButton, TextButton } from '@websplatter/kit/controls';
import { useStore } from 'zustand';
import type { ViewerStore } from '../state/store.ts';

/** Offers to reopen the file that was open before the page was reloaded. */
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
      <TextButton look="plain" testId="reopen-file" onClick={onReopen}>
        {isReachable ? 'Open again' : 'Choose it again'}
      </TextButton>
      <IconButton icon="close" label={`Forget ${name}`} testId="forget-file" onClick={onForget} />
    </section>
  );
}
