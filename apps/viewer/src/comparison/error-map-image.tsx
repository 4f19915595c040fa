import { useEffect, useRef } from 'react';
import { useStore } from 'zustand';
import type { AccuracyProps } from '../accuracy/accuracy-settings.tsx';
import { Icon } from '../ui/icon.tsx';
import { describeAccuracy } from '../words/accuracy-text.ts';
import { ERROR_CLASSES } from './error-map.ts';
import { showErrorMap } from './error-map-overlay.ts';

/** The error map over the viewer's canvas. */
export function ErrorPicture({ store, viewer }: AccuracyProps) {
  const canvas = useRef<HTMLCanvasElement>(null);
  useEffect(
    () => (canvas.current ? showErrorMap(canvas.current, viewer, store) : undefined),
    [store, viewer],
  );
  return <canvas ref={canvas} className="error-map" data-testid="error-map" />;
}

/** What the colours of the error map mean, and how much of the picture has which. */
export function ErrorLegend({ store, viewer }: AccuracyProps) {
  const isShown = useStore(store, (state) => state.comparison?.kind === 'error');
  const figures = useStore(store, (state) => state.errorFigures);
  const accuracy = useStore(store, (state) => state.accuracy);
  if (!isShown) return null;
  return (
    <section className="panel error-legend" aria-label="Error map" data-testid="error-legend">
      <div className="error-legend-row">
        <p>
          <b>{describeAccuracy(accuracy)}</b> against reference, in steps of 1/255
        </p>
        <button
          type="button"
          className="icon-button"
          aria-label="End the comparison"
          onClick={() => viewer.compare(null)}
        >
          <Icon name="close" />
        </button>
      </div>
      <ol>
        {ERROR_CLASSES.map(({ label, color }, index) => (
          <li key={label}>
            <i style={{ background: `rgb(${color.join(' ')})` }} aria-hidden="true" />
            <span>{label}</span>
            <small data-testid={`error-part-${label}`}>
              {figures ? formatPart(figures.parts[index]) : ''}
            </small>
          </li>
        ))}
      </ol>
      <p role="status" data-testid="error-max">
        {figures ? `Largest error: ${formatSteps(figures.maxSteps)} of 255` : 'Comparing…'}
      </p>
    </section>
  );
}

function formatPart(part: number): string {
  if (part === 0) return '0 %';
  return part < 0.001 ? '< 0.1 %' : `${(100 * part).toFixed(1)} %`;
}

function formatSteps(steps: number): string {
  return steps > 0 && steps < 0.01 ? 'less than 0.01' : String(Number(steps.toFixed(2)));
}
