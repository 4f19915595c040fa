import { TextButton } from '@websplatter/kit/controls';
import { useStore } from 'zustand';
import type { PanelProps, Viewer } from '../engine/viewer.ts';
import type { ViewerStore } from '../state/store.ts';
import { withCode } from '../ui/lazy.tsx';
import { Running } from '../ui/running.tsx';
import type { projectsOf } from './projects.ts';

/** Saves the scene with all that was made of it as a project. Its code is fetched then. */
export function saveProject(viewer: Viewer, store: ViewerStore): Promise<void> {
  return withProjects(viewer, store, (projects) => void projects.start());
}

function withProjects(
  viewer: Viewer,
  store: ViewerStore,
  act: (projects: ReturnType<typeof projectsOf>) => void,
): Promise<void> {
  return withCode(
    store,
    () => import('./projects.ts'),
    (code) => act(code.projectsOf(viewer, store)),
  );
}

/** Saves the scene with all that was made of it, to be opened here again. */
export function ProjectSection({ store, viewer }: PanelProps) {
  const running = useStore(store, (state) => state.savingProject);
  const hasScene = useStore(store, (state) => state.scene !== null);
  return (
    <section>
      <h3>Project</h3>
      {running ? (
        <Running
          label={`Writing: ${running.fileName}`}
          about={`Saving ${running.fileName}`}
          value={running.part}
          max={1}
          onCancel={() => void withProjects(viewer, store, (projects) => projects.cancel())}
          testId="saving-project"
          cancelId="cancel-project"
        />
      ) : (
        <div className="runner">
          <p>
            The scene with edits, rulers, views, annotations and background, to be opened here again. Files of
            this device are in it, others by their addresses.
          </p>
          <TextButton
            disabled={!hasScene}
            aria-keyshortcuts="Control+S"
            title="Ctrl+S"
            testId="save-project"
            onClick={() => void saveProject(viewer, store)}
          >
            Save .wsplat
          </TextButton>
        </div>
      )}
    </section>
  );
}
