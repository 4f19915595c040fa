import type { AccuracyPoint } from '@websplatter/core/measure';
import { useEffect, useRef } from 'react';
import { AccuracyChart } from './accuracy-chart.ts';

/** uPlot's chart as a component. */
export function ErrorTimeChart({
  points,
  current,
  onPick,
  onLook,
}: {
  points: readonly AccuracyPoint[];
  current: number;
  onPick: (index: number) => void;
  onLook: (index: number | null) => void;
}) {
  const root = useRef<HTMLDivElement>(null);
  const chart = useRef<AccuracyChart | null>(null);
  const events = useRef({ onPick, onLook });
  events.current = { onPick, onLook };
  useEffect(() => {
    if (!root.current) return;
    const made = new AccuracyChart(root.current, {
      onPick: (index) => events.current.onPick(index),
      onLook: (index) => events.current.onLook(index),
    });
    chart.current = made;
    return () => {
      chart.current = null;
      made.destroy();
    };
  }, []);
  useEffect(() => chart.current?.show({ points, current }), [points, current]);
  return (
    // biome-ignore lint/a11y/useSemanticElements: a fieldset would bring its own layout into uPlot's.
    <div ref={root} className="chart" role="group" aria-label="Error against time" data-testid="chart" />
  );
}
