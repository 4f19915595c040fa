import { useEffect, useMemo, useRef } from 'react';
import { useStore } from 'zustand';
import { AccuracyPanel } from './accuracy-panel.tsx';
import { AccuracySweep } from './accuracy-sweep.ts';
import { createCommands, listenToKeys } from './commands.ts';
import { DropZone } from './drop-zone.tsx';
import { type DropDecision, decideFiles } from './dropped-files.ts';
import { EffectsPanel } from './effects-panel.tsx';
import { ErrorPanel } from './error-panel.tsx';
import { ErrorLegend, ErrorPicture } from './error-picture.tsx';
import { Help } from './help.tsx';
import { Hud } from './hud.tsx';
import { LoadPanel } from './load-panel.tsx';
import { Measurement } from './measurement.ts';
import { Notice } from './notice.tsx';
import { SceneCaption } from './scene-caption.tsx';
import { SplitPicture } from './split-picture.tsx';
import { LostPage, UnavailablePage } from './status-pages.tsx';
import type { ViewerStore } from './store.ts';
import { Toolbar } from './toolbar.tsx';
import type { Viewer } from './viewer.ts';
import { Viewport } from './viewport.tsx';
import { WarningPanel } from './warning-panel.tsx';

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
