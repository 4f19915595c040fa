import type { AccuracyWish } from '@websplatter/core';
import { useStore } from 'zustand';
import { describeAccuracy, describeWish } from '../formatting/accuracy-words.ts';
import type { PanelProps } from '../viewer/panel-props.ts';

/**
 * In words: the settings that are drawn, the wish that is kept, and what the GPU cannot do. It lies below the forms, which
 * would move under the hand that changes a setting.
 */
export function AccuracyStatus({ store, viewer }: PanelProps) {
  const accuracy = useStore(store, (state) => state.accuracy);
  const wish = useStore(store, (state) => state.wish);
  const choice = useStore(store, (state) => state.choice);
  const notices = useStore(store, (state) => state.accuracyNotices);
  return (
    <footer className="accuracy-status">
      {wish && <KeptWish store={store} viewer={viewer} wish={wish} />}
      <p className="accuracy-custom" data-testid="accuracy-custom">
        {wish && 'Drawn with '}
        {describeAccuracy(accuracy)}
        {wish && !choice && ' until this scene is measured'}
      </p>
      {notices.map((notice) => (
        <p key={notice} className="accuracy-notice">
          {notice}
        </p>
      ))}
    </footer>
  );
}

/** The wish that is kept in every scene, and the button that ends it. */
function KeptWish({ store, viewer, wish }: PanelProps & { readonly wish: AccuracyWish }) {
  return (
    <p className="kept-wish" data-testid="kept-wish">
      <span role="status">
        Keeps: <b>{describeWish(wish)}</b>
      </span>
      <button
        type="button"
        className="text-button"
        title="Keeps the settings that are drawn now"
        data-testid="end-wish"
        onClick={() => viewer.setAccuracy(store.getState().accuracy)}
      >
        End
      </button>
    </p>
  );
}
