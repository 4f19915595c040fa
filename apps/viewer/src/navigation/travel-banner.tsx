import { useStore } from 'zustand';
import { TextButton } from '../ui/controls.tsx';
import type { PanelProps } from '../viewer/panel-props.ts';

/** Keys and speed of a flight, while there is one. */
export function FlightBanner({ store, viewer }: PanelProps) {
  const speed = useStore(store, (state) => state.flightSpeed);
  if (speed === null) return null;
  return (
    <div className="panel spread flight-banner" data-testid="flight">
      <p>
        <b>Flying at {speed.toFixed(speed < 1 ? 2 : 1)}×</b>
        <span className="flight-keys">
          <kbd>W</kbd> <kbd>A</kbd> <kbd>S</kbd> <kbd>D</kbd> move, <kbd>Q</kbd> <kbd>E</kbd> down and up,{' '}
          <kbd>Shift</kbd> faster, wheel: speed
        </span>
      </p>
      <TextButton look="plain" testId="end-flight" onClick={() => void viewer.toggleFlight()}>
        Stop <kbd>Esc</kbd>
      </TextButton>
    </div>
  );
}
