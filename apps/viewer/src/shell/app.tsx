import { useEffect, useMemo, useRef } from 'react';
import { useStore } from 'zustand';
import { AccuracyPanel } from '../accuracy/accuracy-panel.tsx';
import { ErrorLegend, ErrorPicture } from '../comparison/error-map-image.tsx';
import { SplitPicture } from '../comparison/split-image.tsx';
import { EffectsPanel } from '../effects/effects-panel.tsx';
import { DropZone } from '../file-drop/drop-zone.tsx';
import { type DropDecision, decideFiles } from '../file-drop/file-drop.ts';
import { Hud } from '../hud/hud.tsx';
import { AccuracySweep } from '../measurement/accuracy-measurement.ts';
import { Measurement } from '../measurement/measurement.ts';
import { ErrorPanel } from '../messages/failure-panel.tsx';
import { LoadPanel } from '../messages/load-panel.tsx';
import { Notice } from '../messages/notice.tsx';
import { LostPage, UnavailablePage } from '../messages/status-pages.tsx';
import { WarningPanel } from '../messages/warning-panel.tsx';
import { SceneCaption } from '../scene/scene-caption.tsx';
import type { ViewerStore } from '../state/store.ts';
import type { Viewer } from '../viewer/viewer.ts';
import { createCommands, listenToKeys } from './commands.ts';
import { Help } from './help.tsx';
import { Toolbar } from './toolbar.tsx';
import { Viewport } from './viewport.tsx';

export function App({ store, viewer }: { store: ViewerStore; viewer: Viewer }) {
  const status = useStore(store, (state) => state.status);
  const comparison = useStore(store, (state) => state.comparison);
  const fileInput = useRef<HTMLInputElement>(null);
  const run = useMemo(() => createCommands(viewer, store, () => fileInput.current?.click()), [viewer, store]);
  const measurement = useMemo(() => new Measurement(viewer, store), [viewer, store]);
  const sweep = useMemo(() => new AccuracySweep(viewer, store, measurement), [viewer, store, measurement]);
  useEffect(() => measurement.watch(), [measurement]);
  useEffect(() => sweep.watch(), [sweep]);
  useEffect(() => listenToKeys(viewer, store, run), [viewer, store, run]);

  const follow = ({ file, notice }: DropDecision) => {
    if (file) viewer.open({ kind: 'file', file });
    if (notice) store.setState({ notice });
  };

  if (status === 'unavailable') return <UnavailablePage store={store} />;
  return (
    <>
      <Viewport store={store} viewer={viewer} />
      {comparison?.kind === 'split' && <SplitPicture store={store} viewer={viewer} split={comparison} />}
      {comparison?.kind === 'error' && <ErrorPicture store={store} viewer={viewer} />}
      <div className="overlay">
        <Hud store={store} />
        <Toolbar store={store} run={run} />
        <AccuracyPanel store={store} viewer={viewer} sweep={sweep} />
        <EffectsPanel store={store} measurement={measurement} />
        <SceneCaption store={store} onStep={(by) => viewer.stepCamera(by)} />
        <div className="messages">
          <Notice store={store} />
          <WarningPanel store={store} />
          <ErrorPanel store={store} />
          <ErrorLegend store={store} viewer={viewer} />
          <LoadPanel store={store} onCancel={() => viewer.cancelLoad()} />
        </div>
      </div>
      <input
        ref={fileInput}
        type="file"
        accept=".ply"
        hidden
        data-testid="file-input"
        onChange={(event) => {
          follow(decideFiles([...(event.target.files ?? [])]));
          // So that choosing the same file again is a change.
          event.target.value = '';
        }}
      />
      <DropZone onDrop={follow} />
      <Help store={store} />
      {status === 'lost' && <LostPage store={store} onRecover={() => viewer.recover()} />}
    </>
  );
}
