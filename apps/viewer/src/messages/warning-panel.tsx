import { useStore } from 'zustand';
import type { ViewerStore } from '../state/store.ts';
import { MessagePanel } from './message-panel.tsx';

/** The problem of the scene that is shown. */
export function WarningPanel({ store }: { store: ViewerStore }) {
  const warning = useStore(store, (state) => state.warning);
  return (
    <div role="status" className="message-slot">
      {warning && (
        <MessagePanel
          kind="warning"
          title={warning.title}
          onDismiss={() => store.setState({ warning: null })}
        >
          <p className="particulars">{warning.message}</p>
        </MessagePanel>
      )}
    </div>
  );
}
