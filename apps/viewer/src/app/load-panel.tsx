import { TextButton } from '@websplatter/kit/controls';
import { formatBytes, formatBytesOf, formatSplats } from '@websplatter/kit/format';
import { useStore } from 'zustand';
import type { LoadState } from '../state/scene.ts';
import type { ViewerStore } from '../state/store.ts';

const PHASES: Readonly<Record<LoadState['phase'], string>> = {
  make: 'Making',
  read: 'Reading',
  arrange: 'Arranging',
  keep: 'Arranging for streaming',
  upload: 'Uploading to the GPU',
};

/** Progress bar of a page that has only the picture. */
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

/** Progress of loading a scene, or of its preparation for another accuracy. */
export function LoadPanel({
  store,
  name,
  onCancel,
}: {
  readonly store: ViewerStore;
  readonly name: 'load' | 'preparing';
  readonly onCancel: () => void;
}) {
  const state = useStore(store, (all) => all[name]);
  if (!state) return null;
  const { title, phase } = state;
  const label = name === 'load' ? `Opening ${title}` : `Preparing ${title} for another accuracy`;
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

/** Progress of the phase, 0…1; undefined if unknown. */
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
    // Decoding continues after all bytes have arrived.
    phase === 'read' &&
      bytesPerSecond > 0 &&
      loadedBytes !== totalBytes &&
      `${formatBytes(bytesPerSecond)}/s`,
  ]
    .filter(Boolean)
    .join(' · ');
}
