import { useStore } from 'zustand';
import type { PanelProps } from '../engine/panel-props.ts';
import { IconButton } from '../ui/controls.tsx';
import { describeDrawn } from '../ui/detail-words.ts';
import { ERROR_CLASSES } from './error-map.ts';
import { mapped } from './mapped.ts';

/** The meaning of the error map's colours, and the part of the image that has each. */
export function ErrorMapLegend({ store, viewer }: PanelProps) {
  const figures = useStore(store, (state) => state.errorFigures);
  const drawn = useStore(store, (state) => describeDrawn(mapped(state)));
  return (
    <section className="panel error-legend" aria-label="Error map" data-testid="error-legend">
      <div className="spread">
        <p>
          <b>{drawn}</b> against reference, in steps of 1/255
        </p>
        <IconButton icon="close" label="End the comparison" onClick={() => viewer.compare(null)} />
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
