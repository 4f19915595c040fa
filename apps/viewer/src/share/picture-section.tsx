import { type Choice, Choices } from '@websplatter/kit/choices';
import { TextButton } from '@websplatter/kit/controls';
import { useState } from 'react';
import { useStore } from 'zustand';
import type { PanelProps } from '../engine/viewer.ts';
import { Running } from '../ui/running.tsx';
import { MOST_SIDE_PX, picturesOf } from './pictures.ts';

/** Sizes that are offered, times the window's. */
const FACTORS: readonly Choice<number>[] = [
  [1, 'As shown', '1x'],
  [2, '2×', '2x'],
  [4, '4×', '4x'],
];

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
      <Choices
        label="Size of the picture"
        isChips
        choices={FACTORS}
        chosen={widthPx / windowWidthPx}
        testId="picture-"
        onChoose={(factor) => setChosenPx(factor === 1 ? null : factor * windowWidthPx)}
      />
      <div className="spread picture-row">
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
      <label className="spread picture-row">
        <span>
          <input
            type="checkbox"
            checked={isTransparent}
            data-testid="picture-transparent"
            onChange={(event) => setIsTransparent(event.target.checked)}
          />{' '}
          Transparent background
        </span>
      </label>
      {picturing ? (
        <Running
          label={`Drawing: ${picturing.fileName}`}
          about={`Drawing ${picturing.fileName}`}
          value={picturing.part}
          max={1}
          onCancel={() => pictures.cancel()}
          testId="picturing"
        />
      ) : (
        <TextButton
          look="primary"
          disabled={!hasPicture || !isPossible}
          testId="save-picture"
          onClick={() => void pictures.start({ widthPx, heightPx, isTransparent })}
        >
          Save .png
        </TextButton>
      )}
    </section>
  );
}
