import { IconButton, TextButton } from '@websplatter/kit/controls';
import { type FormEvent, useState } from 'react';
import { useStore } from 'zustand';
import { LENGTH_UNITS, type LengthUnit, type Ruler } from '../state/inspecting.ts';
import type { InspectProps } from './inspection.ts';
import { formatFigure, formatLength } from './length-scale.ts';
import { rulerLength } from './rulers.ts';

/**
 * Measures distances between clicked points: in scene units, or in real units once the user has entered
 * the real length of one distance.
 */
export function DistanceTab({ store, inspection }: InspectProps) {
  const { rulers, rulerStart, scale } = useStore(store, (state) => state.inspecting);
  return (
    <div className="inspect-sections">
      <p data-testid="ruler-hint">
        {rulerStart ? 'Click the other end.' : 'Click two places in the picture to measure between them.'}
      </p>
      <div className="inspect-actions">
        <TextButton testId="ruler-middle" onClick={() => inspection.pickMiddle()}>
          Mark the middle of the picture
        </TextButton>
        {rulerStart && <TextButton onClick={() => inspection.rulers.forgetStart()}>Cancel</TextButton>}
      </div>
      {rulers.length > 0 && (
        <ol className="inspect-rulers" aria-label="Rulers">
          {rulers.map((ruler, i) => (
            <li key={ruler.id}>
              <span>Ruler {i + 1}</span>
              <output data-testid="ruler-length">{formatLength(rulerLength(ruler), scale)}</output>
              <IconButton
                icon="close"
                label={`Remove ruler ${i + 1}`}
                onClick={() => inspection.rulers.remove(ruler)}
              />
            </li>
          ))}
        </ol>
      )}
      {rulers.length > 0 && <KnownLength inspection={inspection} rulers={rulers} />}
      {scale && (
        <div className="inspect-actions">
          <p data-testid="length-scale">
            One scene unit is {formatFigure(scale.perSceneUnit, 4)} {scale.unit}. This browser keeps it for
            this scene.
          </p>
          <TextButton onClick={() => inspection.rulers.forgetScale()}>Measure in scene units</TextButton>
        </div>
      )}
    </div>
  );
}

function KnownLength({
  inspection,
  rulers,
}: Pick<InspectProps, 'inspection'> & { rulers: readonly Ruler[] }) {
  const [isWrong, setWrong] = useState(false);
  const onSubmit = (event: FormEvent<HTMLFormElement>) => {
    event.preventDefault();
    const fields = new FormData(event.currentTarget);
    const ruler = rulers[Number(fields.get('ruler'))] ?? rulers[0];
    const length = Number(fields.get('length'));
    setWrong(!inspection.rulers.calibrate(ruler, length, fields.get('unit') as LengthUnit));
  };
  return (
    <form className="inspect-known" onSubmit={onSubmit} noValidate>
      <h3>Known length</h3>
      <div>
        <select name="ruler" aria-label="Ruler whose length is known">
          {rulers.map((ruler, i) => (
            <option key={ruler.id} value={i}>
              Ruler {i + 1}
            </option>
          ))}
        </select>
        <span>is</span>
        <input
          name="length"
          type="number"
          min={0}
          step="any"
          aria-label="Length"
          aria-invalid={isWrong}
          data-testid="known-length"
        />
        <select name="unit" defaultValue="m" aria-label="Unit">
          {LENGTH_UNITS.map((unit) => (
            <option key={unit}>{unit}</option>
          ))}
        </select>
        <button type="submit" className="text-button outlined" data-testid="set-length">
          Set
        </button>
      </div>
      <p role="status">{isWrong && 'A length is a number above 0.'}</p>
    </form>
  );
}
