import { useCopy } from '@websplatter/kit/take-away';
import { useStore } from 'zustand';
import type { PanelProps } from '../engine/panel-props.ts';
import type { FrameRecorder } from './frame-recorder.ts';
import { csvReport, jsonReport, type Recorded } from './hud-report.ts';
import { HudRow } from './hud-row.tsx';
import { MEMORY_GROUPS } from './large-figures.ts';
import { PASSES } from './pass-names.ts';

const SIDES = [
  ['left', 'A'],
  ['right', 'B'],
] as const;

const REPORTS = { JSON: jsonReport, CSV: csvReport } as const;
type ReportFormat = keyof typeof REPORTS;

const MEMORY_LABELS = {
  geometry: 'Splats',
  harmonics: 'Their harmonics',
  bounds: 'Their bounds',
  frames: 'Drawing frames',
  work: 'Work under way',
} as const;

/** The times of the last frames, which can be frozen and copied. */
export function HudHistory({
  store,
  viewer,
  recorder,
  isSplit,
}: PanelProps & { recorder: FrameRecorder; isSplit: boolean }) {
  const isFrozen = useStore(store, (state) => state.isHudFrozen);
  const { copy, status, uncopied, area } = useCopy();
  return (
    <div className="hud-history">
      {SIDES.slice(0, isSplit ? 2 : 1).map(([side, name]) => (
        <figure key={side}>
          <canvas
            data-history={side}
            role="img"
            aria-label={`Times of the last frames${isSplit ? ` of side ${name}` : ''}, a bar for each by stage`}
            data-testid={`history-${side}`}
          />
          <figcaption>
            {isSplit && <b>{name}</b>}
            <span>
              <i className="line-median" aria-hidden="true" /> median <b data-figure={`${side}.median`} />
            </span>
            <span>
              <i className="line-p99" aria-hidden="true" /> P99 <b data-figure={`${side}.p99`} />
            </span>
            <span>
              peak <b data-figure={`${side}.peak`} data-testid={`${side}-peak`} /> ms
            </span>
          </figcaption>
        </figure>
      ))}
      <div className="hud-actions">
        <button
          type="button"
          className="chip"
          aria-pressed={isFrozen}
          data-testid="hud-freeze"
          onClick={() => store.setState({ isHudFrozen: !isFrozen })}
        >
          Freeze
        </button>
        {(Object.keys(REPORTS) as ReportFormat[]).map((format) => (
          <button
            key={format}
            type="button"
            className="chip"
            data-testid={`hud-copy-${format.toLowerCase()}`}
            onClick={() => void copy(REPORTS[format](recordedNow(viewer, recorder)), format)}
          >
            Copy {format}
          </button>
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

/** Everything that the smaller sizes leave out, below their figures. */
export function HudDetails({ isSplit }: { isSplit: boolean }) {
  const right = (name: string) => (isSplit ? `right.${name}` : undefined);
  return (
    <>
      <dl>
        <HudRow
          label="Pairs with bins"
          figure="left.pairs"
          rightFigure={right('pairs')}
          title="A visible splat and a bin of 64 × 64 pixels that it may touch (tilePairs)"
          isOptional
          testId="tile-pairs"
        />
        <HudRow
          label="Sort keys"
          figure="left.sortKeys"
          rightFigure={right('sortKeys')}
          title="Bits of depth that splats are sorted by (sortKeyBits)"
          testId="sort-keys"
        />
        <HudRow
          label="Resolution of splats"
          figure="left.scale"
          rightFigure={right('scale')}
          title="Width of the layer that splats are blended in, as a part of the picture's (resolutionScale)"
        />
      </dl>
      <details className="hud-passes" data-testid="hud-passes">
        <summary>Passes within the stages</summary>
        <dl>
          {PASSES.map(([pass, label]) => (
            <HudRow
              key={pass}
              label={label}
              title={pass}
              figure={`left.pass.${pass}`}
              rightFigure={right(`pass.${pass}`)}
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
          figure="renderMedian"
          unit="ms"
          title="Median of the last frames: all calls to the engine since the frame before"
          testId="render-ms"
        />
        <HudRow label="… 99th percentile" figure="renderP99" unit="ms" />
        <HudRow
          label="CPU time of these figures"
          figure="ownMedian"
          unit="ms"
          title="Median of the last frames, measured around all that this panel does"
          testId="own-ms"
        />
        <HudRow label="… 99th percentile" figure="ownP99" unit="ms" />
      </dl>
      <Memory />
    </>
  );
}

function Memory() {
  return (
    <>
      <dl>
        <HudRow label="GPU memory" figure="memory.total" className="hud-total" testId="memory-total" />
      </dl>
      <div className="hud-bar" aria-hidden="true">
        {MEMORY_GROUPS.map((group) => (
          <i key={group} className={`hud-memory memory-${group}`} data-share={`memory.${group}`} />
        ))}
      </div>
      <dl className="hud-groups">
        {MEMORY_GROUPS.map((group) => (
          <HudRow
            key={group}
            label={MEMORY_LABELS[group]}
            figure={`memory.${group}`}
            swatch={`hud-memory memory-${group}`}
            testId={`memory-${group}`}
          />
        ))}
        <HudRow label="Most so far" figure="memory.peak" />
      </dl>
      <dl>
        <HudRow label="Largest piece" figure="memory.largest" />
        <HudRow
          label="Limit of one buffer"
          figure="memory.limit"
          title="maxBufferSize of the device. WebGPU tells no limit of all buffers together."
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
