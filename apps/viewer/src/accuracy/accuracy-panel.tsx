import { type KeyboardEvent, memo, useId, useRef } from 'react';
import { useStore } from 'zustand';
import { ComparisonForm } from '../comparison/comparison-form.tsx';
import type { AccuracySweep } from '../measurement/accuracy-measurement.ts';
import { MeasureForm } from '../measurement/measure-form.tsx';
import { ACCURACY_TABS, type AccuracyTab, type ViewerStore } from '../state/store.ts';
import { Dock } from '../ui/dock.tsx';
import type { Viewer } from '../viewer/viewer.ts';
import { AccuracyPresets, AccuracySettingsForm } from './accuracy-settings.tsx';

const TAB_LABELS: Readonly<Record<AccuracyTab, string>> = {
  measure: 'Measure',
  compare: 'Compare',
  settings: 'Settings',
};

/** What pictures are drawn with, and what that means. */
export const AccuracyPanel = memo(function AccuracyPanel({
  store,
  viewer,
  sweep,
}: {
  store: ViewerStore;
  viewer: Viewer;
  sweep: AccuracySweep;
}) {
  const isVisible = useStore(store, (state) => state.dock === 'accuracy');
  const tab = useStore(store, (state) => state.accuracyTab);
  const id = useId();
  if (!isVisible) return null;
  return (
    <Dock store={store} name="accuracy" title="Accuracy">
      <AccuracyPresets store={store} viewer={viewer} />
      <Tabs id={id} tab={tab} onTab={(accuracyTab) => store.setState({ accuracyTab })} />
      <div
        className="dock-body"
        id={`${id}-body`}
        role="tabpanel"
        aria-labelledby={`${id}-${tab}`}
        // biome-ignore lint/a11y/noNoninteractiveTabindex: it scrolls, so keys must reach it.
        tabIndex={0}
      >
        {tab === 'measure' && <MeasureForm store={store} viewer={viewer} sweep={sweep} />}
        {tab === 'settings' && <AccuracySettingsForm store={store} viewer={viewer} />}
        {tab === 'compare' && <ComparisonForm store={store} viewer={viewer} />}
      </div>
    </Dock>
  );
});

/** One tab is in the order of the Tab key; arrows go to the others. */
function Tabs({ id, tab, onTab }: { id: string; tab: AccuracyTab; onTab: (tab: AccuracyTab) => void }) {
  const list = useRef<HTMLDivElement>(null);
  const onKeyDown = (event: KeyboardEvent) => {
    const by = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    if (!by) return;
    event.preventDefault();
    // Arrows elsewhere turn the scene.
    event.stopPropagation();
    const count = ACCURACY_TABS.length;
    const next = (ACCURACY_TABS.indexOf(tab) + by + count) % count;
    onTab(ACCURACY_TABS[next]);
    list.current?.querySelectorAll('button')[next].focus();
  };
  return (
    <div ref={list} className="tabs" role="tablist" aria-label="Accuracy" onKeyDown={onKeyDown}>
      {ACCURACY_TABS.map((name) => (
        <button
          key={name}
          type="button"
          role="tab"
          id={`${id}-${name}`}
          aria-selected={name === tab}
          aria-controls={`${id}-body`}
          tabIndex={name === tab ? 0 : -1}
          data-testid={`accuracy-tab-${name}`}
          onClick={() => onTab(name)}
        >
          {TAB_LABELS[name]}
        </button>
      ))}
    </div>
  );
}
