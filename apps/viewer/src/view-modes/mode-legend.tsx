import { IconButton } from '@websplatter/kit/controls';
import { useStore } from 'zustand';
import type { PanelProps, Viewer } from '../engine/viewer.ts';
import { type ComparisonSide, sideDrawn } from '../state/accuracy.ts';
import type { ViewerStore } from '../state/store.ts';
import { viewModeAfter } from '../state/view-mode.ts';
import type { RampEnd } from './ramp.ts';
import type { ColorScale } from './scale.ts';
import { setViewMode } from './set-view-mode.ts';
import { cautionsOf, type PictureFacts, type ViewMode, viewModeOf } from './view-modes.ts';

/** Explains the colours of a view mode, with a button that returns to the picture. */
export function ModeLegend({ store, viewer }: PanelProps) {
  const name = useStore(store, (state) => state.viewMode);
  const isIdle = useStore(store, (state) => state.isIdle);
  // Changes whenever a picture comes to rest; the scales depend on the picture's facts.
  useStore(store, (state) => state.restedFrames);
  const mode = viewModeOf(name);
  const sides = sidesOf(store, viewer);
  const step = (by: number) => setViewMode({ store, viewer }, viewModeAfter(name, by));
  return (
    <section className="panel mode-legend" aria-label="View mode" data-testid="mode-legend">
      <div className="mode-legend-row">
        <IconButton icon="previous" label="Previous view mode" onClick={() => step(-1)} />
        <div role="status">
          <h2>{mode.label}</h2>
        </div>
        <IconButton
          icon="next"
          label="Next view mode"
          aria-keyshortcuts="M"
          title="Next view mode (M)"
          onClick={() => step(1)}
        />
        <IconButton
          icon="close"
          label="Back to colours"
          title="Back to colours"
          onClick={() => setViewMode({ store, viewer }, 'colours')}
        />
      </div>
      <p>{mode.about}</p>
      {mode.map && <MapLegend store={store} mode={mode} map={mode.map} />}
      {sides[0] && mode.scale && <Scale scale={mode.scale(sides[0])} isCurrent={isIdle} />}
      {cautionsOf(mode, sides).map((caution) => (
        <p key={caution}>{caution}</p>
      ))}
    </section>
  );
}

/** Counts of a mode's map; while the picture moves, the counts of the last rest. */
function MapLegend({
  store,
  mode,
  map,
}: Pick<PanelProps, 'store'> & { mode: ViewMode; map: NonNullable<ViewMode['map']> }) {
  const figures = useStore(store, ({ mapFigures }) => (mapFigures?.mode === mode.name ? mapFigures : null));
  const isCurrent = useStore(
    store,
    ({ mapFigures, isIdle, restedFrames }) => isIdle && mapFigures?.restedFrames === restedFrames,
  );
  const isSplit = useStore(store, (state) => state.comparison?.kind === 'split');
  const scale = figures && map.scale(figures);
  return (
    <>
      {scale && <Scale scale={scale} isCurrent />}
      <p role="status" data-testid="map-notes">
        {!figures && 'Counting, once the picture is at rest…'}
        {figures?.kind === 'failure' && `There is no map. ${figures.message}`}
        {figures && !isCurrent && 'As of the last rest: '}
        {figures && map.notes(figures).join(' ')}
      </p>
      {isSplit && <p>The map shows side A.</p>}
    </>
  );
}

/**
 * @param isCurrent whether the numbers belong to the current picture; they may be outdated while it
 * moves.
 */
function Scale({ scale: { title, low, high, ticks }, isCurrent }: { scale: ColorScale; isCurrent: boolean }) {
  return (
    <figure className="mode-scale" aria-busy={!isCurrent} data-testid="mode-scale">
      <figcaption>
        {title}, from {low.name} to {high.name}
      </figcaption>
      <i
        style={{ backgroundImage: `linear-gradient(to right, ${css(low)}, ${css(high)})` }}
        aria-hidden="true"
      />
      <ol>
        {ticks.map(({ part, text }) => (
          <li key={part} style={{ left: `${100 * part}%` }}>
            <span style={{ translate: `${-100 * part}%` }}>{text}</span>
          </li>
        ))}
      </ol>
    </figure>
  );
}

const css = ({ color }: RampEnd) => `rgb(${color.map(Math.round).join(' ')})`;

/** Facts of each side of the picture at rest, mostly one; empty before there is a picture. */
function sidesOf(store: ViewerStore, viewer: Viewer): readonly PictureFacts[] {
  const frame = viewer.shownFrame?.frame;
  const bounds = viewer.camera.subjectSphere;
  const state = store.getState();
  const { comparison, scene } = state;
  if (!frame || !bounds || !scene) return [];
  const { camera, background = [0, 0, 0] } = frame;
  const subject = { bounds, focusDistance: viewer.camera.controls.pose.distance };
  const facts = { viewMatrix: camera.viewMatrix, background, subject, shDegree: scene.shDegree };
  const sides: readonly ComparisonSide[] =
    comparison?.kind === 'split' ? [comparison.left, comparison.right] : ['current'];
  return sides.map((side) => ({ ...facts, accuracy: sideDrawn(side, state).accuracy }));
}
