import { useStore } from 'zustand';
import type { InspectTab } from '../state/inspecting.ts';
import type { ViewerStore } from '../state/store.ts';
import { Dock } from '../ui/dock.tsx';
import { Tabs } from '../ui/tabs.tsx';
import { CropTab } from './crop-tab.tsx';
import { DistanceTab } from './distance-tab.tsx';
import { HistogramTab } from './histogram-tab.tsx';
import type { InspectProps } from './inspection.ts';
import { SelectTab } from './select-tab.tsx';
import { SplatTab } from './splat-tab.tsx';

const TABS: Readonly<Record<InspectTab, string>> = {
  splat: 'Splat',
  distance: 'Distance',
  histogram: 'Histogram',
  select: 'Select',
  crop: 'Crop',
};

const CONTENTS = {
  splat: SplatTab,
  distance: DistanceTab,
  histogram: HistogramTab,
  select: SelectTab,
  crop: CropTab,
} as const;

/** Panel that inspects splats and histograms, measures distances, selects and crops. */
export function InspectPanel({ store, inspection }: InspectProps) {
  const tab = useStore(store, (state) => state.inspecting.tab);
  const problem = useStore(store, (state) => state.inspecting.problem);
  const Contents = CONTENTS[tab];
  const onTab = (next: InspectTab) =>
    store.setState(({ inspecting }) => ({ inspecting: { ...inspecting, tab: next, problem: null } }));
  return (
    <Dock store={store} name="inspect" title="Inspect, measure, edit">
      <Tabs label="Inspect" tabs={TABS} tab={tab} onTab={onTab} testId="inspect-tab">
        <Contents store={store} inspection={inspection} />
        <p className="inspect-problem" role="status" data-testid="inspect-problem">
          {problem}
        </p>
        <ReadingStatus store={store} />
      </Tabs>
    </Dock>
  );
}

/** Status of reading the file again: its original values are not on the GPU. */
function ReadingStatus({ store }: { store: ViewerStore }) {
  const reading = useStore(store, (state) => state.inspecting.reading);
  if (reading.kind === 'running') {
    return (
      <div className="inspect-reading" data-testid="inspect-reading">
        <p>Reading the scene again for its values</p>
        <progress aria-label="Reading the scene again" value={reading.part} max={1} />
      </div>
    );
  }
  if (reading.kind !== 'failed') return null;
  return (
    <p className="inspect-problem" role="alert">
      The scene cannot be read again. {reading.message}
    </p>
  );
}
