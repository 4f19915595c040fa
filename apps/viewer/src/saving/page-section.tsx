import { useStore } from 'zustand';
import { TextButton } from '../ui/controls.tsx';
import { NOT_FETCHED } from '../ui/lazy.tsx';
import type { PanelProps } from '../viewer/panel-props.ts';
import { SavingProgress } from './saving-progress.tsx';

/** Saves the scene and this view of it as one file that shows both by itself. */
export function PageSection({ store, viewer }: PanelProps) {
  const running = useStore(store, (state) => state.savingPage);
  const canSave = useStore(store, (state) => state.scene?.canSave ?? false);
  const isCropped = useStore(store, (state) => state.inspecting.crop !== null);
  // Fetched when somebody saves a page.
  const withPages = async (act: 'start' | 'cancel') => {
    const code = await import('./pages.ts').catch(() => null);
    if (code) await code.pagesOf(viewer, store)[act]();
    else store.setState({ notice: NOT_FETCHED });
  };
  return (
    <section>
      <h3>Web page</h3>
      {running ? (
        <SavingProgress running={running} name="page" onCancel={() => void withPages('cancel')} />
      ) : (
        <div className="runner">
          <p>
            {canSave && isCropped && <strong>The page holds what the crop hides, too. </strong>}
            {canSave
              ? 'One file with the scene and this view, to be sent on: it opens without a server or a network.'
              : 'There is no file behind this scene.'}
          </p>
          <TextButton
            look="primary"
            disabled={!canSave}
            testId="save-page"
            onClick={() => void withPages('start')}
          >
            Save .html
          </TextButton>
        </div>
      )}
    </section>
  );
}
