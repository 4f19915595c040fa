import { TextButton } from '@websplatter/kit/controls';
import { useStore } from 'zustand';
import type { ViewerStore } from '../state/store.ts';
import { NumberField } from '../ui/number-field.tsx';
import { Running } from '../ui/running.tsx';

/** Keys and speed of a flight or eye height of a walk, also while a walk is being prepared. */
export function TravelBanner({ store }: { store: ViewerStore }) {
  const travelling = useStore(store, (state) => state.travelling);
  const groundPart = useStore(store, (state) => state.groundPart);
  return (
    <>
      {groundPart !== null && (
        <section className="panel travel-preparation" aria-label="Preparing to walk">
          <Running
            label="Finding the ground to walk on…"
            about="Ground found"
            value={groundPart}
            max={1}
            testId="ground"
            cancelId="cancel-ground"
            onCancel={() => store.setState({ groundPart: null })}
          />
        </section>
      )}
      {travelling && (
        <section className="panel spread travel-banner" data-testid="travel" aria-label="Moving">
          {travelling.by === 'fly' ? (
            <p>
              <b>Flying at {travelling.speed.toFixed(travelling.speed < 1 ? 2 : 1)}×</b>
              <span className="travel-keys">
                <kbd>W</kbd> <kbd>A</kbd> <kbd>S</kbd> <kbd>D</kbd> move, <kbd>Q</kbd> <kbd>E</kbd> down and
                up, <kbd>Shift</kbd> faster, wheel: speed
              </span>
              <TouchHint />
            </p>
          ) : (
            <p>
              <b>Walking</b>
              <span className="travel-keys">
                <kbd>W</kbd> <kbd>A</kbd> <kbd>S</kbd> <kbd>D</kbd> move, <kbd>Space</kbd> jumps,{' '}
                <kbd>Shift</kbd> faster, wheel: height
              </span>
              <TouchHint />
              <EyeHeight
                value={travelling.eyeHeight}
                onChange={(eyeHeight) => store.setState({ travelling: { by: 'walk', eyeHeight } })}
              />
            </p>
          )}
          <TextButton look="plain" testId="end-travel" onClick={() => store.setState({ travelling: null })}>
            Stop <kbd>Esc</kbd>
          </TextButton>
        </section>
      )}
    </>
  );
}

function TouchHint() {
  return <span className="travel-touch">Drag to look, hold a second finger to move.</span>;
}

function EyeHeight({ value, onChange }: { value: number; onChange: (value: number) => void }) {
  const step = 10 ** (Math.floor(Math.log10(value)) - 1);
  return (
    <span className="travel-height">
      Eye height
      <NumberField
        label="Eye height, scene units"
        value={Number(value.toPrecision(3))}
        step={step}
        min={step}
        testId="eye-height"
        onChange={onChange}
      />
      units
    </span>
  );
}
