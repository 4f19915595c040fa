import { useStore } from 'zustand';
import type { PanelProps } from '../engine/panel-props.ts';
import { TextButton } from '../ui/controls.tsx';
import { NOT_FETCHED } from '../ui/lazy.tsx';
import type { PageKind } from './held-parts.ts';
import type { pagesOf } from './pages.ts';
import { SavingProgress } from './saving-progress.tsx';

const PAGE_KINDS: readonly PageKind[] = ['html', 'zip'];

/** Saves the scene and this view of it as a page that shows both by itself. */
export function PageSection({ store, viewer }: PanelProps) {
  const running = useStore(store, (state) => state.savingPage);
  const canSave = useStore(store, (state) => state.scene?.canSave ?? false);
  const isCropped = useStore(store, (state) => state.inspecting.crop !== null);
  // Fetched when somebody saves a page.
  const withPages = async (act: (pages: ReturnType<typeof pagesOf>) => void) => {
    const code = await import('./pages.ts').catch(() => null);
    if (code) act(code.pagesOf(viewer, store));
    else store.setState({ notice: NOT_FETCHED });
  };
  return (
    <section>
      <h3>Web page</h3>
      {running ? (
        <SavingProgress
          running={running}
          name="page"
          onCancel={() => void withPages((pages) => pages.cancel())}
        />
      ) : (
        <div className="runner">
          <p>
            {canSave && isCropped && <strong>The page holds what the crop hides, too. </strong>}
            {canSave
              ? 'The scene in this view: .html is one file, which opens without a server; .zip has files for any web host, which show splats while they arrive.'
              : 'This scene does not come from a file.'}
          </p>
          <div className="page-kinds">
            {PAGE_KINDS.map((kind) => (
              <TextButton
                key={kind}
                look="primary"
                disabled={!canSave}
                testId={`save-${kind}`}
                onClick={() => void withPages((pages) => void pages.start(kind))}
              >
                Save .{kind}
              </TextButton>
            ))}
          </div>
        </div>
      )}
    </section>
  );
}
