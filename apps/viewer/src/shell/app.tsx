import { lazy, Suspense, useEffect, useMemo, useRef } from 'react';
import { useStore } from 'zustand';
import { AccuracyPanel } from '../accuracy/accuracy-panel.tsx';
import { ErrorMapLegend } from '../comparison/error-map-legend.tsx';
import { EffectsPanel } from '../effects/effects-panel.tsx';
import { DropZone } from '../file-drop/drop-zone.tsx';
import { ACCEPTED_FILES, chosenFiles, decideFiles, type FileDropDecision } from '../file-drop/file-drop.ts';
import { filesOf, pickHandles } from '../file-drop/file-handles.ts';
import { followDrop } from '../file-drop/follow-drop.ts';
import { FrameRecorder } from '../hud/frame-recorder.ts';
import { AccuracyMeasurement } from '../measurement/accuracy-measurement.ts';
import { Measurement } from '../measurement/measurement.ts';
import { FailurePanel } from '../messages/failure-panel.tsx';
import { LoadPanel, PreparingPanel } from '../messages/load-panel.tsx';
import { Notice } from '../messages/notice.tsx';
import { ReopenPanel } from '../messages/reopen-panel.tsx';
import { LostPage, UnavailablePage } from '../messages/status-pages.tsx';
import { WarningPanel } from '../messages/warning-panel.tsx';
import { Saving } from '../saving/saving.ts';
import { SceneCaption } from '../scene/scene-caption.tsx';
import type { ViewerStore } from '../state/store.ts';
import { isGpuLost } from '../state/viewer-state.ts';
import type { PanelProps } from '../viewer/panel-props.ts';
import type { Viewer } from '../viewer/viewer.ts';
import { createCommands, listenToKeys } from './commands.ts';
import { Help } from './help.tsx';
import { Picture } from './picture.tsx';
import { PlainPicture } from './plain-picture.tsx';
import { Toolbar } from './toolbar.tsx';

/** The first picture does not wait for figures. */
const Hud = lazy(async () => ({ default: (await import('../hud/hud.tsx')).Hud }));
/** With the list of formats, which most visitors do not need. */
const SavePanel = lazy(async () => ({ default: (await import('../saving/save-panel.tsx')).SavePanel }));

/** With what is seldom changed of how a scene is looked at. */
const ViewPanel = lazy(async () => ({ default: (await import('../looking/view-panel.tsx')).ViewPanel }));
const FlightBanner = lazy(async () => ({
  default: (await import('../looking/flight-banner.tsx')).FlightBanner,
}));

/** @param poster address of an image to show until there is a picture. */
export function App({ store, viewer, poster }: PanelProps & { poster: string | null }) {
  const hasInterface = useStore(store, (state) => state.hasInterface);
  const isUnavailable = useStore(store, (state) => state.status === 'unavailable');
  const isLost = useStore(store, isGpuLost);
  const isSaveVisible = useStore(store, (state) => state.dock === 'save');
  const isHudVisible = useStore(store, (state) => state.isHudVisible);
  const isViewVisible = useStore(store, (state) => state.dock === 'view');
  const isFlying = useStore(store, (state) => state.flightSpeed !== null);
  const fileInput = useRef<HTMLInputElement>(null);
  const run = useMemo(
    () => createCommands(viewer, store, () => void chooseFiles(viewer, store, fileInput.current)),
    [viewer, store],
  );
  const saving = useMemo(() => new Saving(store, () => viewer.scenes.newest?.source), [viewer, store]);
  const recorder = useMemo(() => new FrameRecorder(store), [store]);
  const measurement = useMemo(() => new Measurement(viewer, store), [viewer, store]);
  const accuracyMeasurement = useMemo(
    () => new AccuracyMeasurement(viewer, store, measurement),
    [viewer, store, measurement],
  );
  useEffect(() => recorder.watch(), [recorder]);
  useEffect(() => measurement.watch(), [measurement]);
  useEffect(() => accuracyMeasurement.watch(), [accuracyMeasurement]);
  useEffect(() => listenToKeys(viewer, store, run), [viewer, store, run]);

  const reopen = async () => {
    if (!store.getState().lastFile?.isReachable) {
      run('open');
      return;
    }
    const decision = await viewer.files.reopen();
    if (decision) follow(decision);
  };
  const follow = (decision: FileDropDecision) => followDrop(decision, store, viewer);

  if (isUnavailable) return <UnavailablePage store={store} onRetry={() => viewer.recover()} />;
  if (!hasInterface) return <PlainPicture store={store} viewer={viewer} poster={poster} onDrop={follow} />;
  return (
    <>
      <main>
        <Picture store={store} viewer={viewer} poster={poster} />
        <div className="overlay">
          <Toolbar store={store} run={run} />
          <AccuracyPanel store={store} viewer={viewer} accuracyMeasurement={accuracyMeasurement} />
          <EffectsPanel store={store} measurement={measurement} />
          <Suspense>{isViewVisible && <ViewPanel store={store} viewer={viewer} />}</Suspense>
          <Suspense>{isSaveVisible && <SavePanel store={store} viewer={viewer} saving={saving} />}</Suspense>
          <div className="overlay-side">
            <Suspense>{isHudVisible && <Hud store={store} viewer={viewer} recorder={recorder} />}</Suspense>
            <div className="messages">
              <Notice store={store} />
              <Suspense>{isFlying && <FlightBanner store={store} viewer={viewer} />}</Suspense>
              <WarningPanel store={store} />
              <FailurePanel store={store} />
              <ErrorMapLegend store={store} viewer={viewer} />
              <ReopenPanel
                store={store}
                onReopen={() => void reopen()}
                onForget={() => viewer.files.forget()}
              />
              <PreparingPanel store={store} onCancel={() => viewer.cancelPreparing()} />
              <LoadPanel store={store} onCancel={() => viewer.scenes.cancelLoad()} />
            </div>
            <SceneCaption store={store} onStep={(by) => viewer.camera.step(by)} />
          </div>
        </div>
        <input
          ref={fileInput}
          type="file"
          accept={ACCEPTED_FILES}
          multiple
          hidden
          data-testid="file-input"
          onChange={(event) => {
            follow(decideFiles(chosenFiles(event.target.files ?? [])));
            // So that choosing the same file again is a change.
            event.target.value = '';
          }}
        />
        <DropZone onDrop={follow} />
      </main>
      <Help store={store} />
      {isLost && (
        <LostPage
          store={store}
          onRecover={() => viewer.recover()}
          onSmallScene={() => viewer.scenes.openSmallScene()}
        />
      )}
    </>
  );
}

/** By the picker that gives handles, where there is one. */
async function chooseFiles(
  viewer: Viewer,
  store: ViewerStore,
  input: HTMLInputElement | null,
): Promise<void> {
  const handles = await pickHandles();
  if (handles === null) input?.click();
  if (!handles?.length) return;
  const found = await filesOf(handles);
  if (found) followDrop({ ...decideFiles(found), handles }, store, viewer);
}
