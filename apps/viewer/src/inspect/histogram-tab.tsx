import { formatCount, formatSplats } from '@websplatter/kit/format';
import { useId } from 'react';
import { useStore } from 'zustand';
import { barHeight, medianBin } from '../scene/histogram.ts';
import { type Histogram, QUANTITIES, type Quantity } from '../state/inspecting.ts';
import type { InspectProps } from './inspection.ts';
import { formatFigure } from './length-scale.ts';

const TITLES: Readonly<Record<Quantity, string>> = {
  longest: 'Longest axis',
  shortest: 'Shortest axis',
  opacity: 'Opacity',
};

/** Histograms of the splats' sizes and opacities. */
export function HistogramTab({ store, inspection }: InspectProps) {
  const histograms = useStore(store, (state) => state.inspecting.histograms);
  return (
    <div className="inspect-sections">
      <p>
        Standard deviations are in scene units. The height of a bar is the logarithm of its count. Move a
        slider to mark the splats of a bar in the picture.
      </p>
      {histograms &&
        QUANTITIES.map((quantity) => (
          <HistogramChart
            key={quantity}
            store={store}
            inspection={inspection}
            quantity={quantity}
            histogram={histograms[quantity]}
          />
        ))}
    </div>
  );
}

function HistogramChart({
  store,
  inspection,
  quantity,
  histogram,
}: InspectProps & { quantity: Quantity; histogram: Histogram }) {
  const marked = useStore(store, (state) => state.inspecting.marked);
  const id = useId();
  const { edges, counts } = histogram;
  const most = Math.max(...counts);
  const bin = marked?.quantity === quantity ? marked.bin : null;
  const rangeOf = (each: number) => `${formatFigure(edges[each], 2)} to ${formatFigure(edges[each + 1], 2)}`;
  const shown = bin ?? medianBin(histogram);
  const textOf = (each: number) => `${rangeOf(each)}: ${formatSplats(counts[each])}`;
  return (
    <section className="inspect-histogram" data-testid={`histogram-${quantity}`}>
      <h3 id={id}>{TITLES[quantity]}</h3>
      <div className="inspect-bars" aria-hidden="true">
        {counts.map((count, i) => (
          <i
            key={edges[i]}
            data-marked={i === bin || undefined}
            style={{ height: `${100 * barHeight(count, most)}%` }}
          />
        ))}
      </div>
      <input
        type="range"
        min={0}
        max={counts.length - 1}
        value={shown}
        aria-labelledby={id}
        aria-valuetext={textOf(shown)}
        data-testid={`mark-${quantity}`}
        onChange={({ target }) => void inspection.histograms.mark({ quantity, bin: target.valueAsNumber })}
      />
      <div className="inspect-axis" aria-hidden="true">
        <span>{formatFigure(edges[0], 2)}</span>
        <span>{formatFigure(edges[edges.length - 1], 2)}</span>
      </div>
      <p className="inspect-marked">
        {bin === null ? `Median: ${rangeOf(shown)}` : textOf(bin)}
        {bin !== null && (
          <button type="button" className="disclosure" onClick={() => void inspection.histograms.mark(null)}>
            Clear marks
          </button>
        )}
      </p>
      <details>
        <summary>Counts as a table</summary>
        <table>
          <thead>
            <tr>
              <th scope="col">{TITLES[quantity]}</th>
              <th scope="col">Splats</th>
            </tr>
          </thead>
          <tbody>
            {counts.map((count, i) => (
              <tr key={edges[i]}>
                <th scope="row">{rangeOf(i)}</th>
                <td>{formatCount(count)}</td>
              </tr>
            ))}
          </tbody>
        </table>
      </details>
    </section>
  );
}
