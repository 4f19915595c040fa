import { Choices } from '@websplatter/kit/choices';
import { TextButton } from '@websplatter/kit/controls';
import { formatCount, formatSplats } from '@websplatter/kit/format';
import { useStore } from 'zustand';
import type { Crop } from '../state/inspecting.ts';
import { leftSplats } from '../state/left-splats.ts';
import { clamp } from '../state/vec3.ts';
import { NumberField } from '../ui/number-field.tsx';
import { Slider } from '../ui/slider.tsx';
import { StepActions } from './actions.tsx';
import { SLIDER_STEPS, sliderPosition, sliderValue, withSide } from './cropping.ts';
import type { InspectProps } from './inspection.ts';

/** Range of the sliders beyond the scene's bounding box, as a fraction of its size. */
const MARGIN = 0.25;

const KEPT = [
  ['inside', 'Keep the inside'],
  ['outside', 'Keep the outside'],
] as const;

/** Controls for cropping the scene to a box. */
export function CropTab({ store, inspection }: InspectProps) {
  const crop = useStore(store, (state) => state.inspecting.crop);
  const left = useStore(store, leftSplats);
  const total = useStore(store, (state) => state.scene?.splats ?? 0);
  const canSave = useStore(store, (state) => state.scene?.canSave ?? false);
  const { cropping } = inspection;
  if (!crop) {
    return (
      <div className="inspect-sections">
        <p>Shows and saves only what is within a box, or only what is outside of it.</p>
        <div className="inspect-actions">
          <TextButton look="primary" testId="crop-begin" onClick={() => cropping.begin()}>
            Crop to a box
          </TextButton>
          <CropToView inspection={inspection} />
          <StepActions store={store} />
        </div>
      </div>
    );
  }
  return (
    <div className="inspect-sections">
      <Choices
        label="What stays"
        choices={KEPT}
        chosen={crop.keep}
        testId="crop-"
        onChoose={(keep) => cropping.set({ ...crop, keep })}
      />
      {[0, 1, 2].map((axis) => (
        <Sides key={axis} inspection={inspection} crop={crop} axis={axis} />
      ))}
      <p>Drag a handle in the picture. Faces behind the camera have none: move them by their sliders.</p>
      <p data-testid="crop-count" role="status">
        {left !== null && `${formatCount(left)} of ${formatSplats(total)} stay.`}
      </p>
      <div className="inspect-actions">
        <CropToView inspection={inspection} />
        <TextButton
          title="The box around what the first view shows, without far surroundings"
          testId="crop-to-subject"
          onClick={() => cropping.cropToSubject()}
        >
          Crop to the subject
        </TextButton>
        <TextButton testId="crop-whole" onClick={() => cropping.begin()}>
          Box around everything
        </TextButton>
        <StepActions store={store} />
        <TextButton testId="crop-end" onClick={() => cropping.set(null)}>
          Show everything
        </TextButton>
        {canSave && (
          <TextButton
            look="primary"
            testId="crop-save"
            onClick={() => store.setState({ dock: 'save', saveTab: 'file' })}
          >
            Save the rest as a file
          </TextButton>
        )}
      </div>
    </div>
  );
}

function CropToView({ inspection }: Pick<InspectProps, 'inspection'>) {
  return (
    <TextButton
      title="The smallest box around all splats that are within the picture, however deep"
      testId="crop-to-view"
      onClick={() => void inspection.cropping.cropToView()}
    >
      Crop to what is seen
    </TextButton>
  );
}

interface AxisProps extends Pick<InspectProps, 'inspection'> {
  readonly crop: Crop;
  readonly axis: number;
}

/** Sliders for both faces of the box along an axis. */
function Sides({ inspection, crop, axis }: AxisProps) {
  const { cropping } = inspection;
  const scene = cropping.sceneBox ?? crop;
  const margin = MARGIN * (scene.max[axis] - scene.min[axis]) || 1;
  const low = Math.min(crop.min[axis], scene.min[axis] - margin);
  const high = Math.max(crop.max[axis], scene.max[axis] + margin);
  const range = { low, high, middle: clamp(cropping.place.center[axis], low, high) };
  return (
    <fieldset className="inspect-sides">
      <legend>{'xyz'[axis]}</legend>
      {(['min', 'max'] as const).map((side) => {
        const name = `${side === 'min' ? 'Min' : 'Max'} ${'xyz'[axis]}`;
        const testId = `crop-${side}-${'xyz'[axis]}`;
        const value = Number(crop[side][axis].toPrecision(5));
        const set = (place: number, gesture: object) =>
          cropping.set(withSide(crop, side, axis, place), gesture);
        return (
          <Slider
            key={side}
            label={name}
            min={0}
            max={SLIDER_STEPS}
            value={sliderPosition(crop[side][axis], range)}
            shown={
              <NumberField
                label={`${name}, as a number`}
                value={value}
                step="any"
                testId={`${testId}-number`}
                onChange={set}
              />
            }
            aria-valuetext={String(value)}
            testId={testId}
            onValue={(position, gesture) => set(sliderValue(position, range), gesture)}
          />
        );
      })}
    </fieldset>
  );
}
