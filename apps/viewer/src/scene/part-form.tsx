import { Choices } from '@websplatter/kit/choices';
import { TextButton } from '@websplatter/kit/controls';
import { placedLook, placementOf, uprightPlacement } from '../engine/open/placement.ts';
import type { PanelProps } from '../engine/viewer.ts';
import { PLAIN_LOOK, type ScenePartSummary } from '../state/scene-part.ts';
import { UP_CHOICES } from '../state/up-axis.ts';
import { type Vec3, withAxis } from '../state/vec3.ts';
import { NumberField } from '../ui/number-field.tsx';
import { Slider } from '../ui/slider.tsx';
import { lookPart, movePart, moveStep, placePart } from './edit-parts.ts';

const AXES = ['x', 'y', 'z'] as const;
/** Smallest scale: splat sets cannot be scaled to zero. */
const LEAST_SCALE = 1e-6;

/** A file's placement in the scene, and its opacity. */
export function PartForm({ part, ...panel }: PanelProps & { readonly part: ScenePartSummary }) {
  const { look, canPlace } = part;
  const { turnDegrees, move, scale, up, sceneUp } = placementOf(part);
  const percent = Math.round(100 * look.opacity);
  const turn = (axis: number, degrees: number, gesture: object) =>
    placePart(panel, part, { turnDegrees: withAxis(turnDegrees, axis, degrees) }, gesture);
  return (
    <div className="part-form">
      <Slider
        label="Opacity"
        min={0}
        max={100}
        value={percent}
        shown={`${percent} %`}
        aria-valuetext={`${percent} percent`}
        testId="part-opacity"
        onValue={(value, gesture) => lookPart(panel, part, 'opacity', { opacity: value / 100 }, gesture)}
      />
      {canPlace ? (
        <>
          <Vector
            name="Move"
            unit="scene units"
            value={move}
            step={moveStep(part)}
            onChange={(axis, value, gesture) => movePart(panel, part, axis, value, gesture)}
          />
          <Vector name="Turn" unit="degrees" value={turnDegrees} step={5} onChange={turn} />
          <fieldset className="part-numbers">
            <legend>Scale</legend>
            <NumberField
              label="Scale"
              value={scale}
              step={0.1}
              min={LEAST_SCALE}
              testId="part-scale"
              onChange={(value, gesture) => placePart(panel, part, { scale: value }, gesture)}
            />
          </fieldset>
          <fieldset className="part-up">
            <legend>Up axis of this file</legend>
            <Choices
              choices={UP_CHOICES}
              chosen={up}
              testId="part-up-"
              onChoose={(axis) => placePart(panel, part, { up: axis })}
            />
          </fieldset>
          <TextButton
            disabled={look.placement === null && look.opacity === 1}
            testId="part-reset"
            onClick={() =>
              lookPart(panel, part, 'reset', {
                ...placedLook(PLAIN_LOOK, uprightPlacement(part, sceneUp), part),
                isHidden: look.isHidden,
              })
            }
          >
            Reset
          </TextButton>
        </>
      ) : (
        <p>A hard case cannot be moved.</p>
      )}
    </div>
  );
}

function Vector({
  name,
  unit,
  value,
  step,
  onChange,
}: {
  name: 'Move' | 'Turn';
  unit: string;
  value: Vec3;
  step: number;
  onChange: (axis: number, value: number, gesture: object) => void;
}) {
  return (
    <fieldset className="part-numbers">
      <legend>
        {name} <small>{unit}</small>
      </legend>
      {AXES.map((axis, i) => (
        <span key={axis} className={`part-number axis-${axis}`}>
          <b aria-hidden="true">{axis}</b>
          <NumberField
            label={`${name} ${axis}, ${unit}`}
            value={value[i]}
            step={step}
            testId={`part-${name.toLowerCase()}-${axis}`}
            onChange={(changed, gesture) => onChange(i, changed, gesture)}
          />
        </span>
      ))}
    </fieldset>
  );
}
