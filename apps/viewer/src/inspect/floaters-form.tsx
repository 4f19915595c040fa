import { Choices } from '@websplatter/kit/choices';
import { useEffect, useMemo, useState } from 'react';
import { useStore } from 'zustand';
import type { Region } from '../scene/inspect-messages.ts';
import type { LengthScale } from '../state/inspecting.ts';
import { leftSplats } from '../state/left-splats.ts';
import type { FloaterFilter } from '../state/selecting.ts';
import { Slider } from '../ui/slider.tsx';
import { Action, ofLeft } from './actions.tsx';
import type { InspectProps } from './inspection.ts';
import { formatFigure, formatLength } from './length-scale.ts';

/** Steps of the slider. */
const STEPS = 100;

interface Filter {
  readonly label: string;
  readonly hint: string;
  readonly limit: string;
  /** The slider's first position. */
  readonly first: number;
  /**
   * The limit at a position, 0…1.
   *
   * @param radius the subject's, scene units.
   */
  readonly limitAt: (position: number, radius: number) => number;
  readonly format: (limit: number, scale: LengthScale | null) => string;
}

/** From a thousandth of the subject's radius to all of it. */
const lengthAt = (position: number, radius: number) => radius * 10 ** (3 * position - 3);

const FILTERS: Readonly<Record<FloaterFilter, Filter>> = {
  far: {
    label: 'Far from others',
    hint: 'Splats that have fewer than eight others within this distance.',
    limit: 'Distance',
    first: 0.6,
    limitAt: lengthAt,
    format: formatLength,
  },
  huge: {
    label: 'Huge',
    hint: 'Splats whose longest axis is at least this long (one standard deviation).',
    limit: 'Length',
    first: 0.8,
    limitAt: lengthAt,
    format: formatLength,
  },
  faint: {
    label: 'Faint',
    hint: 'Splats of at most this opacity.',
    limit: 'Opacity',
    first: 0.05,
    limitAt: (position) => position,
    format: (opacity) => `${Math.round(100 * opacity)} %`,
  },
  needle: {
    label: 'Needles',
    hint: 'Splats that are at least so many times as long as wide.',
    limit: 'Length to width',
    first: 0.4,
    limitAt: (position) => 2 * 100 ** position,
    format: (ratio) => `${formatFigure(ratio, 2)} to 1`,
  },
};
const CHOICES = (Object.keys(FILTERS) as FloaterFilter[]).map((name) => [name, FILTERS[name].label] as const);
const FIRST = Object.fromEntries(CHOICES.map(([name]) => [name, FILTERS[name].first])) as Readonly<
  Record<FloaterFilter, number>
>;

/** Finds splats that are mostly mistakes of a training. Counts nothing before it is opened. */
export function FloatersForm(props: InspectProps) {
  const [isOpen, setOpen] = useState(false);
  return (
    <details className="inspect-floaters" onToggle={({ currentTarget }) => setOpen(currentTarget.open)}>
      <summary data-testid="floaters">Find floaters</summary>
      {isOpen && <Filters {...props} />}
    </details>
  );
}

/** A filter with its limit: says how many splats are beyond it, and selects them. */
function Filters({ store, inspection }: InspectProps) {
  const [filter, setFilter] = useState<FloaterFilter>('far');
  const [positions, setPositions] = useState(FIRST);
  const { label, hint, limit, limitAt, format } = FILTERS[filter];
  const scale = useStore(store, (state) => state.inspecting.scale);
  const { radius } = inspection.cropping.place;
  const value = Number(limitAt(positions[filter], radius).toPrecision(3));
  const region = useMemo<Region>(() => ({ kind: 'floaters', filter, limit: value }), [filter, value]);
  const { found, part } = useFoundCount({ store, inspection }, region);
  const left = useStore(store, leftSplats);
  const shown = format(value, scale);
  return (
    <div className="inspect-sections">
      <Choices
        label="Which splats"
        choices={CHOICES}
        chosen={filter}
        testId="floaters-"
        isChips
        onChoose={setFilter}
      />
      <p>{hint}</p>
      <Slider
        key={filter}
        label={limit}
        min={0}
        max={STEPS}
        value={Math.round(STEPS * positions[filter])}
        shown={shown}
        aria-valuetext={shown}
        testId="floaters-limit"
        onValue={(step) => setPositions({ ...positions, [filter]: step / STEPS })}
      />
      <p role="status" data-testid="floaters-count">
        {found === null ? 'Counting…' : `Would select ${ofLeft(found, left)}.`}
      </p>
      {part !== null && <progress aria-label={`Counting splats: ${label}`} value={part} max={1} />}
      <div className="inspect-actions">
        <Action
          testId="floaters-select"
          isOff={!found}
          onClick={() => void inspection.selecting.select(region)}
        >
          Select them
        </Action>
      </div>
    </div>
  );
}

/** How many splats a region would select; null until it is counted. `part` is null at rest. */
function useFoundCount({ store, inspection }: InspectProps, region: Region) {
  const crop = useStore(store, (state) => state.inspecting.crop);
  const removed = useStore(store, (state) => state.inspecting.selecting.removed);
  const parts = useStore(store, (state) => state.scene?.parts);
  const [found, setFound] = useState<number | null>(null);
  const [part, setPart] = useState<number | null>(null);
  // biome-ignore lint/correctness/useExhaustiveDependencies: all of them change what is found.
  useEffect(() => {
    let isWanted = true;
    setFound(null);
    void inspection.selecting
      .count(
        region,
        () => isWanted,
        (done) => isWanted && setPart(done),
      )
      .then((count) => {
        if (!isWanted) return;
        setFound(count ?? null);
        setPart(null);
      });
    return () => {
      isWanted = false;
    };
  }, [inspection, region, crop, removed, parts]);
  return { found, part };
}
