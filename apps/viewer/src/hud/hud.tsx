import { IconButton } from '@websplatter/kit/controls';
import { memo, useMemo, useSyncExternalStore } from 'react';
import { useStore } from 'zustand';
import type { PanelProps } from '../engine/viewer.ts';
import { HUD_SIZES, type HudSize } from '../state/page.ts';
import { recorderOf } from './frame-recorder.ts';
import { HudDetails, HudHistory, largeSides } from './hud-details.tsx';
import { frameFigures, headline, type StageFigures, stageFigures, stageShares } from './hud-figures.ts';
import { hudMoments } from './hud-moments.ts';
import { HudBar, HudRow } from './hud-row.tsx';

const STAGES = [
  ['preprocess', 'Pre-process'],
  ['sort', 'Sort'],
  ['rasterize', 'Rasterise'],
  ['rest', 'Other'],
] as const;

/** Windows in which more than one line of figures would lie over the subject. */
const NARROW = matchMedia('(max-width: 1000px)');
const isNarrowNow = () => NARROW.matches;
function observeNarrow(onChange: () => void): () => void {
  NARROW.addEventListener('change', onChange);
  return () => NARROW.removeEventListener('change', onChange);
}

/** The cost of the frame, slowly enough to be read. */
export const Hud = memo(function Hud({ store, viewer }: PanelProps) {
  const recorder = recorderOf(store);
  const chosenSize = useStore(store, (state) => state.hudSize);
  const isNarrow = useSyncExternalStore(observeNarrow, isNarrowNow);
  const size = chosenSize ?? (isNarrow ? 'small' : 'medium');
  const isFrozen = useStore(store, (state) => state.isHudFrozen);
  const isSplit = useStore(store, (state) => state.comparison?.kind === 'split');
  const isLarge = size === 'large';
  // Another size or side has figures at once.
  // biome-ignore lint/correctness/useExhaustiveDependencies: see above.
  const moments = useMemo(
    () => hudMoments({ store, recorder, engine: () => viewer.engine }, isLarge),
    [store, viewer, recorder, isLarge, isSplit],
  );
  const moment = useSyncExternalStore(moments.subscribe, moments.getSnapshot);
  const { state, large } = moment;
  const frame = frameFigures(state);
  const { figure, unit, about } = headline(state);
  const left = stageFigures('left', state);
  const right = isSplit ? stageFigures('right', state) : undefined;
  const sides = large && largeSides(moment, large, isSplit);
  // Only the largest size says that figures are frozen.
  const resize = (hudSize: HudSize) =>
    store.setState({ hudSize, ...(hudSize !== 'large' && { isHudFrozen: false }) });
  return (
    <section
      className="panel hud"
      aria-label="Frame figures"
      data-testid="hud"
      data-size={size}
      data-split={isSplit || undefined}
      data-frozen={isFrozen || undefined}
    >
      <div className="spread hud-pace">
        <p data-testid="hud-headline">
          <span>
            <b>{figure}</b> {unit}
          </span>{' '}
          <span>{isFrozen ? `${about} · frozen` : about}</span>
        </p>
        <SizeButtons size={size} onChange={resize} />
      </div>
      {size !== 'small' && (
        <>
          <StageBar shares={stageShares(state.statistics)} />
          {isSplit && <StageBar shares={stageShares(state.rightStatistics)} />}
          {sides && <HudHistory store={store} viewer={viewer} recorder={recorder} sides={sides} />}
          <StageTimes left={left} right={right} />
          <FrameFacts frame={frame} left={left} right={right} isLarge={isLarge} />
          {large && sides && <HudDetails large={large} sides={sides} />}
          <dl className="hud-device">
            <HudRow label="Picture" figure={frame.resolution} testId="resolution" />
            <HudRow label="GPU" figure={frame.adapter} testId="adapter" />
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

function StageBar({ shares }: { shares: ReturnType<typeof stageShares> }) {
  return <HudBar parts={STAGES.map(([name]) => [`stage-${name}`, shares[name]])} />;
}

interface Sides {
  left: StageFigures;
  /** Undefined for an image that is not split. */
  right: StageFigures | undefined;
}

function StageTimes({ left, right }: Sides) {
  return (
    <>
      <dl>
        {right && (
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
            figure={left[name]}
            rightFigure={right?.[name]}
            unit="ms"
            swatch={`stage-${name}`}
            testId={`${name}-ms`}
          />
        ))}
        <HudRow
          label={left.totalLabel}
          figure={left.total}
          rightFigure={right?.total}
          unit="ms"
          className="hud-total"
          testId="total-ms"
        />
      </dl>
      <p className="hud-source" data-testid="timing-source">
        {left.source}
      </p>
    </>
  );
}

function FrameFacts({
  frame,
  left,
  right,
  isLarge,
}: Sides & { frame: ReturnType<typeof frameFigures>; isLarge: boolean }) {
  return (
    <dl>
      <div title={left.rasterizerReason}>
        <dt>Rasteriser</dt>
        <dd>
          <span data-testid="rasterizer">{left.rasterizer}</span>{' '}
          {!right && <small data-testid="other-rasterizer">{left.otherRasterizer}</small>}{' '}
          <span
            className={isLarge && !right ? 'hud-reason' : 'visually-hidden'}
            data-testid="rasterizer-reason"
          >
            {left.rasterizerReason}
          </span>
        </dd>
        {right && (
          <dd title={right.rasterizerReason}>
            <span data-testid="right-rasterizer">{right.rasterizer}</span>{' '}
            <span className="visually-hidden">{right.rasterizerReason}</span>
          </dd>
        )}
      </div>
      {isLarge && (
        <HudRow
          label="After coarse culling"
          figure={left.candidates}
          rightFigure={right?.candidates}
          title="Splats of the chunks that reach into the picture (candidateSplats)"
          testId="candidate-splats"
        />
      )}
      <HudRow
        label="Drawn"
        figure={left.visible}
        rightFigure={right?.visible}
        title="Splats that this view draws, because culling kept them; a merged splat stands for several (visibleSplats)"
        testId="visible-splats"
      />
      <HudRow
        label="Left"
        figure={frame.left}
        title="Splats that are neither removed nor cropped away nor hidden"
        isOptional
        testId="left-splats"
      />
      <HudRow label="Loaded" figure={frame.loaded} testId="loaded-splats" />
      <HudRow
        label="Bricks"
        figure={frame.bricks}
        title="Parts of the scene that are on the GPU. This view also needs the missing ones."
        isOptional
        testId="bricks"
      />
      <HudRow label="Fetched" figure={frame.fetched} isOptional testId="fetched" />
      <HudRow label="Detail" figure={frame.detail} isOptional testId="detail" />
    </dl>
  );
}
