import { useEffect } from 'react';
import { useStore } from 'zustand';
import { followStreams } from '../engine/follow-streams.ts';
import type { PanelProps } from '../engine/panel-props.ts';
import './stream-panel.css';

/** Says that parts of the scene could not be fetched; what is there stays. */
export function StreamPanel({ store, viewer }: PanelProps) {
  const error = useStore(store, (state) => state.streaming?.error);
  useEffect(() => followStreams(store, () => viewer.engine), [store, viewer]);
  const retry = () => {
    for (const { stream } of viewer.engine?.clouds ?? []) stream?.retry();
  };
  return (
    <div role="status" className="message-slot">
      {error && (
        <section className="panel notice stream-panel" data-testid="stream-error">
          <p title={error.message}>Parts of the scene could not be fetched.</p>
          <button type="button" className="chip" onClick={retry}>
            Try again
          </button>
        </section>
      )}
    </div>
  );
}
