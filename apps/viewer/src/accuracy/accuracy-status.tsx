import type { AccuracyTarget } from '@websplatter/core';
import { useStore } from 'zustand';
import type { PanelProps } from '../engine/panel-props.ts';
import { describeAccuracy, describeTarget } from '../ui/accuracy-words.ts';
import { TextButton } from '../ui/controls.tsx';

/**
 * In words: the settings that are drawn, the target that is kept, and what the GPU cannot do. It
 * lies below the forms, which would move under the hand that changes a setting.
 */
export function AccuracyStatus({ store, viewer }: PanelProps) {
  const accuracy = useStore(store, (state) => state.accuracy);
  const target = useStore(store, (state) => state.target);
  const choice = useStore(store, (state) => state.choice);
  const notices = useStore(store, (state) => state.accuracyNotices);
  return (
    <footer className="accuracy-status">
      {target && <KeptTarget store={store} viewer={viewer} target={target} />}
      <p className="accuracy-custom" data-testid="accuracy-custom">
        {target && 'Drawn with '}
        {describeAccuracy(accuracy)}
        {target && !choice && ' until this scene is measured'}
      </p>
      {notices.map((notice) => (
        <p key={notice} className="accuracy-notice">
          {notice}
        </p>
      ))}
    </footer>
  );
}

/** The target that is kept in every scene, and the button that ends it. */
function KeptTarget({ store, viewer, target }: PanelProps & { readonly target: AccuracyTarget }) {
  return (
    <p className="spread kept-target" data-testid="kept-target">
      <span role="status">
        Chosen automatically: <b>{describeTarget(target)}</b>
      </span>
      <TextButton
        look="plain"
        title="Stays with the settings that are drawn now"
        testId="end-target"
        onClick={() => viewer.setAccuracy(store.getState().accuracy)}
      >
        Stop
      </TextButton>
    </p>
  );
}
