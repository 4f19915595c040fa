import type { FrameStatistics } from '@websplatter/core';
import { IconButton } from '@websplatter/kit/controls';
import { formatBytes } from '@websplatter/kit/format';
import { saveFile, useCopy } from '@websplatter/kit/take-away';
import { useLayoutEffect, useRef } from 'react';
import { useStore } from 'zustand';
import type { PanelProps } from '../engine/viewer.ts';
import type { FrameRecorder, Side } from './frame-recorder.ts';
import { HistoryChart } from './history-chart.ts';
import {
  cpuFigures,
  MEMORY_GROUPS,
  memoryByGroup,
  memoryFigures,
  PASSES,
  sideFigures,
} from './hud-figures.ts';
import type { HudMoment, LargeMoment } from './hud-moments.ts';
import { csvReport, jsonReport, type Recorded } from './hud-report.ts';
import { HudBar, HudRow } from './hud-row.tsx';

const REPORTS = {
  JSON: { write: jsonReport, type: 'application/json' },
  CSV: { write: csvReport, type: 'text/csv' },
} as const;
type ReportFormat = keyof typeof REPORTS;

const MEMORY_LABELS = {
  geometry: 'Splats',
  harmonics: 'Harmonics',
  bounds: 'Bounds',
  frames: 'Drawing frames',
  work: 'Temporary',
} as const;

export type SideFigures = ReturnType<typeof sideFigures>;

/** A side of the image with the figures that only the largest size shows. */
export interface LargeSide {
  readonly side: Side;
  /** A letter for people; null for an image that is not split. */
  readonly name: 'A' | 'B' | null;
  readonly figures: SideFigures;
  readonly frames: readonly FrameStatistics[];
}

export function largeSides({ state }: HudMoment, { frames }: LargeMoment, isSplit: boolean): LargeSide[] {
  const sides = isSplit ? (['left', 'right'] as const) : (['left'] as const);
  return sides.map((side) => ({
    side,
    name: isSplit ? (side === 'left' ? 'A' : 'B') : null,
    figures: sideFigures(side, state, frames[side]),
    frames: frames[side],
  }));
}

/** The times of the last frames, which can be frozen, copied and saved. */
export function HudHistory({
  store,
  viewer,
  recorder,
  sides,
}: PanelProps & { recorder: FrameRecorder; sides: readonly LargeSide[] }) {
  const isFrozen = useStore(store, (state) => state.isHudFrozen);
  const { copy, status, uncopied, area } = useCopy();
  const report = (format: ReportFormat) => REPORTS[format].write(recordedNow(viewer, recorder));
  const save = (format: ReportFormat) =>
    saveFile(
      new Blob([report(format)], { type: REPORTS[format].type }),
      `frame-figures.${format.toLowerCase()}`,
    );
  return (
    <div className="hud-history">
      {sides.map((each) => (
        <SideHistory key={each.side} {...each} />
      ))}
      <div className="hud-actions">
        <button
          type="button"
          className="chip"
          aria-pressed={isFrozen}
          data-testid="hud-freeze"
          onClick={() => store.setState({ isHudFrozen: !isFrozen })}
        >
          {isFrozen ? 'Frozen' : 'Freeze'}
        </button>
        {(Object.keys(REPORTS) as ReportFormat[]).map((format) => (
          <span key={format} className="hud-report">
            <button
              type="button"
              className="chip"
              data-testid={`hud-copy-${format.toLowerCase()}`}
              onClick={() => void copy(report(format), format)}
            >
              Copy {format}
            </button>
            <IconButton
              icon="save"
              label={`Download ${format}`}
              title={`Download ${format}`}
              testId={`hud-download-${format.toLowerCase()}`}
              onClick={() => save(format)}
            />
          </span>
        ))}
      </div>
      <p className="hud-note" role="status" data-testid="hud-copied">
        {status}
      </p>
      {uncopied && (
        <textarea
          ref={area}
          readOnly
          rows={4}
          aria-label="Report of the last frames"
          data-testid="hud-report"
          value={uncopied}
        />
      )}
    </div>
  );
}

function SideHistory({ side, name, figures, frames }: LargeSide) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const chart = useRef<HistoryChart>(null);
  useLayoutEffect(() => {
    if (!canvas.current) return;
    const created = new HistoryChart(canvas.current);
    chart.current = created;
    return () => created.destroy();
  }, []);
  useLayoutEffect(() => chart.current?.show(frames.map(({ timing }) => timing)), [frames]);
  return (
    <figure>
      <canvas
        ref={canvas}
        role="img"
        aria-label={`Times of the last frames${name ? ` of side ${name}` : ''}, a bar for each by stage`}
        data-testid={`history-${side}`}
      />
      <figcaption>
        {name && <b>{name}</b>}
        <span>
          <i className="line-median" aria-hidden="true" /> median <b>{figures.median}</b>
        </span>
        <span>
          <i className="line-p99" aria-hidden="true" /> P99 <b>{figures.p99}</b>
        </span>
        <span>
          peak <b data-testid={`${side}-peak`}>{figures.peak}</b> ms
        </span>
      </figcaption>
    </figure>
  );
}

/** Everything that the smaller sizes leave out, below their figures. */
export function HudDetails({
  large,
  sides: [{ figures: left }, rightSide],
}: {
  large: LargeMoment;
  sides: readonly LargeSide[];
}) {
  const right = rightSide?.figures;
  const render = cpuFigures(large.renderMs);
  const own = cpuFigures(large.ownMs);
  return (
    <>
      <dl>
        <HudRow
          label="Splat–bin pairs"
          figure={left.pairs}
          rightFigure={right?.pairs}
          title="A visible splat and a bin of 64 × 64 pixels that it may touch (tilePairs)"
          isOptional
          testId="tile-pairs"
        />
        <HudRow
          label="Sort keys"
          figure={left.sortKeys}
          rightFigure={right?.sortKeys}
          title="Bits of depth that splats are sorted by (sortKeyBits)"
          testId="sort-keys"
        />
        <HudRow
          label="Resolution of splats"
          figure={left.scale}
          rightFigure={right?.scale}
          title="Width of the layer that splats are blended in, as a part of the picture's (resolutionScale)"
        />
      </dl>
      <details className="hud-passes" data-testid="hud-passes">
        <summary>Passes within the stages</summary>
        <dl>
          {PASSES.map(([pass, label], i) => (
            <HudRow
              key={pass}
              label={label}
              title={pass}
              figure={left.passes[i]}
              rightFigure={right?.passes[i]}
              unit="ms"
              isOptional
              testId={`pass-${pass}`}
            />
          ))}
        </dl>
      </details>
      <dl>
        <HudRow
          label="CPU time of render calls"
          figure={render.median}
          unit="ms"
          title="Median of the last frames: all calls to the engine since the frame before"
          testId="render-ms"
        />
        <HudRow label="99th percentile" figure={render.p99} unit="ms" />
        <HudRow
          label="CPU time of this panel"
          figure={own.median}
          unit="ms"
          title="Median of the last frames, measured around all that this panel does"
          testId="own-ms"
        />
        <HudRow label="99th percentile" figure={own.p99} unit="ms" />
      </dl>
      <Memory memory={large.memory} />
    </>
  );
}

function Memory({ memory }: Pick<LargeMoment, 'memory'>) {
  const figures = memoryFigures(memory?.held ?? null, memory?.maxBufferBytes ?? Number.NaN);
  const bytes = memory && memoryByGroup(memory.held);
  return (
    <>
      <dl>
        <HudRow label="GPU memory" figure={figures.total} className="hud-total" testId="memory-total" />
      </dl>
      <HudBar parts={MEMORY_GROUPS.map((group) => [`hud-memory memory-${group}`, bytes?.[group] ?? 0])} />
      <dl className="hud-groups">
        {MEMORY_GROUPS.map((group) => (
          <HudRow
            key={group}
            label={MEMORY_LABELS[group]}
            figure={bytes ? formatBytes(bytes[group]) : ''}
            swatch={`hud-memory memory-${group}`}
            testId={`memory-${group}`}
          />
        ))}
        <HudRow label="Peak" figure={figures.peak} />
      </dl>
      <dl>
        <HudRow label="Largest buffer" figure={figures.largest} />
        <HudRow
          label="Limit of one buffer"
          figure={figures.limit}
          title="maxBufferSize of the device. WebGPU reports no limit for all buffers together."
          testId="memory-limit"
        />
      </dl>
    </>
  );
}

function recordedNow(viewer: PanelProps['viewer'], recorder: FrameRecorder): Recorded {
  const { engine } = viewer;
  return {
    state: recorder.shown,
    frames: { left: recorder.frames('left'), right: recorder.frames('right') },
    renderMs: recorder.renderMs,
    ownMs: recorder.ownMs,
    memory: engine?.memory() ?? null,
    maxBufferBytes: engine?.device.limits.maxBufferSize ?? null,
    maxBindingBytes: engine?.device.limits.maxStorageBufferBindingSize ?? null,
    program: navigator.userAgent,
    madeAt: new Date(),
  };
}
