import { type KeyboardEvent, useRef } from 'react';
import { ACCURACY_TABS, type AccuracyTab } from '../state/viewer-state.ts';

const TAB_LABELS: Readonly<Record<AccuracyTab, string>> = {
  measure: 'Measure',
  compare: 'Compare',
  settings: 'Settings',
};

/** The Tab key stops at the chosen tab only; arrow keys go to the others. */
export function AccuracyTabs({
  id,
  tab,
  onTab,
}: {
  id: string;
  tab: AccuracyTab;
  onTab: (tab: AccuracyTab) => void;
}) {
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
