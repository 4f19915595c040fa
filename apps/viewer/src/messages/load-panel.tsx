import { useStore } from 'zustand';
import { formatBytes, formatBytesOf, formatSplats } from '../formatting/format.ts';
import type { LoadState } from '../state/scene-summary.ts';
import type { ViewerStore } from '../state/store.ts';
import { TextButton } from '../ui/controls.tsx';

const PHASES: Readonly<Record<LoadState['phase'], string>> = {
  make: 'Making',
  read: 'Reading',
  arrange: 'Arranging',
  keep: 'Arranging for streaming',
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

/** How far the page has come that has nothing but the picture. */
export function ThinProgress({ store }: { store: ViewerStore }) {
  const load = useStore(store, (state) => state.load);
  const isStarting = useStore(
    store,
    ({ status, scene, failure }) => status === 'starting' && !scene && !failure,
  );
  if (!load && !isStarting) return null;
  return (
    <progress
      className="thin-progress"
      aria-label={load ? `Opening ${load.title}` : 'Opening'}
      value={load ? partOf(load) : undefined}
      max={1}
      data-testid="thin-progress"
    />
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
  return (phase === 'read' || phase === 'keep') && totalBytes
    ? Math.min(1, loadedBytes / totalBytes)
    : undefined;
}

function figuresOf(state: LoadState): string {
  const { phase, loadedBytes, totalBytes, splats, bytesPerSecond } = state;
  return [
    loadedBytes > 0 && (totalBytes ? formatBytesOf(loadedBytes, totalBytes) : formatBytes(loadedBytes)),
    splats > 0 && formatSplats(splats),
    // Decoding goes on when all bytes are there.
    phase === 'read' &&
      bytesPerSecond > 0 &&
      loadedBytes !== totalBytes &&
      `${formatBytes(bytesPerSecond)}/s`,
  ]
    .filter(Boolean)
    .join(' · ');
}
