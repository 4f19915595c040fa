import { memo } from 'react';
import { useStore } from 'zustand';
import type { PanelProps } from '../engine/panel-props.ts';
import type { AccuracyTab } from '../state/viewer-state.ts';
import { Dock } from '../ui/dock.tsx';
import { Tabs } from '../ui/tabs.tsx';
import type { AccuracyMeasurement } from './accuracy-measurement.ts';
import { AccuracySettingsForm } from './accuracy-settings.tsx';
import { AccuracyStatus } from './accuracy-status.tsx';
import { ComparisonForm } from './comparison-form.tsx';
import { DetailDial } from './detail-dial.tsx';
import { MeasureForm } from './measure-form.tsx';
import { PresetRows } from './preset-rows.tsx';

const TABS: Readonly<Record<AccuracyTab, string>> = {
  measure: 'Presets',
  compare: 'Compare',
  settings: 'Settings',
};

/** The accuracy of frames: presets and their costs, settings, and comparisons. */
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
            <DetailDial store={store} viewer={viewer} />
            <PresetRows store={store} viewer={viewer} />
          </>
        )}
        {tab === 'settings' && <AccuracySettingsForm store={store} viewer={viewer} />}
        {tab === 'compare' && <ComparisonForm store={store} viewer={viewer} />}
      </Tabs>
      <AccuracyStatus store={store} viewer={viewer} />
    </Dock>
  );
});
