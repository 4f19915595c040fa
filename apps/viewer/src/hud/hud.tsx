import { memo, useEffect, useRef } from 'react';
import { useStore } from 'zustand';
import type { PanelProps } from '../engine/panel-props.ts';
import { HUD_SIZES, type HudSize } from '../state/page.ts';
import { IconButton } from '../ui/controls.tsx';
import { recorderOf } from './frame-recorder.ts';
import { bindHud } from './hud-binding.ts';
import { HudDetails, HudHistory } from './hud-details.tsx';
import { HudRow } from './hud-row.tsx';

const STAGES = [
  ['preprocess', 'Pre-process'],
  ['sort', 'Sort'],
  ['rasterize', 'Rasterise'],
  ['rest', 'Rest'],
] as const;

/** The cost of the frame. React renders it once; figures are then written into it directly. */
export const Hud = memo(function Hud({ store, viewer }: PanelProps) {
  const recorder = recorderOf(store);
  const size = useStore(store, (state) => state.hudSize);
  const isSplit = useStore(store, (state) => state.comparison?.kind === 'split');
  const root = useRef<HTMLElement>(null);
  // Another size or side has other elements.
  // biome-ignore lint/correctness/useExhaustiveDependencies: see above.
  useEffect(() => {
    if (root.current) return bindHud(root.current, { store, recorder, engine: () => viewer.engine });
  }, [store, viewer, recorder, size, isSplit]);
  const isLarge = size === 'large';
  // Only the largest size says that figures are frozen.
  const resize = (hudSize: HudSize) =>
    store.setState({ hudSize, ...(hudSize !== 'large' && { isHudFrozen: false }) });
  return (
    <section
      ref={root}
      className="panel hud"
      aria-label="Frame figures"
      data-testid="hud"
      data-size={size}
      data-split={isSplit || undefined}
    >
      <div className="spread hud-pace">
        <span title="From frame to frame">
          <b data-figure="frameMs" /> ms
        </span>
        <span className="hud-rate">
          <b data-figure="rate" /> <span data-figure="rateUnit" />
        </span>
        <SizeButtons size={size} onChange={resize} />
      </div>
      {size !== 'small' && (
        <>
          <StageBar prefix="" />
          {isSplit && <StageBar prefix="right." />}
          {isLarge && <HudHistory store={store} viewer={viewer} recorder={recorder} isSplit={isSplit} />}
          <StageTimes isSplit={isSplit} />
          <FrameFacts isSplit={isSplit} isLarge={isLarge} />
          {isLarge && <HudDetails isSplit={isSplit} />}
          <dl className="hud-device">
            <HudRow label="Picture" figure="resolution" testId="resolution" />
            <HudRow label="GPU" figure="adapter" testId="adapter" />
          </dl>
        </>
      )}
    </section>
  );
});

function SizeButtons({ size, onChange }: { size: HudSize; onChange: (size: HudSize) => void }) {
  const at = HUD_SIZES.indexOf(size);
  const steps = [
    ['fewer', 'Fewer figures', at - 1],
    ['moreFigures', 'More figures', at + 1],
  ] as const;
  return (
    <span className="hud-sizes">
      {steps.map(([icon, label, goal]) => (
        <IconButton
          icon={icon}
          key={icon}
          label={label}
          title={label}
          disabled={HUD_SIZES[goal] === undefined}
          testId={`hud-${icon === 'fewer' ? 'fewer' : 'more'}`}
          onClick={() => onChange(HUD_SIZES[goal])}
        />
      ))}
    </span>
  );
}

function StageBar({ prefix }: { prefix: '' | 'right.' }) {
  return (
    <div className="hud-bar" aria-hidden="true">
      {STAGES.map(([name]) => (
        <i key={name} className={`stage-${name}`} data-share={`${prefix}${name}`} />
      ))}
    </div>
  );
}

function StageTimes({ isSplit }: { isSplit: boolean }) {
  return (
    <>
      <dl>
        {isSplit && (
          <div className="hud-sides">
            <dt>Side</dt>
            <dd>A</dd>
            <dd>B</dd>
          </div>
        )}
        {STAGES.map(([name, label]) => (
          <HudRow
            key={name}
            label={label}
            figure={name}
            rightFigure={isSplit ? `right.${name}` : undefined}
            unit="ms"
            swatch={`stage-${name}`}
            testId={`${name}-ms`}
          />
        ))}
        <HudRow
          label="Total on the GPU"
          figure="total"
          rightFigure={isSplit ? 'right.total' : undefined}
          unit="ms"
          className="hud-total"
          testId="total-ms"
        />
      </dl>
      <p className="hud-source" data-figure="source" data-testid="timing-source" />
    </>
  );
}

function FrameFacts({ isSplit, isLarge }: { isSplit: boolean; isLarge: boolean }) {
  return (
    <dl>
      <div data-title="rasterizerReason">
        <dt>Rasteriser</dt>
        <dd>
          <span data-figure="rasterizer" data-testid="rasterizer" />{' '}
          {!isSplit && <small data-figure="otherRasterizer" data-testid="other-rasterizer" />}{' '}
          <span
            className={isLarge && !isSplit ? 'hud-reason' : 'visually-hidden'}
            data-figure="rasterizerReason"
            data-testid="rasterizer-reason"
          />
        </dd>
        {isSplit && (
          <dd data-title="right.rasterizerReason">
            <span data-figure="right.rasterizer" data-testid="right-rasterizer" />{' '}
            <span className="visually-hidden" data-figure="right.rasterizerReason" />
          </dd>
        )}
      </div>
      {isLarge && (
        <HudRow
          label="Candidates"
          figure="left.candidates"
          rightFigure={isSplit ? 'right.candidates' : undefined}
          title="Splats of the chunks that reach into the picture (candidateSplats)"
          testId="candidate-splats"
        />
      )}
      <HudRow
        label="Visible"
        figure="visible"
        rightFigure={isSplit ? 'right.visible' : undefined}
        title="Splats, and blobs in place of several, that culling kept; all of them are drawn (visibleSplats)"
        testId="visible-splats"
      />
      <HudRow label="Loaded" figure="loaded" testId="loaded-splats" />
      <HudRow
        label="Bricks"
        figure="bricks"
        title="Parts of the scene on the GPU; parts that this view would draw as well are missing"
        isOptional
        testId="bricks"
      />
      <HudRow label="Fetched" figure="fetched" isOptional testId="fetched" />
      <HudRow label="Detail" figure="detail" isOptional testId="detail" />
    </dl>
  );
}
