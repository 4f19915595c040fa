import { IconButton, TextButton } from '@websplatter/kit/controls';
import { Icon } from '@websplatter/kit/icon';
import { type DragEvent, useMemo, useRef, useState } from 'react';
import { useStore } from 'zustand';
import type { PanelProps } from '../engine/viewer.ts';
import { TURNTABLE_MS } from '../navigate/saved-views.ts';
import { showPath } from '../navigate/show-path.ts';
import { useSavedViews } from '../navigate/thumbnails.tsx';
import { pathOf } from '../navigate/view-path.ts';
import { withCode } from '../ui/lazy.tsx';
import { NumberField } from '../ui/number-field.tsx';
import { PathKeyForm } from './path-key-form.tsx';
import { PathTimeline } from './path-timeline.tsx';

/** Formats in which a path is saved. */
const EXPORTS = ['glb', 'gltf', 'json'] as const;
const EXPORT_TITLES = {
  glb: 'glTF, one binary file: for Blender and others',
  gltf: 'glTF as text',
  json: 'settings.json of SuperSplat, with this view, background and annotations',
} as const;
const ACCEPTED_PATHS = '.txt,.json,.gltf,.glb';

/** The camera path below the picture: views at their times, to be played, moved and scrubbed. */
export function PathStrip({ store, viewer }: PanelProps) {
  const savedViews = useStore(store, (state) => state.savedViews);
  const settings = useStore(store, (state) => state.path);
  const isPlaying = useStore(store, (state) => state.isPathPlaying);
  const hasPicture = useStore(store, (state) => state.imageId > 0);
  const views = useSavedViews({ store, viewer });
  const path = useMemo(() => pathOf({ savedViews, path: settings }), [savedViews, settings]);
  const [selected, setSelected] = useState<number | null>(null);
  const [turntableMs, setTurntableMs] = useState(TURNTABLE_MS);
  const [isHovered, setHovered] = useState(false);
  const fileInput = useRef<HTMLInputElement>(null);
  const { turntable } = settings;
  const isLooped = path?.isLooped ?? settings.isLooped;
  const chosen = turntable || selected === null || selected >= savedViews.length ? null : selected;

  // Fetched when somebody reads or saves a path as a file.
  const withFiles = (act: (code: typeof import('./path-files.ts')) => void) =>
    withCode(store, () => import('./path-files.ts'), act);
  const importFiles = (files: readonly File[]) => {
    if (files.length > 0) void withFiles((code) => code.importPath(files, views, { store, viewer }));
  };
  /** Files over the strip are paths: the window must not open them as scenes. */
  const take = (event: DragEvent, isOver: boolean) => {
    if (!event.dataTransfer.types.includes('Files')) return;
    event.preventDefault();
    setHovered(isOver);
  };
  return (
    <section
      className="panel path-strip"
      aria-label="Camera path"
      data-testid="path-strip"
      data-dropping={isHovered}
      onDragEnter={(event) => take(event, true)}
      onDragOver={(event) => take(event, true)}
      onDragLeave={() => setHovered(false)}
      onDrop={(event) => {
        take(event, false);
        importFiles([...event.dataTransfer.files]);
      }}
    >
      <header className="path-head">
        <div className="path-row">
          <TextButton
            look="primary"
            disabled={!path || !hasPicture}
            testId="play-path"
            onClick={() => views.togglePlaying()}
          >
            <Icon name={isPlaying ? 'pause' : 'play'} />
            {isPlaying ? 'Pause' : 'Play'}
          </TextButton>
          <PathTime store={store} durationMs={path?.durationMs ?? 0} />
          <TextButton
            aria-pressed={isLooped}
            disabled={turntable !== null}
            title="Goes on from the last view to the first"
            testId="loop-path"
            onClick={() => views.setLooped(!settings.isLooped)}
          >
            <Icon name="loop" />
            Loop
          </TextButton>
          <TextButton
            disabled={!hasPicture}
            title="The path goes on to what is on the screen"
            testId="add-view"
            onClick={() => void views.save()}
          >
            <Icon name="add" />
            Add view
          </TextButton>
          <span className="path-group">
            <TextButton
              aria-pressed={turntable !== null}
              disabled={!hasPicture}
              title="Once around what this view looks at"
              testId="turntable"
              onClick={() => views.setTurntable(turntable ? null : turntableMs)}
            >
              <Icon name="turntable" />
              Turntable
            </TextButton>
            <NumberField
              label="Seconds of the turntable"
              value={(turntable?.durationMs ?? turntableMs) / 1000}
              step={1}
              min={1}
              testId="turntable-seconds"
              onChange={(seconds) => {
                setTurntableMs(1000 * seconds);
                views.setTurntableMs(1000 * seconds, 'turntable seconds');
              }}
            />
            s
          </span>
          <span className="path-group path-files">
            <TextButton
              title="images.txt of COLMAP, settings.json of SuperSplat, cameras of a glTF; or drop one here"
              disabled={!hasPicture}
              testId="import-path"
              onClick={() => fileInput.current?.click()}
            >
              Import…
            </TextButton>
            <span>Export</span>
            {EXPORTS.map((kind) => (
              <button
                key={kind}
                type="button"
                className="chip"
                title={EXPORT_TITLES[kind]}
                aria-label={`Export as .${kind}`}
                disabled={!path || !hasPicture}
                data-testid={`export-path-${kind}`}
                onClick={() => void withFiles((code) => code.exportPath(kind, { store, viewer }))}
              >
                .{kind}
              </button>
            ))}
          </span>
        </div>
        <IconButton
          icon="close"
          label="Close the camera path"
          testId="close-path"
          onClick={() => showPath(store, false)}
        />
      </header>
      <PathTimeline
        store={store}
        viewer={viewer}
        views={views}
        path={path}
        selected={chosen}
        onSelect={setSelected}
      />
      <PathKeyForm store={store} views={views} selected={chosen} onSelect={setSelected} />
      <input
        ref={fileInput}
        type="file"
        accept={ACCEPTED_PATHS}
        multiple
        hidden
        data-testid="path-input"
        onChange={({ target }) => {
          importFiles([...(target.files ?? [])]);
          target.value = '';
        }}
      />
    </section>
  );
}

/** Where the path is, and how long it takes. */
function PathTime({ store, durationMs }: Pick<PanelProps, 'store'> & { durationMs: number }) {
  const playheadMs = useStore(store, (state) => Math.min(state.playheadMs, durationMs));
  return (
    <span className="path-time" data-testid="path-time">
      {(playheadMs / 1000).toFixed(1)} of {(durationMs / 1000).toFixed(1)} s
    </span>
  );
}
