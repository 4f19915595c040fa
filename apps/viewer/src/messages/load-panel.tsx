import { useStore } from 'zustand';
import type { LoadState } from '../state/scene-summary.ts';
import type { ViewerStore } from '../state/store.ts';
import { formatBytes, formatSplats } from '../words/format.ts';

const PHASES: Readonly<Record<LoadState['phase'], string>> = {
  make: 'Making',
  read: 'Reading',
  arrange: 'Arranging',
  palette: 'Finding a palette of harmonics',
  upload: 'Uploading to the GPU',
};

/** How far the loading of a scene has come. */
export function LoadPanel({ store, onCancel }: { store: ViewerStore; onCancel: () => void }) {
  const load = useStore(store, (state) => state.load);
  if (!load) return null;
  const { title, phase, loadedBytes, totalBytes, splats, bytesPerSecond } = load;
  const part = phase === 'read' && totalBytes ? Math.min(1, loadedBytes / totalBytes) : undefined;
  return (
    <section className="panel load" data-testid="load" aria-label={`Opening ${title}`}>
      <div className="load-row">
        <strong className="load-title">{title}</strong>
        <button type="button" className="text-button" data-testid="cancel-load" onClick={onCancel}>
          Cancel
        </button>
      </div>
      {/* Without a value the bar is indeterminate: the phase's length is not known. */}
      <progress aria-label={`${PHASES[phase]} ${title}`} value={part} max={1} />
      <div className="load-row figures">
        <span data-testid="load-phase">{PHASES[phase]}</span>
        <span data-testid="load-figures">
          {loadedBytes > 0 &&
            (totalBytes
              ? `${formatBytes(loadedBytes)} of ${formatBytes(totalBytes)}`
              : formatBytes(loadedBytes))}
          {loadedBytes > 0 && splats > 0 && ' · '}
          {splats > 0 && formatSplats(splats)}
          {phase === 'read' && bytesPerSecond > 0 && ` · ${formatBytes(bytesPerSecond)}/s`}
        </span>
      </div>
    </section>
  );
}
