import { Suspense, useCallback, useEffect, useMemo, useRef, useState } from 'react';
import { useStore } from 'zustand';
import type { Measurements } from '../accuracy/measure-presets.ts';
import type { KeptFile } from '../engine/keep/file-memory.ts';
import { decide } from '../engine/open/decide.ts';
import { ACCEPTED_FILES, chosenFiles, type FileDropDecision } from '../engine/open/file-drop.ts';
import type { PanelProps, Viewer } from '../engine/viewer.ts';
import type { Walks } from '../navigate/walks.ts';
import { DropZone } from '../scene/drop-zone.tsx';
import { hasAnnotationCard } from '../state/annotating.ts';
import type { ViewerStore } from '../state/store.ts';
import { keyScope } from '../ui/key-scope.ts';
import { lazyCode, lazyComponent, withCode } from '../ui/lazy.tsx';
import { createCommands, listenToKeys } from './commands.ts';
import { followDrop } from './follow-drop.ts';
import { listenForGamepads } from './gamepad-listener.ts';
import { LoadPanel } from './load-panel.tsx';
import { LostGpu } from './lost-gpu.tsx';
import { MessagePanel } from './message-panel.tsx';
import { Picture, smallParts } from './picture.tsx';
import { Toolbar } from './toolbar.tsx';

const fetchMeasurements = lazyCode(() => import('../accuracy/measure-presets.ts'));
// In the order in which they are fetched after the first picture.
const SceneCaption = lazyComponent(async () => (await import('../scene/scene-caption.tsx')).SceneCaption);
const Hud = lazyComponent(async () => (await import('../hud/hud.tsx')).Hud);
const OpenPanel = lazyComponent(async () => (await import('./open-panel.tsx')).OpenPanel);
const ViewPanel = lazyComponent(async () => (await import('../navigate/view-panel.tsx')).ViewPanel);
const PathStrip = lazyComponent(async () => (await import('../path/path-strip.tsx')).PathStrip);
const CloudsPanel = lazyComponent(async () => (await import('../scene/clouds-panel.tsx')).CloudsPanel);
const PlaceGizmo = lazyComponent(async () => (await smallParts()).PlaceGizmo);
const AccuracyPanel = lazyComponent(
  async () => (await import('../accuracy/accuracy-panel.tsx')).AccuracyPanel,
);
const EffectsPanel = lazyComponent(async () => (await import('../effects/effects-panel.tsx')).EffectsPanel);
const VolumeGizmo = lazyComponent(async () => (await smallParts()).VolumeGizmo);
// It also draws over the image, and keeps a crop after its panel is closed.
const Inspect = lazyComponent(async () => (await import('../inspect/inspect.tsx')).Inspect);
const SavePanel = lazyComponent(async () => (await import('../share/save-panel.tsx')).SavePanel);
const FilmingCard = lazyComponent(async () => (await import('../share/video-section.tsx')).FilmingCard);
const Notice = lazyComponent(async () => (await smallParts()).Notice);
const UnkeptPanel = lazyComponent(async () => (await smallParts()).UnkeptPanel);
const KeptVersionsPanel = lazyComponent(async () => (await smallParts()).KeptVersionsPanel);
const Help = lazyComponent(async () => (await smallParts()).Help);
const ReopenPanel = lazyComponent(async () => (await smallParts()).ReopenPanel);
const StreamPanel = lazyComponent(async () => (await smallParts()).StreamPanel);
const AnnotationCard = lazyComponent(async () => (await smallParts()).AnnotationCard);
const TravelBanner = lazyComponent(async () => (await smallParts()).TravelBanner);
const ModeLegend = lazyComponent(async () => (await smallParts()).ModeLegend);
const ErrorMapLegend = lazyComponent(async () => (await smallParts()).ErrorMapLegend);
const PlainPicture = lazyComponent(async () => (await import('./plain-picture.tsx')).PlainPicture);
const UnavailablePage = lazyComponent(async () => (await import('./status-pages.tsx')).UnavailablePage);

/** @param poster URL of an image to show before the first picture; null for none. */
export function App({ store, viewer, poster }: PanelProps & { poster: string | null }) {
  const hasInterface = useStore(store, (state) => state.hasInterface);
  const isUnavailable = useStore(store, (state) => state.status === 'unavailable');
  const dock = useStore(store, (state) => state.dock);
  const isVolumeVisible = useStore(
    store,
    (state) => state.dock === 'effects' && state.requested.choices.volumes?.isOn === true,
  );
  const isPathVisible = useStore(store, (state) => state.isPathVisible);
  const isHudVisible = useStore(store, (state) => state.isHudVisible);
  const hasScene = useStore(store, (state) => state.scene !== null);
  const hasNotice = useStore(store, (state) => state.notice !== null);
  const isUnkept = useStore(store, (state) => state.unkept.size > 0);
  const hasVersions = useStore(store, (state) => state.keptVersions !== null);
  const hasErrorMap = useStore(store, (state) => state.comparison?.kind === 'error');
  const hasViewMode = useStore(store, (state) => state.viewMode !== 'colours');
  const hasLastFile = useStore(store, (state) => state.lastFile !== null);
  const isHelpVisible = useStore(store, (state) => state.isHelpVisible);
  // Stays mounted, so that closing it restores the focus.
  const [hasHelp, setHasHelp] = useState(isHelpVisible);
  if (isHelpVisible && !hasHelp) setHasHelp(true);
  const hasMarks = useStore(store, ({ inspecting: { crop, rulers } }) => crop !== null || rulers.length > 0);
  const isTravelling = useStore(
    store,
    ({ travelling, groundPart }) => travelling !== null || groundPart !== null,
  );
  const hasCard = useStore(store, hasAnnotationCard);
  const isFilming = useStore(store, ({ filming, dock }) => filming !== null && dock !== 'save');
  const fileInput = useRef<HTMLInputElement>(null);
  /** Whether the files being chosen are added to the scene. */
  const isAdding = useRef(false);
  const choose = useCallback(
    (isAdded: boolean) => {
      isAdding.current = isAdded;
      void withCode(
        store,
        () => import('./choose-files.ts'),
        ({ chooseFiles }) => void chooseFiles(viewer, store, fileInput.current, isAdded),
      );
    },
    [viewer, store],
  );
  const run = useMemo(() => {
    let walks: Walks | undefined;
    return createCommands(viewer, store, {
      addFiles: () => choose(true),
      walk: () => {
        void withCode(
          store,
          () => import('../navigate/walks.ts'),
          (code) => {
            walks ??= new code.Walks(viewer, store);
            walks.toggle();
          },
        );
      },
    });
  }, [viewer, store, choose]);
  const measurements = useMeasurements(store, viewer);
  useEffect(() => listenToKeys(viewer, store, run), [viewer, store, run]);
  useEffect(() => listenForGamepads(viewer, store, run), [viewer, store, run]);

  useEffect(() => listenToPaste({ store, viewer }), [store, viewer]);

  /** Opens a remembered file, by default the offered one. */
  const reopen = async (file?: KeptFile) => {
    if (!file && !store.getState().lastFile?.isReachable) {
      choose(false);
      return;
    }
    const decision = await viewer.files.reopen(file);
    if (decision) follow(decision);
  };
  const follow = (decision: FileDropDecision) => followDrop(decision, store, viewer);

  if (isUnavailable) {
    return (
      <Suspense>
        <UnavailablePage store={store} onRetry={() => viewer.recover()} />
      </Suspense>
    );
  }
  if (!hasInterface)
    return (
      <Suspense>
        <PlainPicture store={store} viewer={viewer} poster={poster} onDrop={follow} />
      </Suspense>
    );
  return (
    <>
      <main>
        <Picture store={store} viewer={viewer} poster={poster} />
        <Suspense>{isVolumeVisible && <VolumeGizmo store={store} viewer={viewer} />}</Suspense>
        <Suspense>{dock === 'clouds' && <PlaceGizmo store={store} viewer={viewer} />}</Suspense>
        <div className="overlay">
          <Toolbar store={store} run={run} />
          <Suspense fallback={dock && <EmptyDock />}>
            {dock === 'open' && (
              <OpenPanel
                store={store}
                viewer={viewer}
                onChoose={() => choose(false)}
                onReopen={(file) => void reopen(file)}
              />
            )}
            {dock === 'clouds' && <CloudsPanel store={store} viewer={viewer} onAdd={() => run('add')} />}
            {dock === 'view' && <ViewPanel store={store} viewer={viewer} run={run} />}
            {dock === 'accuracy' && measurements && (
              <AccuracyPanel store={store} viewer={viewer} {...measurements} />
            )}
            {dock === 'effects' && measurements && (
              <EffectsPanel store={store} viewer={viewer} {...measurements} />
            )}
            {dock === 'save' && <SavePanel store={store} viewer={viewer} />}
          </Suspense>
          <Suspense>{isPathVisible && hasScene && <PathStrip store={store} viewer={viewer} />}</Suspense>
          <Suspense fallback={dock === 'inspect' && <EmptyDock />}>
            {(dock === 'inspect' || hasMarks) && <Inspect store={store} viewer={viewer} />}
          </Suspense>
          <div className="overlay-side">
            <Suspense>{isHudVisible && <Hud store={store} viewer={viewer} />}</Suspense>
            <div className="messages">
              {/* Always mounted: some screen readers ignore a live region that is added with its text. */}
              <div role="status" className="message-slot">
                <Suspense>{hasNotice && <Notice store={store} run={run} />}</Suspense>
              </div>
              <div role="alert" className="message-slot">
                <Suspense>{isUnkept && <UnkeptPanel store={store} run={run} />}</Suspense>
              </div>
              <div role="status" className="message-slot">
                <Suspense>{hasVersions && <KeptVersionsPanel store={store} />}</Suspense>
              </div>
              <Suspense>{isTravelling && <TravelBanner store={store} />}</Suspense>
              <Suspense>{hasScene && <StreamPanel store={store} viewer={viewer} />}</Suspense>
              <Suspense>{hasCard && <AnnotationCard store={store} viewer={viewer} />}</Suspense>
              <MessagePanel store={store} kind="warning" />
              <MessagePanel store={store} kind="error" />
              <Suspense>{hasErrorMap && <ErrorMapLegend store={store} viewer={viewer} />}</Suspense>
              <Suspense>{hasViewMode && <ModeLegend store={store} viewer={viewer} />}</Suspense>
              <Suspense>
                {hasLastFile && (
                  <ReopenPanel
                    store={store}
                    onReopen={() => void reopen()}
                    onForget={() => viewer.files.forget()}
                  />
                )}
              </Suspense>
              <Suspense>{isFilming && <FilmingCard store={store} viewer={viewer} />}</Suspense>
              <LoadPanel store={store} name="preparing" onCancel={() => viewer.cancelPreparing()} />
              <LoadPanel store={store} name="load" onCancel={() => viewer.scenes.cancelLoad()} />
            </div>
            <Suspense>
              {hasScene && (
                <SceneCaption
                  store={store}
                  viewer={viewer}
                  onStep={(by) => viewer.camera.step(by)}
                  onSamples={() => store.setState({ dock: 'open' })}
                />
              )}
            </Suspense>
          </div>
        </div>
        <input
          ref={fileInput}
          type="file"
          accept={ACCEPTED_FILES}
          multiple
          hidden
          data-testid="file-input"
          onChange={({ target }) => {
            const isAdded = isAdding.current;
            void decide(chosenFiles(target.files ?? [])).then((decision) => follow({ ...decision, isAdded }));
            // Clears the input, so that choosing the same file again is a change.
            target.value = '';
          }}
        />
        <DropZone
          canAdd={hasScene}
          onDrop={follow}
          onLink={(text, isAdded) => openLink({ store, viewer }, text, isAdded)}
        />
      </main>
      <Suspense>{hasHelp && <Help store={store} run={run} />}</Suspense>
      <LostGpu store={store} viewer={viewer} />
    </>
  );
}

/** Keeps a panel's place while its code arrives, so that the picture does not move twice. */
function EmptyDock() {
  return <div className="panel dock" />;
}

/** Null until there is a picture to measure or a panel that measures. */
function useMeasurements(store: ViewerStore, viewer: Viewer): Measurements | null {
  const [measurements, setMeasurements] = useState<Measurements | null>(null);
  const isNeeded = useStore(store, ({ imageId, dock }) => imageId > 0 || dock !== null);
  useEffect(() => {
    if (!isNeeded) return;
    let stop = () => {};
    let isOver = false;
    void withCode(store, fetchMeasurements, ({ startMeasurements }) => {
      if (isOver) return;
      const made = startMeasurements(viewer, store);
      stop = made.stop;
      setMeasurements(made);
    });
    return () => {
      isOver = true;
      stop();
    };
  }, [store, viewer, isNeeded]);
  return measurements;
}

/** Opens the scene that a pasted or dropped link names. */
function openLink(panel: PanelProps, text: string, isAdded = false): void {
  void withCode(
    panel.store,
    () => import('../engine/open/open-address.ts'),
    ({ openText }) => openText(panel, text, isAdded),
  );
}

/** Opens links that are pasted outside of text fields; returns a function that stops this. */
function listenToPaste(panel: PanelProps): () => void {
  const onPaste = ({ target, clipboardData }: ClipboardEvent) => {
    const text = clipboardData?.getData('text/plain');
    if (text && keyScope(target) !== 'text') openLink(panel, text);
  };
  window.addEventListener('paste', onPaste);
  return () => window.removeEventListener('paste', onPaste);
}
