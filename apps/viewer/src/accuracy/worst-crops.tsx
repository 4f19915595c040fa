import { useStore } from 'zustand';
import type { JudgedPictures } from '../state/measured.ts';
import { nearestPreset } from '../state/nearest-preset.ts';
import type { ViewerStore } from '../state/store.ts';
import { Pixels } from './looked-picture.tsx';
import { CROP_PX } from './worst-crop.ts';

/**
 * The part of the picture where a preset errs most, magnified, beside the reference: of the preset
 * under the pointer, or the one that is drawn, or else the last one.
 */
export function WorstCrops({
  store,
  pictures,
}: {
  readonly store: ViewerStore;
  readonly pictures: JudgedPictures;
}) {
  const looked = useStore(store, (state) => state.looked);
  const drawn = useStore(store, (state) => nearestPreset(state.accuracy).preset);
  const names = Object.keys(pictures).filter((name) => name !== 'reference');
  const name = [looked, drawn].find((each) => each !== null && names.includes(each)) ?? names.at(-1);
  const picture = name && pictures[name];
  if (!picture) return null;
  return (
    <div className="worst-crops" data-testid="worst-crops">
      <figure>
        <Pixels image={picture.reference} />
        <figcaption>reference</figcaption>
      </figure>
      <figure>
        <Pixels image={picture.actual} />
        <figcaption>{name}</figcaption>
      </figure>
      <p>
        The {CROP_PX} × {CROP_PX} pixels where {name} errs most.
      </p>
    </div>
  );
}
