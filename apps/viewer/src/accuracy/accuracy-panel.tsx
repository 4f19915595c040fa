import type { AccuracyTarget } from '@websplatter/core';
import { TextButton } from '@websplatter/kit/controls';
import { memo } from 'react';
import { useStore } from 'zustand';
import { setAccuracy } from '../engine/edit-picture.ts';
import type { PanelProps } from '../engine/viewer.ts';
import type { AccuracyTab } from '../state/accuracy.ts';
import { describeAccuracy, describeTarget } from '../ui/accuracy-words.ts';
import { Dock } from '../ui/dock.tsx';
import { Tabs } from '../ui/tabs.tsx';
import { AccuracySettingsForm, DetailDial } from './accuracy-settings.tsx';
import { ComparisonForm } from './compared-pictures.tsx';
import { MeasureForm } from './measure-form.tsx';
import type { AccuracyMeasurement } from './measure-presets.ts';
import { PresetRows } from './preset-rows.tsx';

const TABS: Readonly<Record<AccuracyTab, string>> = {
  measure: 'Presets',
  compare: 'Compare',
  settings: 'Settings',
};

/** Panel for the accuracy of frames: presets and their costs, settings, and comparisons. */
export const AccuracyPanel = memo(function AccuracyPanel({
  store,
  viewer,
  accuracyMeasurement,
}: PanelProps & { readonly accuracyMeasurement: AccuracyMeasurement }) {
  const tab = useStore(store, (state) => state.accuracyTab);
  return (
    <Dock store={store} name="accuracy">
      <Tabs
        label="Accuracy"
        tabs={TABS}
        tab={tab}
        onTab={(accuracyTab) => store.setState({ accuracyTab })}
        testId="accuracy-tab"
      >
        {tab === 'measure' && (
          <MeasureForm store={store} viewer={viewer} accuracyMeasurement={accuracyMeasurement} />
        )}
        {tab !== 'measure' && (
          <>
            <h3>{tab === 'compare' ? 'The picture is drawn with' : 'Preset'}</h3>
            <PresetRows store={store} viewer={viewer} />
            <DetailDial store={store} viewer={viewer} />
          </>
        )}
        {tab === 'settings' && <AccuracySettingsForm store={store} viewer={viewer} />}
        {tab === 'compare' && <ComparisonForm store={store} viewer={viewer} />}
      </Tabs>
      <AccuracyStatus store={store} viewer={viewer} />
    </Dock>
  );
});

/**
 * Text about the drawn settings, the active target, and the GPU's limits. It is below the forms,
 * because its height changes with the settings.
 */
function AccuracyStatus({ store, viewer }: PanelProps) {
  const accuracy = useStore(store, (state) => state.accuracy);
  const target = useStore(store, (state) => state.target);
  const choice = useStore(store, (state) => state.choice);
  const notices = useStore(store, (state) => state.accuracyNotices);
  return (
    <footer className="accuracy-status">
      {target && <KeptTarget store={store} viewer={viewer} target={target} />}
      <p className="accuracy-custom" data-testid="accuracy-custom">
        {target ? 'Drawn with ' : 'Shown: '}
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

/** The target that applies to every scene, and the button that ends it. */
function KeptTarget({ store, viewer, target }: PanelProps & { readonly target: AccuracyTarget }) {
  return (
    <p className="spread kept-target" data-testid="kept-target">
      <span role="status">
        Chosen automatically: <b>{describeTarget(target)}</b>
      </span>
      <TextButton
        look="plain"
        title="Keep the settings that are drawn now"
        testId="end-target"
        onClick={() => setAccuracy({ store, viewer }, store.getState().accuracy)}
      >
        Stop
      </TextButton>
    </p>
  );
}
