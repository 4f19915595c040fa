import { useStore } from 'zustand';
import { formatBytes, formatSplats } from '../formatting/format.ts';
import type { LoadState } from '../state/scene-summary.ts';
import type { ViewerStore } from '../state/store.ts';
import { TextButton } from '../ui/controls.tsx';

const PHASES: Readonly<Record<LoadState['phase'], string>> = {
  make: 'Making',
  read: 'Reading',
  arrange: 'Arranging',
  upload: 'Uploading to the GPU',
};

interface PanelOptions {
  readonly store: ViewerStore;
  readonly onCancel: () => void;
}

/** How far the loading of a scene has come. */
export function LoadPanel({ store, onCancel }: PanelOptions) {
  const load = useStore(store, (state) => state.load);
  return (
    load && <ProgressPanel name="load" label={`Opening ${load.title}`} state={load} onCancel={onCancel} />
  );
}

/** Progress towards drawing the scene with another accuracy, if that takes a while. */
export function PreparingPanel({ store, onCancel }: PanelOptions) {
  const preparing = useStore(store, (state) => state.preparing);
  if (!preparing) return null;
  const label = `Preparing ${preparing.title} for another accuracy`;
  return <ProgressPanel name="preparing" label={label} state={preparing} onCancel={onCancel} />;
}

function ProgressPanel({
  name,
  label,
  state,
  onCancel,
}: {
  name: 'load' | 'preparing';
  label: string;
  state: LoadState;
  onCancel: () => void;
}) {
  const { title, phase } = state;
  return (
    <section className={`panel load ${name}`} data-testid={name} aria-label={label}>
      <div className="spread">
        <strong className="load-title">{title}</strong>
        <TextButton look="plain" testId={`cancel-${name}`} onClick={onCancel}>
          Cancel
        </TextButton>
      </div>
      {/* Without a value the bar is indeterminate: the phase's length is not known. */}
      <progress aria-label={`${PHASES[phase]} ${title}`} value={partOf(state)} max={1} />
      <div className="spread figures">
        <span data-testid={`${name}-phase`}>{PHASES[phase]}</span>
        <span data-testid={`${name}-figures`}>{figuresOf(state)}</span>
      </div>
    </section>
  );
}

/** How much of the phase is done, 0…1; undefined where that is not known. */
function partOf({ phase, loadedBytes, totalBytes }: LoadState): number | undefined {
  return phase === 'read' && totalBytes ? Math.min(1, loadedBytes / totalBytes) : undefined;
}

function figuresOf(state: LoadState): string {
  const { phase, loadedBytes, totalBytes, splats, bytesPerSecond } = state;
  return [
    loadedBytes > 0 &&
      (totalBytes ? `${formatBytes(loadedBytes)} of ${formatBytes(totalBytes)}` : formatBytes(loadedBytes)),
    splats > 0 && formatSplats(splats),
    phase === 'read' && bytesPerSecond > 0 && `${formatBytes(bytesPerSecond)}/s`,
  ]
    .filter(Boolean)
    .join(' · ');
}
