import { WRITABLE_FORMATS } from '@websplatter/core/write';
import { type Choice, Choices } from '@websplatter/kit/choices';
import { TextButton } from '@websplatter/kit/controls';
import { useState } from 'react';
import { useStore } from 'zustand';
import { IS_ONE_FILE } from '../engine/link/lab-address.ts';
import type { PanelProps } from '../engine/viewer.ts';
import type { SaveTab } from '../state/page.ts';
import type { SavingState } from '../state/saving.ts';
import { countOf } from '../state/selecting.ts';
import { Dock } from '../ui/dock.tsx';
import { withCode } from '../ui/lazy.tsx';
import { Running } from '../ui/running.tsx';
import { Tabs } from '../ui/tabs.tsx';
import { linkOf } from './copy-link.ts';
import type { PageKind } from './held-parts.ts';
import { LinkSection } from './link-section.tsx';
import type { pagesOf } from './pages.ts';
import { PictureSection } from './picture-section.tsx';
import { ProjectSection } from './project-section.tsx';
import { savesSelection, savingOf } from './saving.ts';
import { SettingsSection } from './settings-section.tsx';
import { VideoSection } from './video-section.tsx';

const PHASES = {
  cut: 'Leaving out what you cut away',
  read: 'Reading the scene again',
  write: 'Writing',
} as const;

/** How far a file is that is being written, and a button to cancel it. */
function SavingProgress({
  running,
  name,
  onCancel,
}: {
  running: SavingState;
  name: 'save' | 'page';
  onCancel: () => void;
}) {
  return (
    <Running
      label={`${PHASES[running.phase]}: ${running.fileName}`}
      about={`Saving ${running.fileName}`}
      value={running.part}
      max={1}
      onCancel={onCancel}
      testId={name === 'save' ? 'saving' : 'saving-page'}
      cancelId={`cancel-${name}`}
    />
  );
}

const PAGE_KINDS: readonly PageKind[] = ['html', 'zip'];

/** Saves the scene, this view and its story as a page that shows them by itself. */
function PageSection({ store, viewer, isMainWay }: PanelProps & { isMainWay: boolean }) {
  const running = useStore(store, (state) => state.savingPage);
  const canSave = useStore(store, (state) => state.scene?.canSave ?? false);
  const isCut = useStore(
    store,
    ({ inspecting }) => inspecting.crop !== null || countOf(inspecting.selecting.removed) > 0,
  );
  // Fetched when somebody saves a page.
  const withPages = (act: (pages: ReturnType<typeof pagesOf>) => void) =>
    withCode(
      store,
      () => import('./pages.ts'),
      (code) => act(code.pagesOf(viewer, store)),
    );
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
            {canSave && isCut && <strong data-testid="page-cut">What you cut away is left out. </strong>}
            {canSave
              ? 'The scene in this view, with saved views and annotations. .html is one file that opens without a server. .zip has files for any web host, and shows splats while they arrive.'
              : 'This scene does not come from a file.'}
          </p>
          <div className="page-kinds">
            {PAGE_KINDS.map((kind) => (
              <TextButton
                key={kind}
                look={isMainWay && kind === PAGE_KINDS[0] ? 'primary' : 'outlined'}
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

const SAVED: readonly Choice<boolean>[] = [
  [false, 'All that is left', 'all'],
  [true, 'The selection', 'selection'],
];

/** Saves the scene in another format. */
function SceneSection({ store, viewer }: PanelProps) {
  const saving = savingOf(viewer, store);
  const running = useStore(store, (state) => state.saving);
  const canSave = useStore(store, (state) => state.scene?.canSave ?? false);
  const isCropped = useStore(store, (state) => state.inspecting.crop !== null);
  const selecting = useStore(store, (state) => state.inspecting.selecting);
  const isSelection = savesSelection(selecting);
  const [chosen, setChosen] = useState(WRITABLE_FORMATS[0]);
  return (
    <section>
      <h3>Scene</h3>
      <Choices
        label="Format"
        isChips
        choices={WRITABLE_FORMATS.map((format) => [format, format.title, format.name])}
        chosen={chosen}
        testId="save-"
        titleOf={({ extension }) => extension}
        onChoose={setChosen}
      />
      {selecting.selected.size > 0 && (
        <Choices
          label="Which splats are saved"
          choices={SAVED}
          chosen={isSelection}
          testId="save-"
          onChoose={(each) =>
            store.setState(({ inspecting }) => ({
              inspecting: { ...inspecting, selecting: { ...selecting, savesSelection: each } },
            }))
          }
        />
      )}
      {running ? (
        <SavingProgress running={running} name="save" onCancel={() => saving.cancel()} />
      ) : (
        <div className="runner">
          <p>
            {canSave && isCropped && (
              <strong data-testid="save-cropped">Only what the crop leaves is saved. </strong>
            )}
            {canSave && (isSelection || selecting.removed.size > 0) && (
              <strong data-testid="save-edited">
                {isSelection ? 'Only the selected splats are saved. ' : 'Removed splats are not saved. '}
              </strong>
            )}
            {canSave
              ? 'Saves visible splats, upright in other viewers. Of the effects, only Grade is saved.'
              : 'This scene does not come from a file.'}
          </p>
          <TextButton
            look="primary"
            disabled={!canSave}
            testId="save-file"
            onClick={() => void saving.start(chosen)}
          >
            Save {chosen.extension}
          </TextButton>
        </div>
      )}
    </section>
  );
}

const TABS = {
  share: 'Share',
  picture: 'Picture and video',
  file: 'File',
} as const satisfies Readonly<Record<SaveTab, string>>;

/** Links, pages, pictures, videos and files, in tabs by purpose. */
export function SavePanel({ store, viewer }: PanelProps) {
  const tab = useStore(store, (state) => state.saveTab);
  return (
    <Dock store={store} name="save">
      <Tabs
        label="What to save or share"
        tabs={TABS}
        tab={tab}
        testId="save-tab"
        onTab={(saveTab) => store.setState({ saveTab })}
      >
        {tab === 'share' && <ShareTab store={store} viewer={viewer} />}
        {tab === 'picture' && (
          <>
            <PictureSection store={store} viewer={viewer} />
            <VideoSection store={store} viewer={viewer} />
          </>
        )}
        {tab === 'file' && (
          <>
            <SceneSection store={store} viewer={viewer} />
            <ProjectSection store={store} viewer={viewer} />
            <SettingsSection store={store} viewer={viewer} />
          </>
        )}
      </Tabs>
    </Dock>
  );
}

function ShareTab({ store, viewer }: PanelProps) {
  const canLink = linkOf(viewer, store) !== null;
  return (
    <>
      <LinkSection store={store} viewer={viewer} />
      {!IS_ONE_FILE && <PageSection store={store} viewer={viewer} isMainWay={!canLink} />}
    </>
  );
}
