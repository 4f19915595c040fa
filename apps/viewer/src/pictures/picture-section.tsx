import { useState } from 'react';
import { useStore } from 'zustand';
import type { PanelProps } from '../viewer/panel-props.ts';
import { MOST_SIDE_PX, picturesOf } from './pictures.ts';

/** Sizes that are offered, times the window's. */
const FACTORS = [1, 2, 4] as const;

/** Saves the frame on the screen as a PNG. */
export function PictureSection({ store, viewer }: PanelProps) {
  const pictures = picturesOf(viewer, store);
  const windowWidthPx = useStore(store, (state) => state.widthPx);
  const windowHeightPx = useStore(store, (state) => state.heightPx);
  const picturing = useStore(store, (state) => state.picturing);
  const hasPicture = useStore(store, (state) => state.imageId > 0);
  const [chosenPx, setChosenPx] = useState<number | null>(null);
  const [isTransparent, setIsTransparent] = useState(false);
  const widthPx = chosenPx ?? windowWidthPx;
  const heightPx = Math.max(1, Math.round((widthPx * windowHeightPx) / Math.max(1, windowWidthPx)));
  const isPossible = Number.isInteger(widthPx) && widthPx >= 1 && Math.max(widthPx, heightPx) <= MOST_SIDE_PX;
  return (
    <section>
      <h3>Picture</h3>
      <fieldset className="chips" aria-label="Size of the picture">
        {FACTORS.map((factor) => (
          <button
            key={factor}
            type="button"
            className="chip"
            aria-pressed={widthPx === factor * windowWidthPx}
            data-testid={`picture-${factor}x`}
            onClick={() => setChosenPx(factor === 1 ? null : factor * windowWidthPx)}
          >
            {factor === 1 ? 'As shown' : `${factor}×`}
          </button>
        ))}
      </fieldset>
      <div className="picture-row">
        <label>
          Width{' '}
          <input
            type="number"
            min={1}
            max={MOST_SIDE_PX}
            value={Number.isNaN(widthPx) ? '' : widthPx}
            data-testid="picture-width"
            onChange={(event) => setChosenPx(event.target.valueAsNumber)}
          />
        </label>
        <span>{isPossible ? `${widthPx} × ${heightPx} px` : `1 to ${MOST_SIDE_PX} px`}</span>
      </div>
      <label className="picture-row">
        <span>
          <input
            type="checkbox"
            checked={isTransparent}
            data-testid="picture-transparent"
            onChange={(event) => setIsTransparent(event.target.checked)}
          />{' '}
          Without the background
        </span>
      </label>
      {picturing ? (
        <div className="runner" data-testid="picturing">
          <div className="runner-row">
            <p>Drawing: {picturing.fileName}</p>
            <button type="button" className="text-button" onClick={() => pictures.cancel()}>
              Cancel
            </button>
          </div>
          <progress aria-label={`Drawing ${picturing.fileName}`} value={picturing.part} max={1} />
        </div>
      ) : (
        <button
          type="button"
          className="text-button primary"
          disabled={!hasPicture || !isPossible}
          data-testid="save-picture"
          onClick={() => void pictures.start({ widthPx, heightPx, isTransparent })}
        >
          Save .png
        </button>
      )}
    </section>
  );
}
